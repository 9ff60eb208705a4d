@tool
extends RefCounted
## Keeps what tools make, as painted masks and hand-placed instances, in files of their own beside the scene: a scene holds settings only.

const WholeFile := preload("res://addons/thicket/whole_file.gd")

const UNWRITABLE := "Cannot write %s: %s. Check that its folder exists, has room and may be written, then save the scene again."
const UNREMOVABLE := "Cannot remove %s, which no scene uses any more: %s. Delete it by hand."

## Why [method create] gave nothing, in a sentence.
var problem := ""

var _changed: Dictionary[int, WeakRef] = {}
var _removed: Dictionary[String, PackedByteArray] = {} ## What was in files that are gone; with it goes the id by which scenes find them.
var _unwritten: Dictionary[String, bool] = {} ## Files in use no more whose resources had changed since they were written.
var _unsaved: Dictionary[String, String] = {} ## Files that no saved scene can refer to yet, and the scene that will.
var _unused: Dictionary[String, String] = {} ## Files that a saved scene may refer to, but no more when it is saved again.


## Gives a new resource a file beside the scene [param scene_path], named after the scene, [param owner_name] and [param kind]. False, with
## the reason in [member problem], if that cannot be.
func create(scene_path: String, resource: Resource, owner_name: String, kind: String) -> bool:
	problem = ""
	if scene_path.is_empty():
		problem = "The scene has no file yet. Save the scene first: what you make goes into a file beside it."
		return false
	var path := _free_path(scene_path, owner_name, kind)
	var error := WholeFile.save(resource, path)
	if error != OK:
		problem = UNWRITABLE % [path, error_string(error)]
		return false
	resource.take_over_path(path)
	_unsaved[path] = scene_path
	return true


## Gives a layer, a copy of another, a copy of the mask that both have, if that is a file. [param r_masks] gets the mask and its copy:
## layers that shared one share the copy. False, with the reason in [member problem], if that cannot be.
func copy_mask(layer: ScatterLayer, scene_path: String, r_masks: Dictionary[Resource, Resource]) -> bool:
	var mask := layer.mask
	if mask == null or mask.resource_path.is_empty() or "::" in mask.resource_path:
		return true
	if not r_masks.has(mask):
		var copy := mask.duplicate()
		if not create(scene_path, copy, layer.resource_name, "mask"):
			return false
		r_masks[mask] = copy
	layer.mask = r_masks[mask]
	return true


## Takes in resources that others have just written to new files beside a scene: they go as those that [method create] gives a file.
func adopt(resources: Array, scene_path: String) -> void:
	for resource: Resource in resources:
		_unsaved[resource.resource_path] = scene_path


## Makes a file hold what it held at another time, and a resource, if there is one, what is loaded from it; for undo.
func put(path: String, bytes: PackedByteArray, resource: Resource) -> void:
	_store(path, bytes)
	if resource != null:
		resource.take_over_path(path)


## Has resources that were made for a scene come and go with the step of undo that is being made.
func add_to_undo(resources: Array, scene_path: String, undo_redo: EditorUndoRedoManager) -> void:
	for resource: Resource in resources:
		undo_redo.add_do_method(self, &"keep", resource, scene_path)
		undo_redo.add_undo_method(self, &"drop", resource, scene_path)


## The resource that [method create] gave a file for a scene is in use again, after redo.
func keep(resource: Resource, scene_path: String) -> void:
	var path := resource.resource_path
	_unused.erase(path)
	if not FileAccess.file_exists(path):
		_unsaved[path] = scene_path
		if (not _put_back(path) or _unwritten.has(path)) and not _write(resource):
			mark(resource)
		_unwritten.erase(path)
	elif _unwritten.erase(path):
		mark(resource)


## The same resource is in use no more, after undo. Its file goes; one that the scene on disk refers to stays until that is saved.
func drop(resource: Resource, scene_path: String) -> void:
	if _changed.erase(resource.get_instance_id()):
		_unwritten[resource.resource_path] = true
	if _unsaved.erase(resource.resource_path):
		_remove(resource.resource_path)
	else:
		_unused[resource.resource_path] = scene_path


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


## The resource has changed; [method save] will write it.
func mark(resource: Resource) -> void:
	_changed[resource.get_instance_id()] = weakref(resource)


## Writes what has changed since the last call. Resources that nobody holds any more, as after closing a scene
## without saving it, are left as they are on disk. A file that cannot be written is written by a later call.
func save() -> void:
	for id: int in _changed.keys():
		var resource := _changed[id].get_ref() as Resource
		# One inside of a scene is saved with it, by the editor.
		var has_file := resource != null and not resource.resource_path.is_empty() and not "::" in resource.resource_path
		if not has_file or _write(resource):
			_changed.erase(id)


func _put_back(path: String) -> bool:
	return _removed.has(path) and _store(path, _removed[path])


func _remove(path: String) -> void:
	if not FileAccess.file_exists(path): # The user may have deleted it.
		return
	_removed[path] = FileAccess.get_file_as_bytes(path)
	var error := FileAccess.get_open_error()
	if error != OK: # Redo writes the resource itself.
		_removed.erase(path)
	error = DirAccess.remove_absolute(path)
	if error != OK:
		push_error(UNREMOVABLE % [path, error_string(error)])
	EditorInterface.get_resource_filesystem().update_file(path)


static func _store(path: String, bytes: PackedByteArray) -> bool:
	return _reported(path, WholeFile.store(path, bytes))


static func _write(resource: Resource) -> bool:
	return _reported(resource.resource_path, WholeFile.save(resource, resource.resource_path))


static func _reported(path: String, error: Error) -> bool:
	if error != OK:
		push_error(UNWRITABLE % [path, error_string(error)])
	return error == OK


## scene_layer_mask.res, or with a number where another lies already.
static func _free_path(scene_path: String, owner_name: String, kind: String) -> String:
	var name := owner_name.to_snake_case().validate_filename()
	var stem := "%s_%s_%s" % [scene_path.get_basename(), name if not name.is_empty() else "layer", kind]
	var path := stem + ".res"
	var number := 2
	while ResourceLoader.exists(path):
		path = "%s_%d.res" % [stem, number]
		number += 1
	return path
