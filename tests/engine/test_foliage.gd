extends "picture_harness.gd"
## Tests the add-on's foliage material, drawn in each of the three renderers.

const SHADER := "res://addons/thicket/shaders/foliage.gdshader"
const READY := "res://addons/thicket/shaders/foliage.tres"

var camera: Camera3D


## Creates an orthogonal camera along -z with a view `size` meters high and wide, only ambient light, and a black background.
func set_up_view(size := 4.0) -> void:
	root.size = Vector2i(128, 128)
	root.msaa_3d = Viewport.MSAA_DISABLED
	var environment := Environment.new()
	environment.background_mode = Environment.BG_COLOR
	environment.background_color = Color.BLACK
	environment.ambient_light_source = Environment.AMBIENT_SOURCE_COLOR
	environment.ambient_light_color = Color.WHITE
	camera = Camera3D.new()
	camera.environment = environment
	camera.projection = Camera3D.PROJECTION_ORTHOGONAL
	camera.size = size
	root.add_child(camera)
	camera.position = Vector3(0.0, 1.0, 10.0)
	camera.make_current()


func material(parameters: Dictionary) -> ShaderMaterial:
	var new_material := (load(READY) as ShaderMaterial).duplicate() as ShaderMaterial
	new_material.set_shader_parameter(&"wind_strength", 0.0)
	for parameter: StringName in parameters:
		new_material.set_shader_parameter(parameter, parameters[parameter])
	return new_material


## Returns a mesh that fades, with the LOD's range in CUSTOM3 of each vertex, as ScatterLayer creates it.
func faded(plain: Mesh, range_of_lod: Vector4) -> ArrayMesh:
	var arrays := plain.surface_get_arrays(0)
	var stream := PackedFloat32Array()
	for vertex in (arrays[Mesh.ARRAY_VERTEX] as PackedVector3Array).size():
		stream.append_array([range_of_lod.x, range_of_lod.y, range_of_lod.z, range_of_lod.w])
	arrays[Mesh.ARRAY_CUSTOM3] = stream
	var array_mesh := ArrayMesh.new()
	array_mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays, [], {},
			Mesh.ARRAY_CUSTOM_RGBA_FLOAT << Mesh.ARRAY_FORMAT_CUSTOM3_SHIFT)
	array_mesh.surface_set_material(0, plain.surface_get_material(0))
	return array_mesh


## Adds a pane, 1 m wide and 2 m high, at a position.
func pane(of: ShaderMaterial, at := Vector3.ZERO) -> MeshInstance3D:
	var mesh := QuadMesh.new()
	mesh.size = Vector2(1.0, 2.0)
	mesh.center_offset = Vector3(0.0, 1.0, 0.0)
	mesh.material = of
	var mesh_instance := MeshInstance3D.new()
	mesh_instance.mesh = mesh
	root.add_child(mesh_instance)
	mesh_instance.position = at
	return mesh_instance


func picture() -> Image:
	await frames(2)
	await RenderingServer.frame_post_draw
	return root.get_texture().get_image()


func lit(image: Image) -> Array[Vector2i]:
	var found: Array[Vector2i] = []
	for y in image.get_height():
		for x in image.get_width():
			if image.get_pixel(x, y).get_luminance() > 0.05:
				found.append(Vector2i(x, y))
	return found


func test_it_compiles_and_has_its_parameters() -> void:
	var names := PackedStringArray()
	for parameter: Dictionary in (load(SHADER) as Shader).get_shader_uniform_list():
		names.append(parameter.name)
	for wanted: String in ["wind_strength", "wind_sway", "wind_flutter", "bend_reach", "bend_bodies", "ground_strength",
			"backlight", "scatter_cross_fade"]:
		check(wanted in names, "the parameter %s is among %s" % [wanted, names])
	set_up_view()
	pane(material({}))
	var share: float = lit(await picture()).size() / 16384.0
	check(absf(share - 0.125) < 0.01, "the pane covers an eighth of the image, not %f" % share)


func test_the_tutorials_shader_draws() -> void:
	var page := FileAccess.get_file_as_string("res://addons/thicket/tutorials/your_own_tree.md")
	var shader := Shader.new()
	shader.code = page.get_slice("```glsl\n", 1).get_slice("```", 0)
	var new_material := ShaderMaterial.new()
	new_material.shader = shader
	set_up_view()
	pane(new_material)
	check_equal(lit(await picture()).size(), 32 * 64, "pixels of the pane")


func test_two_levels_cover_each_pixel_once() -> void:
	set_up_view()
	var near := pane(material({}))
	var far := pane(material({}))
	near.mesh = faded(near.mesh, Vector4(0.0, 13.0, 5.0 / 13.0, 1e9))
	far.mesh = faded(far.mesh, Vector4(13.0, 1e9, 5.0 / 13.0, 1e9))
	far.visible = false
	near.visible = true
	for away: float in [7.0, 8.5, 10.0, 11.25, 12.7, 14.0]:
		camera.position = Vector3(0.0, 1.0, sqrt(away * away - 1.0))
		near.visible = true
		far.visible = false
		var first: Array[Vector2i] = lit(await picture())
		near.visible = false
		far.visible = true
		var second: Array[Vector2i] = lit(await picture())
		var seen := {}
		for pixel in first + second:
			seen[pixel] = true
		check_equal(first.size() + second.size(), seen.size(), "pixels at %.1f m, none drawn twice" % away)
		check_equal(seen.size(), 32 * 64, "pixels at %.1f m, none missing" % away)
		var expected := clampf(1.0 - (away - 8.0) / 5.0, 0.0, 1.0)
		check(absf(first.size() / 2048.0 - expected) < 0.07, "fraction of the near LOD at %.1f m" % away)


func test_wind_moves_the_top() -> void:
	set_up_view()
	var parameters := {&"wind_sway": 0.5, &"sway_height": 2.0, &"wind_direction": Vector2(1.0, 0.0)}
	var standing := pane(material(parameters))
	var before: Array[Vector2i] = lit(await picture())
	await create_timer(0.5).timeout
	check_equal(lit(await picture()), before, "pixels after half a second without wind")
	parameters[&"wind_strength"] = 1.0
	var blowing := material(parameters)
	(standing.mesh as QuadMesh).material = blowing
	await create_timer(0.5).timeout
	check_equal(lit(await picture()).size(), before.size(), "pixels while nothing sets the time")
	var world := world_node()
	world.set(&"wind_strength", 1.0)
	world.set(&"wind_direction", Vector2(1.0, 0.0))
	world.set(&"materials", [blowing] as Array[ShaderMaterial])
	root.add_child(world)
	var moved := 0
	for look_number in 20: # Wind varies, so a few frames may all show lulls.
		if look_number >= 3 and moved >= 2:
			break
		await create_timer(0.3).timeout
		var now: Array[Vector2i] = lit(await picture())
		moved = maxi(moved, absi(now[0].x - before[0].x))
		check(absi(now[-1].x - before[-1].x) <= 1, "the foot of the plant does not move")
	check(moved >= 2, "the top of the plant moves by %d pixels" % moved)


## The editor draws only after changes. A shader that uses TIME would cause one in every frame.
func test_a_plant_in_view_requests_no_frames() -> void:
	set_up_view()
	pane(material({&"wind_strength": 1.0}))
	await frames(5)
	var requested := 0
	for frame in 10:
		await RenderingServer.frame_post_draw
		requested += int(RenderingServer.has_changed())
	check_equal(requested, 0, "frames of 10 after which another one is needed")


func test_a_body_bends_only_nearby_plants() -> void:
	set_up_view(8.0)
	var bodies := PackedVector4Array()
	bodies.resize(16)
	bodies[0] = Vector4(-2.6, 2.0, 0.0, 1.0)
	var parameters := {&"sway_height": 2.0, &"bend_bodies": bodies, &"bend_count": 0}
	var plants := [pane(material(parameters), Vector3(-2.0, 0.0, 0.0)), pane(material(parameters), Vector3(2.0, 0.0, 0.0))]
	var before: Array[Vector2i] = lit(await picture())
	parameters[&"bend_count"] = 1
	for plant: MeshInstance3D in plants:
		(plant.mesh as QuadMesh).material = material(parameters)
	var after: Array[Vector2i] = lit(await picture())
	var half := func(pixels: Array[Vector2i], left: bool) -> Array:
		return pixels.filter(func(pixel: Vector2i) -> bool: return (pixel.x < 64) == left)
	check_equal(half.call(after, false), half.call(before, false), "pixels of the plant far from the body")
	check(half.call(after, true) != half.call(before, true), "the plant next to the body bends")
	var right := func(pixels: Array) -> int: return pixels.map(func(pixel: Vector2i) -> int: return pixel.x).max()
	check(right.call(half.call(after, true)) > right.call(half.call(before, true)), "the plant bends away from the body")


func test_tint_takes_the_grounds_color_at_the_foot() -> void:
	set_up_view()
	pane(material({&"ground_strength": 1.0, &"ground_color": Color.RED, &"ground_height": 1.0}))
	var image: Image = await picture()
	var foot := image.get_pixel(64, 94)
	var top := image.get_pixel(64, 40)
	check(foot.r > 2.0 * foot.g and foot.r > 0.2, "the foot is red: %s" % foot)
	check(absf(top.r - top.g) < 0.02 and top.g > 0.2, "the top is not red: %s" % top)


func test_colors_are_the_same_in_all_renderers() -> void:
	set_up_view()
	pane(material({&"albedo": Color(0.5, 0.5, 0.5), &"backlight": 0.0}))
	var seen: float = (await picture()).get_pixel(64, 64).r
	check(absf(seen - 0.5) < 0.05, "half gray in white light is drawn as %f" % seen)


func test_coverage_does_not_depend_on_distance() -> void:
	var image := Image.create_empty(256, 256, false, Image.FORMAT_RGBA8)
	image.fill(Color(1.0, 1.0, 1.0, 0.0))
	# This image resembles leaves: dense in the middle, sparser toward the rim, and either fully opaque or fully transparent.
	var random := RandomNumberGenerator.new()
	random.seed = 3
	for y in range(0, 256, 4):
		for x in range(0, 256, 4):
			if random.randf() < 0.65 - 0.8 * Vector2(x - 128, y - 128).length() / 128.0:
				image.fill_rect(Rect2i(x, y, 4, 4), Color.WHITE)
	image.generate_mipmaps()
	set_up_view(3.0)
	pane(material({&"albedo_texture": ImageTexture.create_from_image(image)}))
	var near: float = lit(await picture()).size() / 16384.0 * 9.0
	camera.size = 9.0
	var far: float = lit(await picture()).size() / 16384.0 * 81.0
	check(far > 0.7 * near and far < 1.6 * near, "covered area: %f m² near, %f m² far" % [near, far])


func test_shadows_remain_during_a_fade() -> void:
	set_up_view()
	camera.environment.ambient_light_energy = 0.2
	camera.rotation_degrees.x = -60.0
	camera.position = Vector3(0.0, 9.0, 5.0)
	var ground := MeshInstance3D.new()
	ground.mesh = PlaneMesh.new()
	(ground.mesh as PlaneMesh).size = Vector2(20.0, 20.0)
	root.add_child(ground)
	var sun := DirectionalLight3D.new()
	sun.rotation_degrees = Vector3(-40.0, 20.0, 0.0)
	root.add_child(sun)
	var plant := pane(material({}))
	var plain := plant.mesh
	plant.mesh = faded(plain, Vector4(0.0, 13.0, 2.0 / 13.0, 1e9))
	plant.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_SHADOWS_ONLY
	var dark := func(image: Image) -> int:
		var open := image.get_pixel(4, 64).get_luminance()
		var count := 0
		for y in image.get_height():
			for x in image.get_width():
				count += int(image.get_pixel(x, y).get_luminance() < 0.8 * open)
		return count
	check_equal(dark.call(await picture()), 0, "dark pixels without shadows")
	sun.shadow_enabled = true
	var shadow: int = dark.call(await picture())
	check(shadow > 300, "a shadow of %d pixels, although the light is far away" % shadow)
	plant.mesh = faded(plain, Vector4(0.0, 6.0, 1.0 / 6.0, 1e9))
	check_equal(dark.call(await picture()), 0, "dark pixels beyond the view distance")


func test_the_world_node_sets_wind_and_bodies() -> void:
	var world: Node = (load("res://addons/thicket/shaders/foliage_world.gd") as GDScript).new()
	var one := material({})
	world.set(&"materials", [null, one] as Array[ShaderMaterial])
	world.set(&"wind_strength", 0.5)
	for number in 20:
		make_viewer(Vector3(number, 0.0, 0.0)).add_to_group(&"scatter_interaction")
	root.add_child(world)
	await frames(2)
	check_equal(one.get_shader_parameter(&"wind_strength"), 0.5, "wind strength")
	check_equal(one.get_shader_parameter(&"bend_count"), 16, "bodies out of 20")
	var bodies: PackedVector4Array = one.get_shader_parameter(&"bend_bodies")
	check_equal(bodies[3], Vector4(3.0, 0.0, 0.0, 0.6), "position and radius of a body")


## In a game, a scatter animates its plants itself.
func test_a_scatter_sets_the_time_of_its_materials() -> void:
	var layer := make_layer(2.0)
	var own := material({})
	layer.meshes = [bush(own)]
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var early: float = RenderingServer.material_get_param(own.get_rid(), &"wind_time")
	await create_timer(0.2).timeout
	var late: float = RenderingServer.material_get_param(own.get_rid(), &"wind_time")
	check(late - early > 0.1 and late - early < 2.0, "%.2f s have passed in 0.2 s" % (late - early))
	check_equal(own.get_shader_parameter(&"wind_time"), 0.0, "the material itself is unchanged")


func test_the_world_node_finds_multimeshes() -> void:
	root.add_child(world_node())
	var baked := MultiMeshInstance3D.new()
	baked.multimesh = MultiMesh.new()
	var own := material({})
	baked.multimesh.mesh = bush(own)
	root.add_child(baked)
	check_equal(await blown([own]), [true], "the wind of a baked plant")
	check(RenderingServer.material_get_param(own.get_rid(), &"wind_time") > 0.0, "the world node sets the time of a baked plant")


func world_node() -> Node:
	var world: Node = (load("res://addons/thicket/shaders/foliage_world.gd") as GDScript).new()
	world.set(&"wind_strength", 0.5)
	return world


func bush(of: Material) -> QuadMesh:
	var mesh := QuadMesh.new()
	mesh.material = of
	return mesh


## Returns for each material whether the world node has set its wind. Waits two frames first, in which the node can find the materials.
func blown(them: Array) -> Array:
	for one: ShaderMaterial in them:
		one.set_shader_parameter(&"wind_strength", 0.0)
	await frames(2)
	return them.map(func(one: ShaderMaterial) -> bool: return one.get_shader_parameter(&"wind_strength") == 0.5)


func test_the_world_node_finds_the_materials_of_scatters() -> void:
	var plain := ShaderMaterial.new()
	plain.shader = Shader.new()
	plain.shader.code = "shader_type spatial; uniform float wind_strength = 1.0;"
	var near := material({})
	var far := material({})
	var lod := ScatterLod.new()
	lod.mesh = bush(near)
	var model := ScatterModel.new()
	model.lods = [lod]
	var layer := make_layer(2.0)
	model.far_lods = [make_lod(bush(far), 50.0)]
	layer.meshes = [model, bush(plain), null]
	var scatter := make_scatter([layer, null], ScatterGroundFlat.new(), make_viewer(Vector3.ZERO))
	var world := world_node()
	root.add_child(world)
	check_equal(await blown([near, far, plain]), [true, true, false], "wind of materials of a model, of an LOD, and with another shader")

	var override := material({})
	layer.material_override = override
	check_equal(await blown([near, far, override]), [false, false, true], "wind if a material override replaces the others")
	layer.material_override = null
	lod.mesh = bush(override)
	check_equal(await blown([near, far, override]), [false, true, true], "wind after the model got a new mesh")

	var late := material({})
	var other := make_layer(3.0)
	other.meshes = [bush(late)]
	scatter.layers.append(other)
	check_equal(await blown([override, late]), [true, true], "wind after a script appended a layer")
	world.set(&"include_scatters", false)
	check_equal(await blown([override, late]), [false, false], "with include_scatters off")
	check(not layer.changed.is_connected(world.get(&"_on_layer_changed") as Callable), "it is disconnected from all layers")
	world.set(&"include_scatters", true)
	check_equal(await blown([override, late]), [true, true], "wind after include_scatters was enabled again")
	root.remove_child(scatter)
	check_equal(await blown([override, late]), [false, false], "wind with the scatter outside of the tree")
	root.add_child(scatter)
	check_equal(await blown([override, late]), [true, true], "wind with the scatter back in the tree")
	root.remove_child(world)
	check_equal(await blown([override, late]), [false, false], "wind with the world node outside of the tree")
	scatter.free()
	root.add_child(world)
	check_equal(await blown([override, late]), [false, false], "wind after the scatter was freed")


func test_the_world_node_finds_the_materials_of_presets() -> void:
	var meadow := (load("res://addons/thicket/presets/meadow.tscn") as PackedScene).instantiate() as TerrainScatter3D
	root.add_child(world_node())
	root.add_child(meadow)
	var found: Array = meadow.layers.map(func(layer: ScatterLayer) -> Material: return layer.get_materials()[0])
	check_equal(await blown(found), [true, true, true, true], "oaks, bushes, flowers and grass")


## The world node reads a layer again only when it emits `changed`.
func test_the_world_node_reads_layers_only_after_a_change() -> void:
	var layer := make_layer(2.0)
	var first := material({})
	layer.meshes = [bush(first)]
	make_scatter([layer], ScatterGroundFlat.new(), make_viewer(Vector3.ZERO))
	root.add_child(world_node())
	check_equal(await blown([first]), [true], "found")
	var second := material({})
	layer.set_block_signals(true)
	layer.material_override = second
	layer.set_block_signals(false)
	check_equal(await blown([first, second]), [true, false], "without a signal, the change is not detected")
	layer.emit_changed()
	check_equal(await blown([first, second]), [false, true], "with a signal, it is detected")
