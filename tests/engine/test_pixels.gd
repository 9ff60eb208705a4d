extends "picture_harness.gd"
## What a camera sees: the one thing that buffers do not tell.

const RED := Color(1.0, 0.0, 0.0)
const GREEN := Color(0.0, 1.0, 0.0)


func plain(color: Color) -> StandardMaterial3D:
	var material := StandardMaterial3D.new()
	material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	material.albedo_color = color
	return material


## Cubes that stand close together on flat ground, seen from 40 m above, on black.
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
	return make_scatter([layer], ScatterTerrainFlat.new(), camera)


## The share of the picture that is of a color.
func share(color: Color) -> float:
	return await share_of_pixels(func(pixel: Color) -> bool:
		return absf(pixel.r - color.r) + absf(pixel.g - color.g) + absf(pixel.b - color.b) < 0.1)


func test_what_a_camera_sees() -> void:
	var scatter := make_view()
	await settle(scatter)
	var layer := scatter.layers[0] as ScatterLayer
	# 0.1741 instances a square meter, each with a top of 1 m² that perspective makes a little larger, and a side in
	# view.
	var red: float = await share(RED)
	check(red > 0.15 and red < 0.35, "the picture is red to %f" % red)

	scatter.visible = false
	check_equal(await share(RED), 0.0, "red of a hidden node")
	scatter.seed = 9
	await settle(scatter)
	check_equal(await share(RED), 0.0, "red of tiles that came while the node was hidden")
	scatter.visible = true
	red = await share(RED)
	check(red > 0.15, "red of the node shown again: %f" % red)

	layer.material_override = plain(GREEN)
	await settle(scatter)
	var green: float = await share(GREEN)
	check(green > 0.15 and await share(RED) == 0.0, "green of another material: %f" % green)
	layer.material_override = null

	layer.render_layers = 2
	root.get_camera_3d().cull_mask = 1
	await settle(scatter)
	check_equal(await share(RED), 0.0, "red on a render layer that the camera does not see")
	scatter.seed = 10
	await settle(scatter)
	check_equal(await share(RED), 0.0, "red of new tiles on that layer")
	layer.render_layers = 1

	layer.visibility_range_end = 30.0
	await settle(scatter)
	check_equal(await share(RED), 0.0, "red beyond the visibility range")
	layer.visibility_range_end = 0.0

	layer.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_SHADOWS_ONLY
	await settle(scatter)
	check_equal(await share(RED), 0.0, "red of shadows only")
	layer.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_ON
	await settle(scatter)

	# One buffer a frame, so that there are many frames between the first new tile and the last.
	scatter.upload_budget_usec = 1
	var mesh := BoxMesh.new()
	mesh.material = plain(GREEN)
	layer.meshes = [mesh]
	var mixed := 0
	while await share(GREEN) < 0.9 * red:
		check(await share(RED) + await share(GREEN) > 0.8 * red, "old tiles stay until new ones are there")
		mixed += 1
	check(mixed > 2, "%d looks in between" % mixed)
	scatter.upload_budget_usec = 20000
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


func test_boxes_around_tiles_hold_their_meshes() -> void:
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
	check(seen_at.call(19.0), "boxes reach the top of what is scaled by 2")
	check(seen_at.call(-19.0), "and the bottom")
	check(not seen_at.call(60.0), "boxes end somewhere")


func picture() -> Image:
	await frames(3)
	await RenderingServer.frame_post_draw
	return root.get_texture().get_image()


## The share of pixels that differ.
func difference(a: Image, b: Image) -> float:
	var count := 0
	for x in a.get_width():
		for y in a.get_height():
			count += int(a.get_pixel(x, y) != b.get_pixel(x, y))
	return count / float(a.get_width() * a.get_height())


func test_a_recenter_a_thousand_kilometers_out_is_not_seen() -> void:
	var scatter := make_view()
	var camera := root.get_camera_3d()
	scatter.world_offset = Vector3(1048576.0, 0.0, -1048576.0)
	await settle(scatter)
	var before: Image = await picture()
	var red: float = await share(RED)
	check(red > 0.15 and red < 0.5, "share of red a thousand kilometers out: %f" % red)
	for step in 4:
		camera.position -= Vector3(128.0, 0.0, 64.0)
		scatter.world_offset += Vector3(128.0, 0.0, 64.0)
		await process_frame
		# Single precision 700 m from the engine's origin may change which side of a pixel's middle an edge lies on.
		check(difference(await picture(), before) < 0.005, "the picture after recenter %d" % step)
	check(difference(before, await picture()) < 0.005, "and in the end")
	camera.position.x += 8.0
	check(difference(before, await picture()) > 0.05, "a camera that moves sees something else")
