@tool
extends RefCounted
## Manages the files next to a scene in which tools store their data, such as painted masks and hand-placed instances.
## The scene itself then contains only settings.

const Copies := preload("res://addons/thicket/editor/layers/layer_copies.gd")
const WholeFile := preload("res://addons/thicket/whole_file.gd")

const UNWRITABLE := "Cannot write %s: %s. Check that its folder exists and is writable and that the disk has room, then save the scene again."
const UNREMOVABLE := "Cannot remove %s, which no scene uses: %s. Delete it manually."

## The metadata key under which a resource stores the UID of the scene for which it was created. A UID stays valid when the file or the scene is
## renamed or moved.
const SCENE_UID := "thicket_scene_uid"

## The reason why [method create] failed.
var problem := ""

var _changed_resources: Dictionary[int, WeakRef] = {}
var _removed_contents: Dictionary[String, PackedByteArray] = {} ## The contents of removed files, including the UIDs by which scenes refer to them.
var _unwritten_paths: Dictionary[String, bool] = {} ## Unused files whose resources have unsaved changes.
var _unsaved_paths: Dictionary[String, String] = {} ## New files, each with the scene that will refer to the file once it is saved.
var _unused_paths: Dictionary[String, String] = {} ## Unused files, each with the scene that may still refer to the file on disk.


## Writes a new resource to a file next to the scene [param scene_path]. The file is named after the scene, [param owner_name] and
## [param kind]. On failure, returns false and sets [member problem].
func create(scene_path: String, resource: Resource, owner_name: String, kind: String) -> bool:
	problem = ""
	if scene_path.is_empty():
		problem = "The scene has no file yet. Save the scene first: your changes are stored in a file next to it."
		return false
	var path := free_path("%s_%s" % [_path_prefix(scene_path, owner_name), kind], "res")
	resource.remove_meta(SCENE_UID)
	var uid := ResourceLoader.get_resource_uid(scene_path)
	if uid != ResourceUID.INVALID_ID:
		resource.set_meta(SCENE_UID, ResourceUID.id_to_text(uid))
	var error := WholeFile.save(resource, path)
	if error != OK:
		problem = UNWRITABLE % [path, error_string(error)]
		return false
	resource.take_over_path(path)
	_unsaved_paths[path] = scene_path
	return true


## Returns the beginning of the paths for files of a layer or a model. The files are next to the resource's file if it has one, otherwise next to the
## edited scene, or an empty string if neither has a file.
static func path_prefix_of(owner: Resource) -> String:
	var path := owner.resource_path.get_slice("::", 0)
	if path.is_empty():
		path = edited_scene_path()
	return "" if path.is_empty() else _path_prefix(path, owner.resource_name)


## Returns the path of the edited scene, or an empty string if there is no scene, or if it was never saved.
static func edited_scene_path() -> String:
	var root := EditorInterface.get_edited_scene_root()
	return root.scene_file_path if root != null else ""


## Returns an unused path such as scene_layer_mask.res. It gets a number if that file exists already, or if a loaded resource has that path.
static func free_path(stem: String, extension: String) -> String:
	var path := "%s.%s" % [stem, extension]
	var number := 2
	while ResourceLoader.exists(path):
		path = "%s_%d.%s" % [stem, number, extension]
		number += 1
	return path


## Returns the path of the scene for which [method create] has created a resource, or an empty string if the scene is unknown or no longer exists.
static func scene_of(resource: Resource) -> String:
	var uid := ResourceUID.text_to_id(str(resource.get_meta(SCENE_UID, "")))
	var path := ResourceUID.get_id_path(uid) if uid != ResourceUID.INVALID_ID and ResourceUID.has_id(uid) else ""
	return path if FileAccess.file_exists(path) else ""


## Creates a copy of a copied layer's mask if the mask has its own file. The mask and its copy are added to [param r_masks], so layers that
## shared a mask share the copy. On failure, returns false and sets [member problem].
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


## Adds resources that other code has just written to new files, as [method add_to_undo] does. If the edited scene is closed without saving, the files
## are removed. They are kept if [param owner] has its own file, because that file may have been saved without the scene and refers to the resources.
func add_new_to_undo(resources: Array, owner: Resource, undo_redo: EditorUndoRedoManager) -> void:
	var scene_path := edited_scene_path()
	if not Copies.is_file(owner):
		for resource: Resource in resources:
			_unsaved_paths[resource.resource_path] = scene_path
	add_to_undo(resources, scene_path, undo_redo)


## Restores the content of a file, and the path of [param resource], which may be null. For undo and redo.
func put(path: String, bytes: PackedByteArray, resource: Resource) -> void:
	_store(path, bytes)
	if resource != null:
		resource.take_over_path(path)


## Adds resources that were created for a scene to the undo step that is being created. Undo removes their files, and redo restores them.
func add_to_undo(resources: Array, scene_path: String, undo_redo: EditorUndoRedoManager) -> void:
	for resource: Resource in resources:
		undo_redo.add_do_method(self, &"keep", resource, scene_path)
		undo_redo.add_undo_method(self, &"drop", resource, scene_path)


## Called when redo uses a resource of [method create] again. Restores the resource's file.
func keep(resource: Resource, scene_path: String) -> void:
	var path := resource.resource_path
	_unused_paths.erase(path)
	if not FileAccess.file_exists(path):
		_unsaved_paths[path] = scene_path
		if (not _restore(path) or _unwritten_paths.has(path)) and not _write(resource):
			mark(resource)
		_unwritten_paths.erase(path)
	elif _unwritten_paths.erase(path):
		mark(resource)


## Called when undo stops using a resource of [method create]. Removes the resource's file. If the scene on disk may refer to the file,
## the file is kept until the scene is saved.
func drop(resource: Resource, scene_path: String) -> void:
	if _changed_resources.erase(resource.get_instance_id()):
		_unwritten_paths[resource.resource_path] = true
	if _unsaved_paths.erase(resource.resource_path):
		_remove(resource.resource_path)
	else:
		_unused_paths[resource.resource_path] = scene_path


## Called when a scene was saved. Keeps the files to which it refers and removes those that it no longer uses.
func on_scene_saved(scene_path: String) -> void:
	for path: String in _unsaved_paths.keys():
		if _unsaved_paths[path] == scene_path:
			_unsaved_paths.erase(path)
	for path: String in _unused_paths.keys():
		if _unused_paths[path] == scene_path:
			_unused_paths.erase(path)
			_remove(path)


## Called when a scene was closed. Removes the files to which only its unsaved version referred.
func on_scene_closed(scene_path: String) -> void:
	for path: String in _unsaved_paths.keys():
		if _unsaved_paths[path] == scene_path:
			_unsaved_paths.erase(path)
			_remove(path)


## Marks a resource as changed, so that [method save] writes it.
func mark(resource: Resource) -> void:
	_changed_resources[resource.get_instance_id()] = weakref(resource)


## Writes the marked resources. Resources that are no longer in use, for example after closing a scene without saving it, are not written.
## If a file cannot be written, the next call tries again.
func save() -> void:
	for id: int in _changed_resources.keys():
		var resource := _changed_resources[id].get_ref() as Resource
		# A resource without its own file is saved with the scene.
		var has_file := resource != null and not resource.resource_path.is_empty() and not "::" in resource.resource_path
		if not has_file or _write(resource):
			_changed_resources.erase(id)


func _restore(path: String) -> bool:
	return _removed_contents.has(path) and _store(path, _removed_contents[path])


func _remove(path: String) -> void:
	if not FileAccess.file_exists(path): # The user may have deleted the file.
		return
	_removed_contents[path] = FileAccess.get_file_as_bytes(path)
	var error := FileAccess.get_open_error()
	if error != OK: # Without the content, redo writes the resource instead.
		_removed_contents.erase(path)
	error = DirAccess.remove_absolute(path)
	if error != OK:
		push_error(UNREMOVABLE % [path, error_string(error)])
	EditorInterface.get_resource_filesystem().update_file(path)


static func _store(path: String, bytes: PackedByteArray) -> bool:
	return _report(path, WholeFile.store(path, bytes))


static func _write(resource: Resource) -> bool:
	return _report(resource.resource_path, WholeFile.save(resource, resource.resource_path))


static func _report(path: String, error: Error) -> bool:
	if error != OK:
		push_error(UNWRITABLE % [path, error_string(error)])
	return error == OK


static func _path_prefix(path: String, owner_name: String) -> String:
	var name := owner_name.to_snake_case().validate_filename()
	return "%s_%s" % [path.get_basename(), name if not name.is_empty() else "layer"]
