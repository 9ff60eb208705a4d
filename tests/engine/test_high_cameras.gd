extends "picture_harness.gd"
## Tests high cameras and orthogonal cameras, which must see the same as low cameras, with and without fading materials. Tiles, thinning,
## LODs and fades must use the same distance. The tests compare the fraction of red pixels. All images show 80 m of ground vertically.

const TALL := 80.0 ## The height of the visible ground in an image, in meters.

var camera: Camera3D


## Returns a layer of red cubes that cover about a quarter of the ground.
func cubes(fades: bool) -> ScatterLayer:
	var material: Material = StandardMaterial3D.new()
	if fades:
		material = (load("res://addons/thicket/shaders/foliage.tres") as Material).duplicate()
		(material as ShaderMaterial).set_shader_parameter(&"albedo", Color.RED)
	else:
		(material as StandardMaterial3D).albedo_color = Color.RED
	var mesh := BoxMesh.new()
	mesh.size = Vector3.ONE * 2.0
	mesh.material = material
	var layer := ScatterLayer.new()
	layer.radius = 4.0
	layer.view_distance = 100.0
	layer.meshes = [mesh]
	return layer


func stage() -> void:
	root.size = Vector2i(240, 180)
	var sky := WorldEnvironment.new()
	sky.environment = Environment.new()
	sky.environment.background_mode = Environment.BG_COLOR
	sky.environment.background_color = Color.DODGER_BLUE
	root.add_child(sky)
	var sun := DirectionalLight3D.new()
	sun.rotation_degrees.x = -80.0
	root.add_child(sun)
	camera = Camera3D.new()
	camera.far = 10000.0
	root.add_child(camera)
	camera.make_current()


## Returns a scatter that shows all tiles within a few frames, because software rendering makes frames slow.
func quick_scatter(layers: Array[ScatterLayer], terrain: ScatterGround, viewer: Node3D) -> TerrainScatter3D:
	var scatter := make_scatter(layers, terrain, viewer)
	scatter.frame_budget_usec = 200000
	return scatter


func red() -> float:
	return await share_of_pixels(func(pixel: Color) -> bool: return pixel.r > 0.3 and pixel.g < 0.2 and pixel.b < 0.2)


func look_down_from(height: float, orthogonal: bool) -> void:
	camera.projection = Camera3D.PROJECTION_ORTHOGONAL if orthogonal else Camera3D.PROJECTION_PERSPECTIVE
	camera.rotation_degrees = Vector3(-90.0, 0.0, 0.0)
	camera.position = Vector3(0.0, height, 0.0)
	camera.fov = 2.0 * rad_to_deg(atan(0.5 * TALL / height))
	camera.size = TALL


func look_from_afar(distance: float) -> void:
	camera.projection = Camera3D.PROJECTION_ORTHOGONAL
	camera.size = TALL
	camera.position = Vector3.ONE.normalized() * distance
	camera.look_at(Vector3.ZERO)


func test_high_and_orthogonal_cameras_see_the_same_as_low_ones() -> void:
	stage()
	for fades: bool in [false, true]:
		var layer := cubes(fades)
		var scatter := quick_scatter([layer], ScatterGroundFlat.new(), camera)
		scatter.viewers = []
		look_down_from(80.0, false)
		await settle(scatter)
		var near := await red()
		check(near > 0.1 and near < 0.5, "fraction of red pixels from 80 m up: %.3f" % near)
		for height: float in [95.0, 150.0, 1000.0]:
			for orthogonal: bool in [false, true]:
				look_down_from(height, orthogonal)
				await settle(scatter)
				var seen := await red()
				# Without perspective, the sides of the cubes are hidden.
				check(seen > 0.55 * near and seen < 1.2 * near, "fades %s, %d m up, orthogonal %s: fraction of red pixels %.3f, from 80 m %.3f" % [
						fades, height, orthogonal, seen, near])
		for distance: float in [170.0, 1700.0]:
			look_from_afar(distance)
			await settle(scatter)
			var seen := await red()
			check(seen > 0.7 * near, "fades %s, isometric from %d m: fraction of red pixels %.3f" % [fades, distance, seen])
		scatter.queue_free()
		await frames(2)


## A camera that is not a viewer still renders a complete image.
func test_a_camera_that_is_not_a_viewer_sees_everything() -> void:
	stage()
	var shares := {}
	for fades: bool in [false, true]:
		var layer := cubes(fades)
		layer.view_distance = 130.0
		layer.meshes = with_lods(layer.meshes, [layer.meshes], [30.0])
		var player := make_viewer()
		var scatter := quick_scatter([layer], ScatterGroundFlat.new(), player)
		look_from_afar(1700.0)
		await settle(scatter)
		var seen := await red()
		player.position = Vector3(20.0, 0.0, 20.0)
		await settle(scatter)
		shares[fades] = [seen, await red()]
		scatter.queue_free()
		player.queue_free()
		await frames(2)
	check(shares[false][0] > 0.1, "fractions of red pixels: %s" % [shares])
	for index in 2: # The fading material also lights the shaded sides.
		check(absf(shares[true][index] / shares[false][index] - 1.15) < 0.1, "a fading material shows about as many red pixels: %s" % shares)


## Tiles surround the point on the ground at the center of the image, regardless of the ground's height.
func test_tiles_surround_the_target_of_an_orthogonal_camera() -> void:
	stage()
	var terrain := ScatterGroundFlat.new()
	terrain.height = 300.0
	var layer := cubes(true)
	layer.view_distance = 64.0
	camera.projection = Camera3D.PROJECTION_ORTHOGONAL
	camera.position = Vector3(1000.0, 1300.0, 0.0)
	camera.rotation_degrees = Vector3(-45.0, 0.0, 0.0) # The line of sight hits the ground 1,000 m ahead.
	var scatter := quick_scatter([layer], terrain, camera)
	scatter.viewers = []
	await settle(scatter)
	var middle := Vector2.ZERO
	var visible_tiles := scatter.get_shown_tiles(scatter.layers[0])
	for tile: Vector2i in visible_tiles:
		middle += (Vector2(tile) + Vector2.ONE * 0.5) * layer.tile_size / visible_tiles.size()
	check(middle.distance_to(Vector2(1000.0, -1000.0)) < layer.tile_size, "the tiles must surround the target, their middle is %s" % middle)


## A small view shows fine LODs and a large one coarse LODs, regardless of the camera's distance.
func test_the_size_of_an_orthogonal_view_chooses_lods() -> void:
	stage()
	var layer := cubes(false)
	var sphere := SphereMesh.new()
	layer.meshes = with_lods(layer.meshes, [[sphere]], [60.0])
	var scatter := quick_scatter([layer], ScatterGroundFlat.new(), camera)
	scatter.viewers = []
	var fine := {}
	for size: float in [40.0, 400.0]:
		for height: float in [200.0, 2000.0]:
			look_down_from(height, true)
			camera.size = size
			await settle(scatter)
			var meshes := scatter.get_tile(scatter.layers[0], Vector2i.ZERO).get_multimeshes(0).map(
					func(multimesh: RID) -> RID: return RenderingServer.multimesh_get_mesh(multimesh))
			fine[[size, height]] = lod_mesh(layer, 0, 0).get_rid() in meshes
	check_equal(fine, {[40.0, 200.0]: true, [40.0, 2000.0]: true, [400.0, 200.0]: false, [400.0, 2000.0]: false},
			"whether the fine mesh is drawn below the camera, by view size and height")


## A viewer with twice the distance scale sees four times the ground. The fade at the view distance scales too.
func test_a_viewers_scale_applies_to_the_fade() -> void:
	stage()
	var player := make_viewer()
	var layer := cubes(true)
	layer.view_distance = 60.0
	var scatter := quick_scatter([layer], ScatterGroundFlat.new(), player)
	look_down_from(400.0, true)
	camera.size = 300.0
	var seen := {}
	for scale: float in [0.5, 1.0, 2.0]:
		scatter.viewer_distance_scales = PackedFloat32Array([scale])
		await settle(scatter)
		seen[scale] = await red()
	check(seen[1.0] > 2.5 * seen[0.5] and seen[1.0] < 6.0 * seen[0.5], "four times the ground: %s" % seen)
	check(seen[2.0] > 3.0 * seen[1.0] and seen[2.0] < 5.0 * seen[1.0], "four times the ground: %s" % seen)


## Two nodes share a material. Each has its own viewer and does not hide the other's instances.
func test_nodes_share_a_material() -> void:
	stage()
	var layer := cubes(true)
	layer.view_distance = 50.0
	look_down_from(400.0, true)
	camera.size = 300.0
	var players: Array[Node3D] = [make_viewer(Vector3(-70.0, 0.0, 0.0)), make_viewer(Vector3(70.0, 0.0, 0.0))]
	var scatters: Array[TerrainScatter3D] = []
	var seen: Array[float] = []
	for player in players:
		scatters.append(quick_scatter([layer], ScatterGroundFlat.new(), player))
		await settle(scatters[-1])
		seen.append(await red())
	check(seen[0] > 0.01 and absf(seen[1] - 2.0 * seen[0]) < 0.3 * seen[0], "two nodes show twice as many red pixels as one: %s" % [seen])
	scatters[0].free()
	await frames(2)
	check(absf(await red() - seen[0]) < 0.3 * seen[0], "after one node was freed, the other shows as many as before: %s" % [seen])
