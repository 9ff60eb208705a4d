class_name ScatterBakedWorldFormat
extends ResourceFormatLoader
## Makes the editor list and export the files of baked worlds. The files are not loaded as resources, because [ScatterBakedWorld] reads them as data.
##
## The engine creates an object of this class in every project that contains the add-on, in any folder. Therefore, it also reports a wrong folder.

# A relative path, so that this script compiles in any folder.
const BakedFile := preload("baked_world_file.gd")

## The folder of the add-on. Its files refer to each other by paths in this folder.
const ADDON := "res://addons/thicket/"


func _init() -> void:
	var problem := misplaced((get_script() as Script).resource_path)
	if problem:
		push_error(problem)


## Returns an empty text if the script at [param path] is in [constant ADDON]. Otherwise returns the error, and how to fix it.
static func misplaced(path: String) -> String:
	var folder := path.get_base_dir() + "/"
	if folder == ADDON:
		return ""
	return "Thicket must be in the folder %s, but it is in %s. Close the editor, move the folder, and open the project again." % [ADDON, folder]


func _get_recognized_extensions() -> PackedStringArray:
	return [BakedFile.EXTENSION]


func _handles_type(type: StringName) -> bool:
	return type == &"Resource"


func _get_resource_type(path: String) -> String:
	return "Resource" if path.get_extension() == BakedFile.EXTENSION else ""


func _load(_path: String, _original_path: String, _use_sub_threads: bool, _cache_mode: int) -> Variant:
	return ERR_UNAVAILABLE
