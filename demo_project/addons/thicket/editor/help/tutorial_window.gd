@tool
extends AcceptDialog
## The window that shows the tutorials with their images in the editor.

const Text := preload("res://addons/thicket/editor/help/tutorial_text.gd")

const FOLDER := "res://addons/thicket/tutorials/"
## The pages, in the order of the list.
const PAGES: PackedStringArray = [
	"first_forest.md", "your_own_tree.md", "paint_and_shapes.md", "game_that_fells.md", "server.md", "saves_and_mods.md", "streaming_world.md",
	"any_surface.md", "far_forest.md",
]
const SIZE := Vector2(900.0, 720.0)
const LIST_WIDTH := 220.0

## The current page; empty before the first one is opened.
var page := ""

var _list := ItemList.new()
var _text := RichTextLabel.new()


func _init() -> void:
	title = "Thicket Tutorials"
	ok_button_text = "Close"
	exclusive = false # The user must be able to use the editor while the window is open.
	transient = true
	var box := HSplitContainer.new()
	_list.item_selected.connect(func(index: int) -> void: open(PAGES[index]))
	box.add_child(_list)
	_text.bbcode_enabled = true
	_text.selection_enabled = true
	_text.context_menu_enabled = true
	_text.size_flags_horizontal = Control.SIZE_EXPAND_FILL
	_text.meta_clicked.connect(func(meta: Variant) -> void: open(str(meta)))
	box.add_child(_text)
	add_child(box)
	for name in PAGES:
		_list.add_item(Text.title(_text_of(name)))


func _ready() -> void:
	_list.custom_minimum_size.x = LIST_WIDTH * EditorInterface.get_editor_scale()
	_text.add_theme_font_override(&"mono_font", get_theme_font(&"source", &"EditorFonts"))


## Shows a page by its file name or path, and opens the window if it is closed. Any other link is opened in the web browser.
func open(link: String) -> void:
	var name := link.trim_prefix(FOLDER)
	var index := PAGES.find(name)
	if index < 0:
		var error := OS.shell_open(link)
		if error != OK:
			EditorInterface.get_editor_toaster().push_toast("Cannot open %s: %s. Open it in a web browser." % [link, error_string(error)],
					EditorToaster.SEVERITY_WARNING)
		return
	if name != page:
		page = name
		_list.select(index)
		_show(_text_of(name))
	if not visible:
		popup_centered(Vector2i(SIZE * EditorInterface.get_editor_scale()))


func _show(markdown: String) -> void:
	var text := Text.new()
	text.heading_size = int(24.0 * EditorInterface.get_editor_scale())
	text.read(markdown)
	_text.clear()
	for part in text.parts:
		if part.begins_with(Text.PICTURE_MARK):
			_add_picture(part.trim_prefix(Text.PICTURE_MARK))
		else:
			_text.append_text(part)
	_text.scroll_to_line(0)


## Returns a page in Markdown. If its file cannot be read, the page reports the error.
static func _text_of(name: String) -> String:
	var text := FileAccess.get_file_as_string(FOLDER + name)
	return text if text else "# %s\n\nCannot read %s: %s. Install all files of the add-on again." % [
		name, FOLDER + name, error_string(FileAccess.get_open_error())]


## Adds an image, loaded directly from its file. The engine does not import the folder of the pages, so exported games
## do not contain the images.
func _add_picture(file: String) -> void:
	var image := Image.new()
	if FileAccess.file_exists(FOLDER + file) and image.load_jpg_from_buffer(FileAccess.get_file_as_bytes(FOLDER + file)) == OK:
		_text.add_image(ImageTexture.create_from_image(image), 100, 0, Color.WHITE, INLINE_ALIGNMENT_CENTER, Rect2(), null, false, "", true)
	else:
		_text.append_text("The image %s cannot be read. Install all files of the add-on again." % (FOLDER + file))
	_text.append_text("\n\n")
