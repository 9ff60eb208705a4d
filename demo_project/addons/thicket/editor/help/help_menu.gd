@tool
extends PopupMenu
## The menu [i]Project > Tools > Thicket[/i]. It opens the tutorials, pages of the documentation, and the form for reports.

const Tutorials := preload("res://addons/thicket/editor/help/tutorial_window.gd")
const WholeFile := preload("res://addons/thicket/whole_file.gd")

enum Item { TUTORIALS, DOCUMENTATION, WHATS_NEW, REPORT, COPY_REPORT }

## The title of the menu.
const TITLE := "Thicket"
const PLUGIN_CFG := "res://addons/thicket/plugin.cfg"
const EXAMPLE := "res://addons/thicket/presets/example.tscn"
## The user's copy of the example. An update of the add-on does not replace it.
const COPY := "res://thicket_example.tscn"

var _tutorials: Tutorials
var _plugin := ConfigFile.new()


func _init(tutorials: Tutorials) -> void:
	_tutorials = tutorials
	_plugin.load(PLUGIN_CFG) # The editor has read this file, too. Without it, there would be no menu.
	name = TITLE
	add_item("Tutorials...", Item.TUTORIALS)
	add_item("Documentation", Item.DOCUMENTATION)
	add_item("What's New", Item.WHATS_NEW)
	add_separator()
	add_item("Report a Problem", Item.REPORT)
	add_item("Copy System Report", Item.COPY_REPORT)
	set_item_tooltip(item_count - 1, "Copies the versions of Thicket, Godot and the system, for reports of problems.")
	id_pressed.connect(choose)


## Performs the action of an item.
func choose(item: Item) -> void:
	match item:
		Item.TUTORIALS:
			_tutorials.open(_tutorials.page if _tutorials.page else Tutorials.PAGES[0])
		Item.COPY_REPORT:
			DisplayServer.clipboard_set(system_report())
			EditorInterface.get_editor_toaster().push_toast("The system report is in the clipboard. Paste it into your report.", EditorToaster.SEVERITY_INFO)
		_:
			_tutorials.open(address(item))


## Opens the first tutorial.
func open_first_forest() -> void:
	_tutorials.open(Tutorials.PAGES[0])


## Opens the user's copy of the example scene. Creates the copy if it does not exist.
func open_example() -> void:
	var error := OK if FileAccess.file_exists(COPY) else _copy_example()
	if error != OK:
		EditorInterface.get_editor_toaster().push_toast("Cannot write the example to %s: %s. Check the folder and the free space on the disk." % [
				COPY, error_string(error)], EditorToaster.SEVERITY_ERROR)
		return
	EditorInterface.open_scene_from_path(COPY)
	EditorInterface.set_main_screen_editor("3D")


## Writes the example with its own copy of the layers. The scene of the add-on contains them as an instance, whose layers the editor does not save.
func _copy_example() -> Error:
	var root := (load(EXAMPLE) as PackedScene).instantiate()
	var forest := root.get_node(^"Forest")
	forest.scene_file_path = ""
	var scene := PackedScene.new()
	var error := scene.pack(root)
	root.free()
	if error == OK:
		error = WholeFile.save(scene, COPY)
	EditorInterface.get_resource_filesystem().update_file(COPY)
	return error


## Returns the web address that an item opens, or an empty string for other items.
func address(item: Item) -> String:
	match item:
		Item.DOCUMENTATION:
			return str(_plugin.get_value("thicket", "documentation"))
		Item.WHATS_NEW:
			return str(_plugin.get_value("thicket", "documentation")) + "/changelog.html"
		Item.REPORT:
			return str(_plugin.get_value("thicket", "repository")) + "/issues"
		_:
			return ""


## Returns the versions of everything that a report of a problem needs, one per line.
func system_report() -> String:
	return "\n".join([
		"Thicket: %s" % _plugin.get_value("plugin", "version"),
		"Godot: %s, %s precision" % [Engine.get_version_info().string, "double" if OS.has_feature("double") else "single"],
		"System: %s %s, %s" % [OS.get_distribution_name(), OS.get_version(), Engine.get_architecture_name()],
		"Processor: %s, %d threads" % [OS.get_processor_name(), OS.get_processor_count()],
		"Renderer: %s, %s, %s" % [RenderingServer.get_current_rendering_method(), RenderingServer.get_current_rendering_driver_name(),
			RenderingServer.get_video_adapter_name()],
	])
