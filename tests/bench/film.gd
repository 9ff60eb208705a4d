extends "bench.gd"
## Records a slow flight over the demo as one image per frame, for films and to find LODs that pop. Needs a renderer:
##   tools/godot --xvfb --path demo_project --script tests/bench/film.gd -- FOLDER STOP FRAMES METERS
##
## The camera moves METERS ahead per frame, at the stop's height above the ground, without wind. Once the flight has
## started, it does not wait for the scatter, so unfinished tiles are missing. The demo's camera determines what is drawn.
## The last argument `lod_fade=0` disables cross-fades, which makes popping visible.

const SIZE := Vector2i(480, 270)

var _demo: Node3D


func run() -> String:
	var arguments := OS.get_cmdline_user_args()
	if arguments.size() < 4:
		return "the arguments must be FOLDER STOP FRAMES METERS"
	if DirAccess.make_dir_recursive_absolute(arguments[0]) != OK:
		return "cannot create the folder %s" % arguments[0]
	root.size = SIZE
	_demo = (load(ProjectSettings.get_setting("application/run/main_scene")) as PackedScene).instantiate()
	root.add_child(_demo)
	await process_frame
	root.msaa_3d = Viewport.MSAA_DISABLED
	root.scaling_3d_scale = 2.0
	scatter = _demo.get(&"scatter")
	for world in root.find_children("*", "", true, false):
		if &"wind_strength" in world:
			world.set(&"wind_strength", 0.0)
	if "lod_fade=0" in arguments:
		for layer: ScatterLayer in scatter.layers:
			layer.lod_fade = 0.0
	var failure := await _fly(arguments[0], arguments[1], arguments[2].to_int(), arguments[3].to_float())
	scatter = null # The scatter is freed with the demo.
	_demo.queue_free()
	return failure


func _fly(folder: String, stop_name: String, count: int, meters: float) -> String:
	var stops: Array = _demo.call(&"stops")
	var matches := stops.filter(func(stop: Dictionary) -> bool: return stop.name == stop_name)
	if matches.is_empty():
		return "there is no stop %s" % stop_name
	_demo.call(&"show_overlay", false)
	var stop: Dictionary = matches[0].duplicate()
	var heading := deg_to_rad(stop.heading)
	for index in count:
		_demo.call(&"place", stop)
		stop.eye += Vector3(sin(heading), 0.0, -cos(heading)) * meters
		if index == 0:
			root.disable_3d = true # Software rendering would leave too little time for streaming.
			var failure := await idle()
			root.disable_3d = false
			if failure != "":
				return failure
		await process_frame
		await RenderingServer.frame_post_draw
		if root.get_texture().get_image().save_png(folder.path_join("%04d.png" % index)) != OK:
			return "cannot write an image to %s" % folder
	print("%d images from %s on, %.2f m apart" % [count, stop_name, meters])
	return ""
