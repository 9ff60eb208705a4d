@tool
extends EditorExportPlugin
## An export as a dedicated server replaces meshes and textures by placeholders. This plugin stores the parts of them that a server needs: convex
## hulls, and images that are used as masks, heights and biomes. The resources themselves determine these parts.


func _get_name() -> String:
	return "Thicket"


func _begin_customize_resources(_platform: EditorExportPlatform, _features: PackedStringArray) -> bool:
	return get_export_preset().is_dedicated_server()


## Only changes a resource that has its own file when that file is exported (`path`). In any other file, it may be the object that the editor has
## open.
func _customize_resource(resource: Resource, path: String) -> Resource:
	var is_elsewhere := path.is_empty() and resource.resource_path.begins_with("res://") and not "::" in resource.resource_path
	return resource if not is_elsewhere and _embed(resource) else null


func _embed(resource: Resource) -> bool:
	if resource is ScatterLayer:
		return (resource as ScatterLayer).embed_stripped_data()
	if resource is ScatterGroundHeightmap:
		return (resource as ScatterGroundHeightmap).embed_stripped_data()
	return resource is ScatterBiomeMap and (resource as ScatterBiomeMap).embed_stripped_data()


## The engine reuses an exported file until the file itself or this number changes. The stored data also comes from other files.
func _get_customization_configuration_hash() -> int:
	return _hash_of(EditorInterface.get_resource_filesystem().get_filesystem())


func _hash_of(folder: EditorFileSystemDirectory) -> int:
	var known: Array = []
	for index in folder.get_file_count():
		var path := folder.get_file_path(index)
		known.append_array([path, FileAccess.get_modified_time(path), FileAccess.get_modified_time(path + ".import")])
	for index in folder.get_subdir_count():
		known.append(_hash_of(folder.get_subdir(index)))
	return hash(known)
