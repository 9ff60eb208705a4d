@tool
extends RefCounted
## Makes foliage materials from the standard materials of models: with wind, light through leaves, and fade. They are saved beside the scene.

const FOLIAGE := preload("res://addons/thicket/shaders/foliage.gdshader")
const WholeFile := preload("res://addons/thicket/whole_file.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

## How far a plant leans in the wind and how far its leaves tremble, as a share of its height, with the largest values in meters.
const SWAY := Vector2(0.011, 0.2)
const FLUTTER := Vector2(0.01, 0.03)
## Plants up to this height in meters bend around characters, by this share of their height.
const BENT := 2.5
const BEND := 0.3
## How much light leaves let through if their material does not say.
const LEAF_LIGHT := 0.3

var _problem := "" ## Why a file could not be written; empty if all were.
var _files: SceneFiles
var _made: Dictionary[Material, ShaderMaterial] = {}
var _left_out := PackedStringArray()


func _init(files: SceneFiles) -> void:
	_files = files


## Converts the materials of a layer's models, as one undo step. A scene in the list becomes a model that refers to it. Returns the sentences that the
## user should read. [param place] is the path with which the names of files begin.
func convert(layer: ScatterLayer, place: String, undo_redo: EditorUndoRedoManager) -> PackedStringArray:
	_made.clear()
	_left_out.clear()
	_problem = ""
	var meshes := layer.meshes.duplicate()
	var replaced: Array[Array] = [] # Models, with their materials before and after.
	for index in meshes.size():
		meshes[index] = _convert_entry(meshes[index], replaced)
	if _made.is_empty():
		return [("There is no standard material to convert. " + " ".join(_left_out)).strip_edges()]
	var written := _save(place)
	if not _problem.is_empty():
		return [_problem]
	if layer.resource_path.is_empty() or "::" in layer.resource_path: # Otherwise the layer may be saved without the scene.
		_files.adopt(written, _scene_path())
	undo_redo.create_action("Make Foliage Materials", UndoRedo.MERGE_DISABLE, layer)
	_files.add_to_undo(written, _scene_path(), undo_redo)
	for change in replaced:
		undo_redo.add_do_property(change[0], &"replacement_materials", change[2])
		undo_redo.add_undo_property(change[0], &"replacement_materials", change[1])
	undo_redo.add_do_property(layer, &"meshes", meshes)
	undo_redo.add_undo_property(layer, &"meshes", layer.meshes.duplicate())
	undo_redo.commit_action()
	for material in written:
		EditorInterface.get_resource_filesystem().update_file(material.resource_path)
	return _left_out


## The entry of the layer's list after its materials are converted.
func _convert_entry(entry: Variant, r_replaced: Array[Array]) -> Variant:
	var model := entry as ScatterModel
	if entry is PackedScene:
		model = ScatterModel.new()
		model.scene = entry
	if model == null or model.scene == null:
		_left_out.append("%s is a mesh without a scene: set the material on the mesh itself." % _title(entry))
		return entry
	var height := model.get_aabb().end.y
	var replacements := {}
	for lod in model.lods:
		for mesh: Mesh in [lod.mesh, lod.shadow_mesh]:
			for surface in (mesh.get_surface_count() if mesh else 0):
				var material := mesh.surface_get_material(surface)
				if material is BaseMaterial3D:
					var name := model.get_material_name(material)
					var converted := _converted(material as BaseMaterial3D, name, height)
					if replacements.get_or_add(name, converted) != converted:
						_left_out.append("%s has several materials named \"%s\", which are drawn with one now: give them names of their own." % [_title(entry), name])
	if replacements.is_empty():
		return entry
	if entry is PackedScene: # The new model is not in the scene yet, so nothing needs to be undone in it.
		model.resource_name = _title(entry)
		model.replacement_materials = replacements
	else:
		r_replaced.append([model, model.replacement_materials, model.replacement_materials.merged(replacements, true)])
	return model


func _converted(from: BaseMaterial3D, name: String, height: float) -> ShaderMaterial:
	if _made.has(from):
		return _made[from]
	var cut := from.transparency != BaseMaterial3D.TRANSPARENCY_DISABLED
	var is_leaf := cut or from.cull_mode == BaseMaterial3D.CULL_DISABLED
	var made := ShaderMaterial.new()
	made.shader = FOLIAGE
	made.resource_name = name
	made.set_shader_parameter("albedo", from.albedo_color)
	if from.albedo_texture:
		made.set_shader_parameter("albedo_texture", from.albedo_texture)
	made.set_shader_parameter("vertex_color_as_albedo", from.vertex_color_use_as_albedo)
	# An opaque material ignores alpha, so nearly nothing is cut.
	var scissor := from.alpha_scissor_threshold if from.transparency == BaseMaterial3D.TRANSPARENCY_ALPHA_SCISSOR else 0.5
	made.set_shader_parameter("alpha_scissor", scissor if cut else 0.01)
	var light := from.backlight.get_luminance() if from.backlight_enabled else LEAF_LIGHT if is_leaf else 0.0
	made.set_shader_parameter("backlight", light)
	made.set_shader_parameter("sway_height", clampf(height, 0.05, 60.0))
	made.set_shader_parameter("wind_sway", minf(SWAY.x * height, SWAY.y))
	made.set_shader_parameter("wind_flutter", minf(FLUTTER.x * height, FLUTTER.y) if is_leaf else 0.0)
	made.set_shader_parameter("bend_reach", BEND * minf(height, 1.0) if height < BENT else 0.0)
	_made[from] = made
	return made


## Saves the new materials, each in a file whose name is free.
func _save(place: String) -> Array[Resource]:
	var written: Array[Resource] = []
	for material: ShaderMaterial in _made.values():
		var path := SceneFiles.free_path("%s_%s" % [place, material.resource_name.to_snake_case().validate_filename()], "tres")
		var error := WholeFile.save(material, path)
		if error != OK:
			_problem = "%s cannot be saved: %s." % [path, error_string(error)]
			return written
		material.take_over_path(path)
		written.append(material)
	return written


static func _scene_path() -> String:
	var root := EditorInterface.get_edited_scene_root()
	return root.scene_file_path if root else ""


static func _title(entry: Variant) -> String:
	var resource := entry as Resource
	if resource == null:
		return "An empty entry"
	return resource.resource_name if resource.resource_name else resource.resource_path.get_file().get_basename().capitalize()
