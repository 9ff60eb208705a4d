@tool
extends RefCounted
## Keeps painted masks in files of their own, beside the scene: a scene holds settings only.

## Why [method create] gave nothing, in a sentence.
var problem := ""

var _changed: Dictionary[int, WeakRef] = {}
var _unsaved: Dictionary[String, String] = {} ## Files that no saved scene can refer to yet, and the scene that will.
var _unused: Dictionary[String, String] = {} ## Files that a saved scene may refer to, but no more when it is saved again.


## A new mask for a layer, in a file beside the scene [param scene_path]; null, with the reason in [member problem], if
## that cannot be. [param background] is the density where nothing is painted, 0 to 1.
func create(scene_path: String, layer: Resource, background: float) -> Resource:
	problem = ""
	if scene_path.is_empty():
		problem = "Save the scene first: what is painted goes into a file beside it."
		return null
	var mask: Resource = ClassDB.instantiate(&"ScatterMask")
	mask.set(&"background", background)
	var path := _free_path(scene_path, layer.resource_name)
	var error := ResourceSaver.save(mask, path)
	if error != OK:
		problem = "Cannot write %s: %s." % [path, error_string(error)]
		return null
	mask.take_over_path(path)
	_unsaved[path] = scene_path
	return mask


## The mask that [method create] made for a scene is in use again, after redo.
func keep(mask: Resource, scene_path: String) -> void:
	_unused.erase(mask.resource_path)
	if not FileAccess.file_exists(mask.resource_path):
		_unsaved[mask.resource_path] = scene_path
		_write(mask)


## The same mask is in use no more, after undo. Its file goes; one that the scene on disk refers to stays until that is saved.
func drop(mask: Resource, scene_path: String) -> void:
	_changed.erase(mask.get_instance_id())
	if _unsaved.erase(mask.resource_path):
		_remove(mask.resource_path)
	else:
		_unused[mask.resource_path] = scene_path


## A scene was saved: what it refers to stays from now on, and what it refers to no more goes.
func on_scene_saved(scene_path: String) -> void:
	for path: String in _unsaved.keys():
		if _unsaved[path] == scene_path:
			_unsaved.erase(path)
	for path: String in _unused.keys():
		if _unused[path] == scene_path:
			_unused.erase(path)
			_remove(path)


## A scene was closed: what it would have referred to, had it been saved, goes.
func on_scene_closed(scene_path: String) -> void:
	for path: String in _unsaved.keys():
		if _unsaved[path] == scene_path:
			_unsaved.erase(path)
			_remove(path)


## The mask has been painted on; [method save] will write it.
func mark(mask: Resource) -> void:
	_changed[mask.get_instance_id()] = weakref(mask)


## Writes what has been painted on since the last call. Masks that nobody holds any more, as after closing a scene
## without saving it, are left as they are on disk.
func save() -> void:
	for reference: WeakRef in _changed.values():
		var mask := reference.get_ref() as Resource
		# One inside of a scene is saved with it, by the editor.
		if mask != null and not mask.resource_path.is_empty() and not "::" in mask.resource_path:
			_write(mask)
	_changed.clear()


static func _remove(path: String) -> void:
	DirAccess.remove_absolute(path)
	EditorInterface.get_resource_filesystem().update_file(path)


static func _write(mask: Resource) -> void:
	var error := ResourceSaver.save(mask, mask.resource_path)
	if error != OK:
		push_error("cannot write %s: %s" % [mask.resource_path, error_string(error)])


## scene_layer_mask.res, or with a number where another mask lies already.
static func _free_path(scene_path: String, layer_name: String) -> String:
	var name := layer_name.to_snake_case().validate_filename()
	var stem := "%s_%s_mask" % [scene_path.get_basename(), name if not name.is_empty() else "layer"]
	var path := stem + ".res"
	var number := 2
	while ResourceLoader.exists(path):
		path = "%s_%d.res" % [stem, number]
		number += 1
	return path
