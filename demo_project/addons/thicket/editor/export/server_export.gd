@tool
extends EditorExportPlugin
## Stores the data of meshes and textures that a dedicated server needs, because the export of a server replaces meshes
## and textures with placeholders. The data consists of convex hulls and of the images of masks, heights and biomes.
## Each resource selects the data that it needs.


func _get_name() -> String:
	return "Thicket"


func _begin_customize_resources(_platform: EditorExportPlatform, _features: PackedStringArray) -> bool:
	return get_export_preset().is_dedicated_server()


## Adds the data of a resource with its own file only when that file ([param path]) is exported. While another file that
## contains the resource is exported, the editor may be using the same object, which must not change.
func _customize_resource(resource: Resource, path: String) -> Resource:
	var has_other_file := path.is_empty() and resource.resource_path.begins_with("res://") and not "::" in resource.resource_path
	return resource if not has_other_file and _embed(resource) else null


func _embed(resource: Resource) -> bool:
	if resource is ScatterLayer:
		return (resource as ScatterLayer).embed_stripped_data()
	if resource is ScatterGroundHeightmap:
		return (resource as ScatterGroundHeightmap).embed_stripped_data()
	return resource is ScatterBiomeMap and (resource as ScatterBiomeMap).embed_stripped_data()


## Returns a hash of all files in the project. The engine reuses an exported file until the file or this hash changes. The hash must cover all files,
## because the stored data of a resource may come from other files.
func _get_customization_configuration_hash() -> int:
	return _hash_of(EditorInterface.get_resource_filesystem().get_filesystem())


func _hash_of(folder: EditorFileSystemDirectory) -> int:
	var entries: Array = []
	for index in folder.get_file_count():
		var path := folder.get_file_path(index)
		entries.append_array([path, FileAccess.get_modified_time(path), FileAccess.get_modified_time(path + ".import")])
	for index in folder.get_subdir_count():
		entries.append(_hash_of(folder.get_subdir(index)))
	return hash(entries)
