extends SceneTree
## Writes the plants and stones of the presets, with their materials and texture, to addons/thicket/presets/plants:
##     bash demo_project/meshes/save_models.sh
## With [code]-- --out=FOLDER[/code], writes only the models, into another folder of the project. The test of the
## presets compares those models with the models in the add-on.

const Species := preload("res://meshes/species.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const Drawing := preload("res://meshes/leaf_atlas_drawing.gd")
const Materials := preload("res://meshes/plant_materials.gd")
const Stone := preload("res://meshes/stone.gd")
const FOLIAGE := preload("res://addons/thicket/shaders/foliage.gdshader")
const STONE := preload("res://addons/thicket/shaders/stone.gdshader")
const FOLDER := "res://addons/thicket/presets/plants/"

## The number of individuals of each species in the presets.
const MODELS := {
	&"oak": 3, &"birch": 3, &"spruce": 3, &"pine": 3, &"shrub": 3, &"heather": 2, &"dry_shrub": 2, &"fern": 2, &"grass": 4, &"flower": 3,
	&"reed": 2, &"cactus": 4, &"agave": 2, &"stone": 4, &"rock": 4, &"sandstone": 3, &"red_rock": 3, &"pebbles": 2, &"stump": 2, &"log": 2,
}
## The material parameters that differ from the shader's defaults. Trees do not bend around characters.
const PARAMETERS := {
	"oak": {"sway_height": 14.0, "wind_sway": 0.12, "wind_flutter": 0.03, "bend_reach": 0.0, "backlight": 0.35},
	"birch": {"sway_height": 13.0, "wind_sway": 0.16, "wind_flutter": 0.035, "bend_reach": 0.0, "backlight": 0.4},
	"spruce": {"sway_height": 21.0, "wind_sway": 0.2, "wind_flutter": 0.02, "bend_reach": 0.0, "backlight": 0.2},
	"pine": {"sway_height": 19.0, "wind_sway": 0.2, "wind_flutter": 0.02, "bend_reach": 0.0, "backlight": 0.2},
	"shrub": {"sway_height": 1.7, "wind_sway": 0.05, "wind_flutter": 0.012, "bend_reach": 0.25, "backlight": 0.4},
	"heather": {"sway_height": 0.5, "wind_sway": 0.02, "wind_flutter": 0.006, "bend_reach": 0.2, "backlight": 0.4},
	"dry_shrub": {"sway_height": 1.0, "wind_sway": 0.04, "wind_flutter": 0.008, "bend_reach": 0.2, "backlight": 0.3},
	"fern": {"sway_height": 0.5, "wind_sway": 0.03, "wind_flutter": 0.01, "backlight": 0.5},
	"grass": {"sway_height": 0.6, "wind_sway": 0.07, "wind_flutter": 0.01, "backlight": 0.6},
	"flower": {"sway_height": 0.5, "wind_sway": 0.05, "wind_flutter": 0.01, "backlight": 0.5},
	"reed": {"sway_height": 2.0, "wind_sway": 0.12, "wind_flutter": 0.015, "backlight": 0.5},
	"succulent": {"wind_sway": 0.0, "wind_flutter": 0.0, "bend_reach": 0.0, "backlight": 0.0},
	"wood": {"wind_sway": 0.0, "wind_flutter": 0.0, "bend_reach": 0.0, "backlight": 0.0},
	"mossy_stone": {},
	"bare_stone": {"moss_strength": 0.0},
}
## The radius and the height of the trunks that block characters, in meters, by species.
const TRUNKS := {
	&"oak": Vector2(0.45, 6.0), &"birch": Vector2(0.22, 6.0), &"spruce": Vector2(0.36, 6.0), &"pine": Vector2(0.36, 9.0),
	&"stump": Vector2(0.45, 0.5), &"cactus": Vector2(0.3, 4.5),
}
## The species whose collision shape is the convex hull of their coarsest LOD.
const SOLID: Array[StringName] = [&"stone", &"sandstone", &"log"]


func _initialize() -> void:
	var folder := FOLDER
	for argument in OS.get_cmdline_user_args():
		if argument.begins_with("--out="):
			folder = argument.trim_prefix("--out=").path_join("")
	DirAccess.make_dir_recursive_absolute(folder)
	if folder == FOLDER:
		_save_materials()
	var saved_count := 0
	for species: StringName in MODELS:
		for variant: int in MODELS[species]:
			var error := ResourceSaver.save(model_of(species, variant), "%s%s_%d.res" % [folder, species, variant + 1], ResourceSaver.FLAG_COMPRESS)
			saved_count += int(error == OK)
	print("%d models saved in %s" % [saved_count, folder])
	quit()


## Returns the model of a species' variant, with a mesh for each LOD, and a collision shape if it blocks characters.
static func model_of(species: StringName, variant: int) -> ScatterModel:
	var builder := Species.build(species, variant)
	var model := ScatterModel.new()
	var lods: Array[ScatterLod] = []
	for level in builder.level_count():
		var lod := ScatterLod.new()
		lod.resource_scene_unique_id = "lod_%d" % level
		lod.mesh = builder.mesh_of(level, Materials.of(species))
		lod.mesh.resource_scene_unique_id = "mesh_%d" % level
		lod.distance = builder.distance(level)
		lods.append(lod)
	model.lods = lods
	var shape := _shape_of(species, lods[lods.size() - 1].mesh)
	if shape:
		shape.resource_scene_unique_id = "shape"
		model.shapes = [shape]
		model.shape_transforms = [Transform3D(Basis.IDENTITY, Vector3.UP * TRUNKS[species].y * 0.5 if TRUNKS.has(species) else Vector3.ZERO)]
	return model


static func _shape_of(species: StringName, coarsest: Mesh) -> Shape3D:
	if TRUNKS.has(species):
		var trunk := CylinderShape3D.new()
		trunk.radius = TRUNKS[species].x
		trunk.height = TRUNKS[species].y
		return trunk
	if species in SOLID:
		var hull := ConvexPolygonShape3D.new()
		hull.points = coarsest.surface_get_arrays(0)[Mesh.ARRAY_VERTEX]
		return hull
	return null


func _save_materials() -> void:
	var texture := PortableCompressedTexture2D.new()
	texture.keep_compressed_buffer = true
	texture.create_from_image(Drawing.new().draw(), PortableCompressedTexture2D.COMPRESSION_MODE_LOSSLESS)
	ResourceSaver.save(texture, Atlas.FILE, ResourceSaver.FLAG_COMPRESS)
	texture.take_over_path(Atlas.FILE)
	DirAccess.make_dir_recursive_absolute(Materials.FOLDER)
	for name: String in PARAMETERS:
		var material := ShaderMaterial.new()
		material.shader = STONE if name.ends_with("_stone") else FOLIAGE
		if material.shader == FOLIAGE:
			material.set_shader_parameter(&"albedo_texture", texture)
		for parameter: String in PARAMETERS[name]:
			material.set_shader_parameter(parameter, PARAMETERS[name][parameter])
		var path := Materials.FOLDER + name + ".tres"
		ResourceSaver.save(material, path)
		material.take_over_path(path)
		# Removes the lines of parameters that are not set.
		var lines := Array(FileAccess.get_file_as_string(path).split("\n")).filter(func(line: String) -> bool: return not line.ends_with(" = null"))
		FileAccess.open(path, FileAccess.WRITE).store_string("\n".join(lines))
