extends RefCounted
## Takes a screenshot of a tutorial's game. Replaces its plain cylinders with a preset's trees, and adds ground and sky.

const SIZE := Vector2i(800, 600)


static func take(game: Node3D, scatter: TerrainScatter3D, file: String) -> void:
	var tree := game.get_tree()
	tree.root.size = SIZE
	var preset: Node = load("res://addons/thicket/presets/forest.tscn").instantiate()
	scatter.layers[0].meshes = preset.layers[0].meshes.slice(0, 1) + preset.layers[2].meshes.slice(0, 1)
	scatter.layers[0].min_scale = 1.1
	scatter.layers[0].max_scale = 1.7
	scatter.layers[0].max_yaw_degrees = 360.0
	scatter.layers[0].view_distance = 250.0
	for material: ShaderMaterial in scatter.layers[0].get_materials():
		material.set_shader_parameter(&"wind_strength", 0.0) # Without wind, two screenshots are identical.
	preset.free()
	var ground := MeshInstance3D.new()
	ground.mesh = PlaneMesh.new()
	ground.mesh.size = Vector2(1000.0, 1000.0)
	ground.mesh.material = StandardMaterial3D.new()
	ground.mesh.material.albedo_color = Color(0.3, 0.36, 0.17)
	game.add_child(ground)
	var air := WorldEnvironment.new()
	air.environment = Environment.new()
	air.environment.background_mode = Environment.BG_SKY
	air.environment.sky = Sky.new()
	air.environment.sky.sky_material = ProceduralSkyMaterial.new()
	air.environment.ambient_light_source = Environment.AMBIENT_SOURCE_SKY
	game.add_child(air)
	for sun: DirectionalLight3D in game.find_children("*", "DirectionalLight3D", true, false):
		sun.shadow_enabled = true
	RenderingServer.render_loop_enabled = false # Stop rendering, because a software renderer takes seconds per frame.
	await tree.process_frame
	while not scatter.is_settled():
		await tree.process_frame
	RenderingServer.render_loop_enabled = true
	for frame in 4:
		await RenderingServer.frame_post_draw
	tree.root.get_texture().get_image().save_png(file)
