extends "../engine/picture_harness.gd"
## Draws red cones and yellow boxes on green ground, checks that all three colors are visible, and sends the picture to the page.


func make_colored(mesh: PrimitiveMesh, color: Color) -> PrimitiveMesh:
	var material := StandardMaterial3D.new()
	material.albedo_color = color
	mesh.material = material
	return mesh


func make_plants(color: Color, mesh: PrimitiveMesh, radius: float) -> ScatterLayer:
	var layer := make_layer(radius)
	layer.meshes = [make_colored(mesh, color)]
	layer.min_scale = 0.7
	layer.view_distance = 100.0
	return layer


func test_picture() -> void:
	var camera := look_down()
	root.size = Vector2i(640, 360)
	camera.position = Vector3(0.0, 7.0, 24.0)
	camera.rotation_degrees.x = -18.0
	var sun := DirectionalLight3D.new()
	root.add_child(sun)
	sun.rotation_degrees = Vector3(-50.0, 40.0, 0.0)
	var ground := MeshInstance3D.new()
	var plane := PlaneMesh.new()
	plane.size = Vector2(400.0, 400.0)
	ground.mesh = make_colored(plane, Color.DARK_GREEN)
	root.add_child(ground)
	var cone := CylinderMesh.new()
	cone.top_radius = 0.0
	cone.bottom_radius = 1.0
	cone.height = 4.0
	var cones := make_plants(Color.RED, cone, 4.0)
	cones.height_offset = 2.0
	var boxes := make_plants(Color.YELLOW, BoxMesh.new(), 1.5)
	boxes.density = 0.5
	var scatter := make_scatter([cones, boxes], ScatterGroundFlat.new(), camera)
	await settle(scatter)
	check(scatter.get_shown_count(cones) > 100, "cones are displayed")
	for each: Array in [
		["red", func(color: Color) -> bool: return color.r > 0.3 and color.g < 0.5 * color.r],
		["yellow", func(color: Color) -> bool: return color.r > 0.3 and color.g > 0.7 * color.r and color.b < 0.5 * color.r],
		["green", func(color: Color) -> bool: return color.g > 0.1 and color.r < 0.5 * color.g],
	]:
		var share := await share_of_pixels(each[1])
		check(share > 0.03, "%s pixels cover %.3f of the picture" % [each[0], share])
	var png := Marshalls.raw_to_base64(root.get_texture().get_image().save_png_to_buffer())
	JavaScriptBridge.eval("report('picture', '%s')" % png)
