@tool
extends RefCounted
## Creates foliage materials, with wind, translucent leaves and fade, from the standard materials of models. They are saved next to the scene.

const FOLIAGE := preload("res://addons/thicket/shaders/foliage.gdshader")
const FOLIAGE_MAPPED := preload("res://addons/thicket/shaders/foliage_mapped.gdshader")
const WholeFile := preload("res://addons/thicket/whole_file.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

## The distances by which wind moves a plant and its leaves. x is a fraction of the plant's height, and y is the maximum in meters.
const SWAY := Vector2(0.011, 0.2)
const FLUTTER := Vector2(0.01, 0.03)
## Plants that are lower than [constant BEND_HEIGHT] meters bend around characters by up to [constant BEND] times their height, and by at most
## [constant BEND] meters.
const BEND_HEIGHT := 2.5
const BEND := 0.3
## The fraction of light that shines through leaves if their material does not specify it.
const LEAF_LIGHT := 0.3

var _problem := "" ## The reason why a file could not be written; empty if there is none.
var _path_prefix: String
var _only_plain := false
var _foliage_materials: Dictionary[Material, ShaderMaterial] = {}
var _messages := PackedStringArray() ## Messages for the user about materials that were not converted as they are.
var _models: Array[Array] = [] ## Existing models, each with its replacement materials before and after.
var _surfaces: Array[Array] = [] ## Meshes without a scene, each with a surface and the surface's material before and after.


## Prepares a conversion whose new files have paths that begin with [param path_prefix].
func _init(path_prefix: String) -> void:
	_path_prefix = path_prefix


## Converts the materials of a layer's models, as one undo step. A scene with materials to convert is replaced by a [ScatterModel] of that scene.
## Returns messages for the user.
func convert(layer: ScatterLayer, files: SceneFiles, undo_redo: EditorUndoRedoManager) -> PackedStringArray:
	var meshes := layer.meshes.map(_convert_entry)
	return _commit(layer, files, undo_redo, func() -> void:
		undo_redo.add_do_property(layer, &"meshes", meshes)
		undo_redo.add_undo_property(layer, &"meshes", layer.meshes.duplicate()))


## Converts the materials of one model, as [method convert] does.
func convert_model(model: ScatterModel, files: SceneFiles, undo_redo: EditorUndoRedoManager) -> PackedStringArray:
	_convert_entry(model)
	return _commit(model, files, undo_redo)


## Converts the materials of scenes in a layer that is not in use yet, except for materials with features that foliage materials lack. Returns the new
## materials, which the caller adds to its undo step. If they cannot be saved, prints an error and leaves the layer unchanged.
func convert_new_layer(layer: ScatterLayer) -> Array[Resource]:
	_only_plain = true
	var meshes := layer.meshes.map(func(entry: Variant) -> Variant: return _convert_entry(entry) if entry is PackedScene else entry)
	var saved := _save()
	if not _problem.is_empty():
		push_error(_problem)
		for material in saved:
			DirAccess.remove_absolute(material.resource_path)
		saved.clear()
	elif not saved.is_empty():
		layer.meshes = meshes
	return saved


func _commit(owner: Resource, files: SceneFiles, undo_redo: EditorUndoRedoManager, add_more := Callable()) -> PackedStringArray:
	if _foliage_materials.is_empty():
		return [("There is no standard material to convert. " + " ".join(_messages)).strip_edges()]
	var saved := _save()
	if not _problem.is_empty():
		return [_problem]
	undo_redo.create_action("Make Foliage Materials", UndoRedo.MERGE_DISABLE, owner)
	files.add_new_to_undo(saved, owner, undo_redo)
	for change in _models:
		undo_redo.add_do_property(change[0], &"replacement_materials", change[2])
		undo_redo.add_undo_property(change[0], &"replacement_materials", change[1])
	for change in _surfaces:
		undo_redo.add_do_method(change[0], "surface_set_material", change[1], change[3])
		undo_redo.add_undo_method(change[0], "surface_set_material", change[1], change[2])
	if add_more.is_valid():
		add_more.call()
	undo_redo.commit_action()
	return _messages


## Converts the materials of an entry of the layer's list. Returns the entry, or the model that replaces it.
func _convert_entry(entry: Variant) -> Variant:
	if entry is Mesh:
		_convert_mesh(entry as Mesh)
		return entry
	var model := entry as ScatterModel
	if entry is PackedScene:
		model = ScatterModel.new()
		model.scene = entry
	if model == null:
		return entry
	var height := model.get_aabb().end.y
	var replacements := {}
	for lod in model.lods:
		for mesh: Mesh in [lod.mesh, lod.shadow_mesh]:
			if model.scene == null:
				_convert_mesh(mesh)
				continue
			for surface in _surfaces_to_convert(mesh):
				var material := mesh.surface_get_material(surface)
				var original_name: Variant = model.replacement_materials.find_key(material)
				var name: String = original_name if original_name != null else model.get_material_name(material)
				var foliage_material := _converted(material as BaseMaterial3D, name, height)
				if replacements.get_or_add(name, foliage_material) != foliage_material:
					_messages.append("%s has several materials named \"%s\", which are now drawn with a single material: give each a unique name." % [_title(entry), name])
	if replacements.is_empty():
		return entry
	if entry is PackedScene: # The new model is not in the scene yet, so its changes need no undo.
		model.resource_name = _title(entry)
		model.replacement_materials = replacements
	else:
		_models.append([model, model.replacement_materials, model.replacement_materials.merged(replacements, true)])
	return model


## Converts the materials of a mesh without a scene in the mesh itself, unless the next import would replace the mesh.
func _convert_mesh(mesh: Mesh) -> void:
	for surface in _surfaces_to_convert(mesh):
		var path := mesh.resource_path
		if not (path.is_empty() or path.begins_with(SceneFiles.edited_scene_path() + "::") or path.get_extension() in ["tres", "res"]):
			_messages.append("%s is imported without a scene: set Import As to Scene in the Import dock, or set the layer's Material Override." % _title(mesh))
			return
		var material := mesh.surface_get_material(surface)
		var name := material.resource_name if material.resource_name else "%s_%d" % [_title(mesh), surface]
		_surfaces.append([mesh, surface, material, _converted(material as BaseMaterial3D, name, mesh.get_aabb().end.y)])


## Returns the surfaces of a mesh whose materials are converted. The mesh may be null.
func _surfaces_to_convert(mesh: Mesh) -> Array:
	return range(mesh.get_surface_count() if mesh != null else 0).filter(func(surface: int) -> bool:
		var material := mesh.surface_get_material(surface)
		return material is BaseMaterial3D and (not _only_plain or _is_plain(material as BaseMaterial3D)))


## Returns true if a foliage material can replace this material without losing a visible feature.
static func _is_plain(material: BaseMaterial3D) -> bool:
	return material.shading_mode != BaseMaterial3D.SHADING_MODE_UNSHADED and material.billboard_mode == BaseMaterial3D.BILLBOARD_DISABLED \
			and not (material.emission_enabled or material.refraction_enabled or material.detail_enabled or material.clearcoat_enabled
			or material.uv1_triplanar or material.heightmap_enabled or material.next_pass != null or material.metallic > 0.5)


func _converted(source: BaseMaterial3D, name: String, height: float) -> ShaderMaterial:
	if _foliage_materials.has(source):
		return _foliage_materials[source]
	var is_transparent := source.transparency != BaseMaterial3D.TRANSPARENCY_DISABLED
	var is_leaf := is_transparent or source.cull_mode == BaseMaterial3D.CULL_DISABLED
	var is_mapped := source.normal_enabled and source.normal_texture != null
	var foliage_material := ShaderMaterial.new()
	foliage_material.shader = FOLIAGE_MAPPED if is_mapped else FOLIAGE
	foliage_material.resource_name = name
	if is_mapped:
		foliage_material.set_shader_parameter("normal_texture", source.normal_texture)
		foliage_material.set_shader_parameter("normal_scale", source.normal_scale)
	foliage_material.set_shader_parameter("albedo", source.albedo_color)
	if source.albedo_texture:
		foliage_material.set_shader_parameter("albedo_texture", source.albedo_texture)
	foliage_material.set_shader_parameter("uv_scale", Vector2(source.uv1_scale.x, source.uv1_scale.y))
	foliage_material.set_shader_parameter("uv_offset", Vector2(source.uv1_offset.x, source.uv1_offset.y))
	foliage_material.set_shader_parameter("vertex_color_as_albedo", source.vertex_color_use_as_albedo)
	# An opaque material ignores alpha, so the threshold is nearly 0.
	var threshold := source.alpha_scissor_threshold if source.transparency == BaseMaterial3D.TRANSPARENCY_ALPHA_SCISSOR else 0.5
	foliage_material.set_shader_parameter("alpha_scissor", threshold if is_transparent else 0.01)
	var light := source.backlight.get_luminance() if source.backlight_enabled else LEAF_LIGHT if is_leaf else 0.0
	foliage_material.set_shader_parameter("backlight", light)
	foliage_material.set_shader_parameter("sway_height", clampf(height, 0.05, 60.0))
	foliage_material.set_shader_parameter("wind_sway", minf(SWAY.x * height, SWAY.y))
	foliage_material.set_shader_parameter("wind_flutter", minf(FLUTTER.x * height, FLUTTER.y) if is_leaf else 0.0)
	foliage_material.set_shader_parameter("bend_reach", BEND * minf(height, 1.0) if height < BEND_HEIGHT else 0.0)
	_foliage_materials[source] = foliage_material
	return foliage_material


## Saves each new material to a new file. Returns the saved materials; on failure, sets [member _problem].
func _save() -> Array[Resource]:
	var saved: Array[Resource] = []
	for material: ShaderMaterial in _foliage_materials.values():
		var path := SceneFiles.free_path("%s_%s" % [_path_prefix, material.resource_name.to_snake_case().validate_filename()], "tres")
		var error := WholeFile.save(material, path)
		if error != OK:
			_problem = "%s cannot be saved: %s." % [path, error_string(error)]
			return saved
		material.take_over_path(path)
		EditorInterface.get_resource_filesystem().update_file(path)
		saved.append(material)
	return saved


static func _title(entry: Variant) -> String:
	var resource := entry as Resource
	if resource == null:
		return "An empty entry"
	return resource.resource_name if resource.resource_name else resource.resource_path.get_file().get_basename().capitalize()
