extends "picture_harness.gd"
## Tests the rendered image, because correct buffers do not prove that the image is correct.

const RED := Color(1.0, 0.0, 0.0)
const GREEN := Color(0.0, 1.0, 0.0)


func plain(color: Color) -> StandardMaterial3D:
	var material := StandardMaterial3D.new()
	material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	material.albedo_color = color
	return material


## Returns a scatter of red cubes on flat ground, seen from 40 m above on a black background.
func make_view() -> TerrainScatter3D:
	var environment := Environment.new()
	environment.background_mode = Environment.BG_COLOR
	environment.background_color = Color.BLACK
	var camera := look_down()
	camera.environment = environment
	var mesh := BoxMesh.new()
	mesh.material = plain(RED)
	var layer := make_layer(2.0)
	layer.tile_size = 8.0
	layer.meshes = [mesh]
	return make_scatter([layer], ScatterGroundFlat.new(), camera)


## Returns the fraction of the image's pixels that have a color, with a tolerance.
func share(color: Color) -> float:
	return await share_of_pixels(func(pixel: Color) -> bool:
		return absf(pixel.r - color.r) + absf(pixel.g - color.g) + absf(pixel.b - color.b) < 0.1)


## Returns a scatter of cubes that are colored by an instance shader parameter in their scene.
func make_tinted_view() -> TerrainScatter3D:
	var scatter := make_view()
	var material := ShaderMaterial.new()
	material.shader = Shader.new()
	material.shader.code = "shader_type spatial;\nrender_mode unshaded;\ninstance uniform vec4 tint : source_color = vec4(1.0, 0.0, 0.0, 1.0);\nvoid fragment() { ALBEDO = tint.rgb; }"
	var mesh_instance := MeshInstance3D.new()
	mesh_instance.name = "Shown"
	mesh_instance.mesh = BoxMesh.new()
	mesh_instance.mesh.material = material
	var root_node := Node3D.new()
	root_node.add_child(mesh_instance)
	mesh_instance.owner = root_node
	var packed := PackedScene.new()
	packed.pack(root_node)
	root_node.free()
	scatter.layers[0].meshes = [with_shader_parameter(packed, "Shown", "tint = Color(0, 1, 0, 1)")]
	return scatter


func test_instance_shader_parameters_of_a_scene() -> void:
	var scatter := make_tinted_view()
	scatter.layers[0].tile_size = 32.0
	await settle(scatter)
	check(await share(GREEN) > 0.15 and await share(RED) == 0.0, "all cubes are green")
	check_equal(scatter.get_problems(), PackedStringArray(), "the renderer's buffer has room for all parameters")


func test_properties_change_the_image() -> void:
	var scatter := make_view()
	await settle(scatter)
	var layer := scatter.layers[0] as ScatterLayer
	# There are 0.1741 instances per square meter. Each shows its top of 1 m², slightly enlarged by perspective, and a
	# side.
	var red: float = await share(RED)
	check(red > 0.15 and red < 0.35, "%f of the image is red" % red)

	scatter.visible = false
	check_equal(await share(RED), 0.0, "red of a hidden node")
	scatter.seed = 9
	await settle(scatter)
	check_equal(await share(RED), 0.0, "red of tiles that were generated while the node was hidden")
	scatter.visible = true
	red = await share(RED)
	check(red > 0.15, "red of the visible node: %f" % red)

	layer.material_override = plain(GREEN)
	await settle(scatter)
	var green: float = await share(GREEN)
	check(green > 0.15 and await share(RED) == 0.0, "green with a new material: %f" % green)
	layer.material_override = null

	layer.render_layers = 2
	root.get_camera_3d().cull_mask = 1
	await settle(scatter)
	check_equal(await share(RED), 0.0, "red on a render layer that the camera excludes")
	scatter.seed = 10
	await settle(scatter)
	check_equal(await share(RED), 0.0, "red of new tiles on that layer")
	layer.render_layers = 1

	layer.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_SHADOWS_ONLY
	await settle(scatter)
	check_equal(await share(RED), 0.0, "red of shadows only")
	layer.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_ON
	await settle(scatter)

	# Uploads one buffer per frame, so there are many frames between the first new tile and the last.
	scatter.frame_budget_usec = 1
	var mesh := BoxMesh.new()
	mesh.material = plain(GREEN)
	layer.meshes = [mesh]
	var mixed := 0
	while await share(GREEN) < 0.9 * red:
		check(await share(RED) + await share(GREEN) > 0.8 * red, "old tiles stay until new ones are ready")
		mixed += 1
	check(mixed > 2, "%d frames show both old and new tiles" % mixed)
	scatter.frame_budget_usec = 20000
	mesh = BoxMesh.new()
	mesh.material = plain(RED)
	layer.meshes = [mesh]
	await settle(scatter)

	layer.density = 0.1
	await settle(scatter)
	var sparse: float = await share(RED)
	check(sparse > 0.01 and sparse < 0.25 * red, "red at a tenth of the density: %f" % sparse)

	scatter.queue_free()
	check_equal(await share(RED), 0.0, "red after the node was freed")


func test_boxes_of_tiles_contain_their_meshes() -> void:
	var scatter := make_view()
	var mesh := BoxMesh.new()
	mesh.size = Vector3(0.5, 20.0, 0.5)
	var layer := scatter.layers[0] as ScatterLayer
	layer.meshes = [mesh]
	layer.min_scale = 0.5
	layer.max_scale = 2.0
	await settle(scatter)
	var scenario := root.world_3d.scenario
	var seen_at := func(height: float) -> bool:
		var box := AABB(Vector3(-10.0, height, -10.0), Vector3(20.0, 0.1, 20.0))
		return scatter.get_instance_id() in RenderingServer.instances_cull_aabb(box, scenario)
	check(seen_at.call(0.0), "boxes reach the ground")
	check(seen_at.call(19.0), "boxes reach the top of instances scaled by 2")
	check(seen_at.call(-19.0), "boxes reach their bottom")
	check(not seen_at.call(60.0), "boxes are not too large")


## Returns the height in meters up to which the renderer's culling finds the node.
func top_of(scatter: TerrainScatter3D) -> float:
	var low := 0.0
	var high := 100.0
	while high - low > 1e-3:
		var middle := 0.5 * (low + high)
		var box := AABB(Vector3(-10.0, middle, -10.0), Vector3(20.0, 100.0, 20.0))
		if scatter.get_instance_id() in RenderingServer.instances_cull_aabb(box, root.world_3d.scenario):
			low = middle
		else:
			high = middle
	return low


func foliage(parameters: Dictionary) -> ShaderMaterial:
	var material := (load("res://addons/thicket/shaders/foliage.tres") as ShaderMaterial).duplicate() as ShaderMaterial
	for parameter: StringName in parameters:
		material.set_shader_parameter(parameter, parameters[parameter])
	return material


## Returns `top_of` a new node whose layer `edit` has changed. The node must be new, because the renderer rounds boxes up when they
## grow.
func top_with(edit: Callable) -> float:
	var scatter := make_view()
	edit.call(scatter.layers[0])
	await settle(scatter)
	var top := top_of(scatter)
	scatter.free()
	return top


func test_boxes_of_plants_include_their_sway() -> void:
	var still: float = await top_with(func(_layer: ScatterLayer) -> void: pass)
	var grown_by := func(wanted: float, context: String, edit: Callable) -> void:
		var grown: float = await top_with(edit) - still
		check(absf(grown - wanted) < 0.01, "%s: %f m instead of %f" % [context, grown, wanted])
	var sways_by := func(wanted: float, context: String, material: Material) -> void:
		await grown_by.call(wanted, context, func(layer: ScatterLayer) -> void: layer.material_override = material)
	var swaying := {&"wind_sway": 1.0, &"wind_flutter": 0.25, &"bend_reach": 0.5}
	await sways_by.call((0.12 + 0.03) * 2.0 + 0.4, "defaults of the shader", foliage({}))
	await sways_by.call(3.0, "parameters of a material", foliage(swaying))
	await sways_by.call(5.5, "a stronger wind", foliage(swaying.merged({&"wind_strength": 4.0})))
	await sways_by.call(0.0, "parameters that move nothing",
			foliage({&"wind_sway": -1.0, &"wind_flutter": NAN, &"bend_reach": -1.0}))
	await sways_by.call(0.0, "another material", plain(RED))
	await grown_by.call(4.5, "with the margin of the layer", func(layer: ScatterLayer) -> void:
		layer.material_override = foliage(swaying)
		layer.extra_cull_margin = 1.5)
	await grown_by.call(3.0, "the mesh of an LOD", func(layer: ScatterLayer) -> void:
		var coarse := BoxMesh.new()
		coarse.material = foliage(swaying)
		layer.meshes = with_lods(layer.meshes, [[coarse]], [1000.0]))


func test_boxes_update_when_the_layer_changes() -> void:
	var scatter := make_view()
	var layer := scatter.layers[0] as ScatterLayer
	layer.material_override = foliage({})
	await settle(scatter)
	var top := top_of(scatter)
	var uploads: int = scatter.get_stats().uploads
	layer.material_override.set_shader_parameter(&"bend_reach", 30.0)
	await settle(scatter)
	check_equal(top_of(scatter), top, "height after a change without a signal")
	layer.emit_changed()
	await settle(scatter)
	check(top_of(scatter) > 30.0, "the layer reads the material again")
	check_equal(scatter.get_stats().uploads, uploads, "uploads for a new margin")


func test_removed_tiles_are_invisible_when_settled() -> void:
	var scatter := make_view()
	var layer := scatter.layers[0] as ScatterLayer
	layer.view_distance = 90.0
	layer.tile_size = 4.0
	layer.draw_cell_size = 1.0
	scatter.frame_budget_usec = 100
	var viewer := Node3D.new()
	root.add_child(viewer)
	viewer.position.x = -60.0 # Tiles around this position remain visible.
	scatter.viewers = [scatter.get_path_to(viewer)]
	await settle(scatter)
	check(await share(RED) > 0.05, "red within the view distance")
	scatter.viewer_distance_scales = [0.0] # Prevents new tiles, which would take time.
	await frames(2)
	while not scatter.is_settled():
		await process_frame
	RenderingServer.force_draw(false)
	var image := root.get_texture().get_image()
	var red := 0
	for x in image.get_width():
		for y in image.get_height():
			red += int(image.get_pixel(x, y).r > 0.5)
	check_equal(red, 0, "red pixels in the first settled frame")
	viewer.free()


func test_materials_of_a_layer() -> void:
	var scatter := make_view()
	var layer := scatter.layers[0] as ScatterLayer
	var near: Material = (layer.meshes[0] as BoxMesh).material
	var coarse := BoxMesh.new()
	coarse.material = foliage({})
	var lod := ScatterLod.new()
	lod.mesh = BoxMesh.new()
	lod.shadow_mesh = BoxMesh.new()
	(lod.shadow_mesh as BoxMesh).material = plain(GREEN)
	var model := ScatterModel.new()
	model.lods = [lod]
	layer.meshes = with_lods([layer.meshes[0], null, model, layer.meshes[0]], [[coarse, null, null, coarse]], [50.0])
	check_equal(layer.get_materials(), [near, coarse.material, lod.shadow_mesh.material] as Array[Material], "materials of the layer's meshes and LODs")
	layer.material_override = plain(GREEN)
	check_equal(layer.get_materials(), [layer.material_override] as Array[Material], "materials of a layer with an override")


func picture() -> Image:
	await frames(3)
	await RenderingServer.frame_post_draw
	return root.get_texture().get_image()


## Returns the fraction of pixels that differ.
func difference(a: Image, b: Image) -> float:
	var count := 0
	for x in a.get_width():
		for y in a.get_height():
			count += int(a.get_pixel(x, y) != b.get_pixel(x, y))
	return count / float(a.get_width() * a.get_height())


func test_a_recenter_a_thousand_kilometers_out_is_invisible() -> void:
	var scatter := make_view()
	var camera := root.get_camera_3d()
	scatter.world_offset = Vector3(1048576.0, 0.0, -1048576.0)
	await settle(scatter)
	var before: Image = await picture()
	var red: float = await share(RED)
	check(red > 0.15 and red < 0.5, "fraction of red a thousand kilometers out: %f" % red)
	for step in 4:
		camera.position -= Vector3(128.0, 0.0, 64.0)
		scatter.world_offset += Vector3(128.0, 0.0, 64.0)
		await process_frame
		# In single precision, 700 m from the engine's origin, an edge may fall on the other side of a pixel center.
		check(difference(await picture(), before) < 0.005, "the image after recentering %d" % step)
	check(difference(before, await picture()) < 0.005, "the image stays the same")
	camera.position.x += 8.0
	check(difference(before, await picture()) > 0.05, "a moved camera sees a different image")


## Must be the last test, because the engine keeps printing errors afterward.
func test_the_limit_of_instance_uniforms_is_a_problem() -> void:
	var scatter := make_tinted_view()
	scatter.layers[0].tile_size = 4.0
	await settle(scatter)
	var many: int = scatter.get_draw_stats()["multimeshes"]
	var problems := "\n".join(scatter.get_problems())
	check(many > 256 and "%d multimeshes have shaders with instance uniforms" % many in problems, "%d: %s" % [many, problems])
	check(not errors.take().is_empty(), "the engine has no room for all parameters")
	scatter.free()
	errors.take()


## A bake that replaces its scatter looks the same.
func test_a_bake_shows_its_scatter() -> void:
	var scatter := make_view()
	await settle(scatter)
	var before := await share(RED)
	var bake := preload("res://addons/thicket/bake.gd").new()
	check_equal(bake.begin(scatter, Rect2(-50.0, -50.0, 120.0, 120.0), "res://baked_picture", "cubes"), OK, bake.problem)
	while bake.step(20.0):
		await process_frame
	scatter.queue_free()
	await frames(2)
	check_equal(await share(RED), 0.0, "the bake has replaced the scatter")
	root.add_child((load(bake.scene_path) as PackedScene).instantiate())
	var after := await share(RED)
	check(before > 0.15 and absf(after - before) < 0.005, "%.3f of the image before the bake, %.3f after it" % [before, after])
