extends "harness.gd"
## Tests the presets and their models.

const NewLayers := preload("res://addons/thicket/editor/layers/new_layers.gd")

const FOLDER := "res://addons/thicket/presets/"
const NAMES: PackedStringArray = ["forest", "meadow", "pine_wood", "shore", "scree", "desert"]


func preset(preset_name: String) -> TerrainScatter3D:
	return (load(FOLDER + preset_name + ".tscn") as PackedScene).instantiate() as TerrainScatter3D


## On a hill beside a lake, every layer of every preset has instances, and no preset reports a problem.
func test_every_layer_of_every_preset_grows() -> void:
	for preset_name in NAMES:
		var scatter := preset(preset_name)
		scatter.ground = make_script_ground(HILL)
		scatter.water_enabled = true
		scatter.water_level = -12.0
		root.add_child(scatter)
		scatter.viewers = [scatter.get_path_to(make_viewer())]
		check_equal(scatter.get_problems(), PackedStringArray(), "problems of " + preset_name)
		for layer in scatter.layers:
			var found := scatter.query_rect(Rect2(-120.0, -120.0, 240.0, 240.0), layer)
			check(found.ids.size() > 3, "%s of %s: %d instances" % [layer.resource_name, preset_name, found.ids.size()])
			check(layer.min_scale < layer.max_scale and layer.max_yaw_degrees > 300.0, "%s of %s varies" % [layer.resource_name, preset_name])
		scatter.free()


## Presets follow the rule of the panel for new layers: a layer fills the gaps around earlier layers if all of these have similar radii.
func test_presets_fill_like_new_layers() -> void:
	var filling := 0
	for preset_name in NAMES:
		var scatter := preset(preset_name)
		var by_name := {}
		for layer in scatter.layers:
			var similar := not layer.spacing.is_empty()
			for other: String in layer.spacing:
				var both: Array[float] = [layer.radius, by_name[other].radius]
				similar = similar and both.min() / both.max() >= NewLayers.SIMILARITY
			check_equal(layer.spacing_fills, similar, "%s of %s fills" % [layer.resource_name, preset_name])
			filling += int(similar)
			by_name[layer.resource_name] = layer
		scatter.free()
	check(filling >= NAMES.size(), "%d layers fill" % filling)


const HILL := """extends ScatterGround

func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
	var heights := PackedFloat32Array()
	for at in positions:
		heights.append(30.0 * sin(0.016 * at.x) * cos(0.017 * at.y) + 5.0 * sin(0.06 * at.x))
	return heights
"""


func make_script_ground(code: String) -> ScatterGround:
	var script := GDScript.new()
	script.source_code = code
	script.reload()
	var ground := ScatterGround.new()
	ground.set_script(script)
	return ground


## Checks the models' LODs. Coarser LODs have fewer triangles (or at most 20), start farther away, and are about as large as the finest. Each
## model's first material fades.
func test_models_have_lods_that_fade() -> void:
	var seen := {}
	for preset_name in NAMES:
		var scatter := preset(preset_name)
		for layer in scatter.layers:
			for model: ScatterModel in layer.meshes:
				seen[model.resource_path] = model
		scatter.free()
	check(seen.size() > 40, "%d models" % seen.size())
	for path: String in seen:
		var model: ScatterModel = seen[path]
		check(model.lods.size() >= 2, path + " has at least two LODs")
		for index in range(1, model.lods.size()):
			check(triangles(model.lods[index]) < triangles(model.lods[index - 1]) or triangles(model.lods[index]) <= 20, "%s: LOD %d is coarser" % [path, index])
			check(model.lods[index].distance > model.lods[index - 1].distance, "%s: LOD %d starts farther away" % [path, index])
			var size := model.lods[index].mesh.get_aabb().size.length() / model.lods[0].mesh.get_aabb().size.length()
			check(size > 0.7 and size < 1.4, "%s: LOD %d is %.2f times as large" % [path, index, size])
		var material := model.lods[0].mesh.surface_get_material(0) as ShaderMaterial
		check(material.shader.get_shader_uniform_list().any(func(uniform: Dictionary) -> bool: return uniform.name == "scatter_cross_fade"), path + " fades")


func triangles(lod: ScatterLod) -> int:
	return lod.mesh.surface_get_arrays(0)[Mesh.ARRAY_INDEX].size() / 3


## Scenes of version 0.2 contain meshes with a script that stores only a kind of plant.
func test_meshes_of_former_presets_show_the_current_models() -> void:
	var script: GDScript = load(FOLDER + "preset_mesh.gd")
	for kind: String in script.MODELS:
		var mesh := ArrayMesh.new()
		mesh.set_script(script)
		mesh.set(&"kind", kind)
		var model: ScatterModel = load(FOLDER + "plants/%s.res" % script.MODELS[kind])
		check(mesh.get_surface_count() == 1 and mesh.get_aabb().is_equal_approx(model.lods[0].mesh.get_aabb()), "%s: %s" % [kind, mesh.get_aabb()])
		check_equal(mesh.surface_get_material(0), model.lods[0].mesh.surface_get_material(0), kind + ": the material")
		var path := "user://%s.tres" % kind
		ResourceSaver.save(mesh, path)
		check(FileAccess.get_file_as_string(path).length() < 600, kind + " stores only its kind")
