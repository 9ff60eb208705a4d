extends SceneTree
## Takes screenshots of models and of their impostors, for test_impostors.py: `godot --path PROJECT --script impostor_pictures.gd -- FOLDER`.
## The camera is at the distance where the impostor replaces the model on a screen with 1080 lines. There are 16 views for each of two sun
## directions, in files such as FOLDER/tree_s0_d05_model.png. The screenshots have twice the usual resolution, so that aliased edges do not
## affect the comparison.

const Impostor := preload("res://addons/thicket/impostor.gd")
const Models := preload("impostor_models.gd")

const SIDE := 192
const LINES := 1080.0
const FOV := 75.0
## The camera's elevations above the horizon, in degrees.
const HEIGHTS: Array[float] = [3.0, 12.0, 25.0, 50.0]
const SUNS: Array[Vector3] = [Vector3(-40.0, -60.0, 0.0), Vector3(-30.0, 130.0, 0.0)]
## The scale of the instance, which is also rotated.
const SCALE := 1.2

var _camera := Camera3D.new()
var _sun := DirectionalLight3D.new()
var _instances := MultiMeshInstance3D.new()


func _initialize() -> void:
	_run.call_deferred()


func _run() -> void:
	root.size = Vector2i(SIDE, SIDE)
	root.scaling_3d_scale = 2.0
	_set_stage()
	for name: String in ["tree", "stone"]:
		var model: ArrayMesh = Models.tree() if name == "tree" else Models.stone()
		var baker := Impostor.new()
		var started := Time.get_ticks_msec()
		var impostor := baker.bake([model])
		if impostor == null:
			printerr(baker.problem)
			quit(1)
			return
		# In the Compatibility renderer, a crown's impostor does not shadow itself.
		_sun.shadow_enabled = name == "stone" or RenderingServer.get_current_rendering_method() != "gl_compatibility"
		print("%s: baked in %d ms" % [name, Time.get_ticks_msec() - started])
		await _take_all(name, model, impostor)
	quit()


func _set_stage() -> void:
	var world := WorldEnvironment.new()
	world.environment = Environment.new()
	world.environment.background_mode = Environment.BG_COLOR
	world.environment.background_color = Color(0.55, 0.65, 0.75)
	world.environment.ambient_light_source = Environment.AMBIENT_SOURCE_COLOR
	world.environment.ambient_light_color = Color(0.6, 0.65, 0.7)
	world.environment.ambient_light_energy = 0.6
	root.add_child(world)
	_sun.directional_shadow_max_distance = 200.0
	root.add_child(_sun)
	var ground := MeshInstance3D.new()
	ground.mesh = PlaneMesh.new()
	(ground.mesh as PlaneMesh).size = Vector2(400.0, 400.0)
	ground.material_override = StandardMaterial3D.new()
	(ground.material_override as StandardMaterial3D).albedo_color = Color(0.3, 0.36, 0.2)
	root.add_child(ground)
	_instances.multimesh = MultiMesh.new()
	_instances.multimesh.transform_format = MultiMesh.TRANSFORM_3D
	_instances.multimesh.instance_count = 1
	_instances.multimesh.set_instance_transform(0, Transform3D(Basis(Vector3.UP, 0.4).scaled(Vector3.ONE * SCALE), Vector3.ZERO))
	root.add_child(_instances)
	_camera.fov = rad_to_deg(2.0 * atan(tan(deg_to_rad(FOV) * 0.5) * SIDE / LINES))
	root.add_child(_camera)
	_camera.make_current()


func _take_all(name: String, model: Mesh, impostor: Mesh) -> void:
	var distance := Impostor.switch_distance(impostor, FOV, LINES) * SCALE
	var middle := model.get_aabb().get_center() * SCALE
	for sun in SUNS.size():
		_sun.rotation_degrees = SUNS[sun]
		for direction in 16:
			var azimuth := TAU * (direction + 0.3) / 16.0 * 3.0
			var height := deg_to_rad(HEIGHTS[direction % HEIGHTS.size()])
			var toward := Vector3(cos(azimuth) * cos(height), sin(height), sin(azimuth) * cos(height))
			_camera.look_at_from_position(middle + toward * distance, middle)
			for drawn: Array in [["model", model], ["impostor", impostor]]:
				_instances.multimesh.mesh = drawn[1]
				var file := "%s_s%d_d%02d_%s.png" % [name, sun, direction, drawn[0]]
				await _take(OS.get_cmdline_user_args()[0].path_join(file))


func _take(path: String) -> void:
	for frame in 3: # The renderer may take some frames to draw new objects correctly.
		await process_frame
	await RenderingServer.frame_post_draw
	root.get_texture().get_image().save_png(path)
