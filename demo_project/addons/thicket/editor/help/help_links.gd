@tool
extends RefCounted
## Makes the links to tutorials in the class reference work. The editor's help opens only web addresses, but the
## tutorials are files of the
## add-on, so this class opens them in a separate window.

const Tutorials := preload("res://addons/thicket/editor/help/tutorial_window.gd")

var _window: Tutorials
var _tab_containers: Array[Node] = []


## Handles the links on all help pages, including those that are opened later.
func _init(window: Tutorials) -> void:
	_window = window
	_tab_containers = EditorInterface.get_script_editor().find_children("*", "TabContainer", true, false)
	for container in _tab_containers:
		container.child_entered_tree.connect(_on_page)
		for page in container.get_children():
			_on_page(page)


## Stops handling links.
func leave() -> void:
	for container: Node in _tab_containers.filter(is_instance_valid):
		container.child_entered_tree.disconnect(_on_page)
		for page: Node in container.get_children():
			for text: RichTextLabel in _texts_of(page):
				if text.meta_clicked.is_connected(_on_link):
					text.meta_clicked.disconnect(_on_link)


func _on_page(page: Node) -> void:
	for text: RichTextLabel in _texts_of(page):
		if not text.meta_clicked.is_connected(_on_link):
			text.meta_clicked.connect(_on_link)


func _on_link(meta: Variant) -> void:
	if str(meta).begins_with(Tutorials.FOLDER):
		_window.open(str(meta))


static func _texts_of(page: Node) -> Array[Node]:
	var none: Array[Node] = []
	return page.find_children("*", "RichTextLabel", true, false) if page.get_class() == "EditorHelp" else none
