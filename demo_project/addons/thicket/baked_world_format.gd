class_name ScatterBakedWorldFormat
extends ResourceFormatLoader
## Makes the editor list and export the files of baked worlds. The files are not loaded as resources, because [ScatterBakedWorld] reads them as data.

const BakedFile := preload("res://addons/thicket/baked_world_file.gd")


func _get_recognized_extensions() -> PackedStringArray:
	return [BakedFile.EXTENSION]


func _handles_type(type: StringName) -> bool:
	return type == &"Resource"


func _get_resource_type(path: String) -> String:
	return "Resource" if path.get_extension() == BakedFile.EXTENSION else ""


func _load(_path: String, _original_path: String, _use_sub_threads: bool, _cache_mode: int) -> Variant:
	return ERR_UNAVAILABLE
