extends SceneTree
## Renders the flights of the film over the demo's first scene, one image per frame. Needs a renderer:
##   tools/godot --xvfb --fixed-fps 12 --path demo_project --script tools/film/flight.gd -- FOLDER [FRAMES]
##
## FOLDER receives a folder for each shot. FRAMES is the number of frames per shot, for tests; without it, a shot has its full length. Every frame waits
## until the scatter has settled, and time stops during the wait. Therefore no tile is missing, and waves and wind do not depend on the machine.

const FPS := 12
const SIZE := Vector2i(960, 540)
## Antialiasing: the size of the rendered image as a factor of SIZE. In a software renderer, this is faster than multisampling.
const SUPERSAMPLING := 1.334
const PATIENCE_MSEC := 600_000
## Each shot starts at a stop of the demo. `ahead` and `rise` are the camera's movement in meters, and `turn` and `tilt` its rotation in degrees. If
## `walks` is true, the camera stays at the stop's height above the ground.
const SHOTS: Array[Dictionary] = [
	{"stop": "forest", "seconds": 4.5, "ahead": 80.0, "rise": 8.0, "turn": 6.0, "tilt": -1.0, "walks": false},
	{"stop": "overview", "seconds": 4.5, "ahead": 80.0, "rise": -10.0, "turn": -8.0, "tilt": 0.0, "walks": false},
	{"stop": "walk", "seconds": 4.0, "ahead": 8.0, "rise": 0.0, "turn": 2.0, "tilt": 0.0, "walks": true},
	{"stop": "lake", "seconds": 3.5, "ahead": 3.0, "rise": 5.0, "turn": 5.0, "tilt": -3.0, "walks": false},
]

var _demo: Node3D


func _initialize() -> void:
	_render.call_deferred()


func _render() -> void:
	var arguments := OS.get_cmdline_user_args()
	var failure := "the arguments must be FOLDER [FRAMES]"
	if arguments.size() > 0:
		_open_demo()
		failure = ""
		for shot in SHOTS:
			if failure == "":
				failure = await _render_shot(shot, arguments[0].path_join(shot.stop), arguments[1].to_int() if arguments.size() > 1 else 0)
	if failure != "":
		printerr("flight: ", failure)
	RenderingServer.render_loop_enabled = true # A process that draws nothing might not quit.
	quit(0 if failure == "" else 1)


func _open_demo() -> void:
	root.size = SIZE
	root.msaa_3d = Viewport.MSAA_DISABLED
	root.scaling_3d_scale = SUPERSAMPLING
	_demo = (load(ProjectSettings.get_setting("application/run/main_scene")) as PackedScene).instantiate()
	root.add_child(_demo)
	_demo.call(&"show_overlay", false)


## Renders a shot into a folder. Returns an error message, or an empty string.
func _render_shot(shot: Dictionary, folder: String, frames: int) -> String:
	if DirAccess.make_dir_recursive_absolute(folder) != OK:
		return "cannot create the folder %s" % folder
	var total := int(shot.seconds * FPS)
	var start_msec := Time.get_ticks_msec()
	var camera: Camera3D = _demo.get(&"camera")
	var stop: Dictionary = _demo.call(&"stops").filter(func(candidate: Dictionary) -> bool: return candidate.name == shot.stop)[0]
	_demo.call(&"place", stop)
	var first := camera.transform
	for frame in (mini(frames, total) if frames > 0 else total):
		_move(camera, stop, shot, first, float(frame) / total)
		var failure := await _settle()
		if failure != "":
			return failure
		RenderingServer.force_draw(true, 1.0 / FPS)
		if root.get_texture().get_image().save_png(folder.path_join("%04d.png" % frame)) != OK:
			return "cannot write an image to %s" % folder
	print("flight: %s took %.1f s" % [shot.stop, (Time.get_ticks_msec() - start_msec) / 1000.0])
	return ""


## Moves the camera to its position after a fraction of the shot.
func _move(camera: Camera3D, stop: Dictionary, shot: Dictionary, first: Transform3D, fraction: float) -> void:
	var heading: float = deg_to_rad(stop.heading)
	var distance: float = shot.ahead
	var position := first.origin + Vector3(sin(heading), 0.0, -cos(heading)) * distance * fraction
	if shot.walks:
		var ground: RefCounted = _demo.get(&"ground")
		position.y = ground.call(&"height", position.x, position.z) + stop.eye.y
	else:
		position.y += shot.rise * fraction
	var angles := Vector3(deg_to_rad(stop.pitch + shot.tilt * fraction), -heading - deg_to_rad(shot.turn * fraction), 0.0)
	camera.transform = Transform3D(Basis.from_euler(angles), position)


## Waits until all plants of the current view are visible, without drawing. Then lets the time advance by one frame.
func _settle() -> String:
	RenderingServer.render_loop_enabled = false
	Engine.time_scale = 0.0
	var deadline := Time.get_ticks_msec() + PATIENCE_MSEC
	for frame in 3: # The scatter detects the camera's move in the next frame.
		await process_frame
	var scatter: Node3D = _demo.get(&"scatter")
	while not scatter.call(&"is_settled"):
		if Time.get_ticks_msec() > deadline:
			return "some tiles were not visible after %d s" % (PATIENCE_MSEC / 1000)
		await process_frame
	Engine.time_scale = 1.0
	await process_frame
	return ""
