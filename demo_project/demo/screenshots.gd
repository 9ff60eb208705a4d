extends Node
## Visits a scene's stops without user input, writes a screenshot at each of them, prints the statistics, and quits. If the scene has a flight, the
## camera first flies along it.
##
## The engine does not draw the 3D world between the stops, so that streaming runs at full speed even with a software renderer.

const Figures := preload("res://demo/figures.gd")

## The frame rate during the flight, in frames per second.
const FLIGHT_FPS := 60
## The time in seconds after which a stop fails if the scatter has not settled.
const PATIENCE := 600.0
## The number of frames to draw before a screenshot, so that LODs and shadows settle.
const SETTLING_FRAMES := 2

## The demo's root.
var demo: Node3D
## The folder for the screenshots; created if it does not exist. Empty for no screenshots, for runs without a renderer.
var folder := ""
## The names of the stops to visit, without the flight. Empty for all stops and the flight.
var only := PackedStringArray()

var _failed := false


## Runs everything and ends the process with exit code 0 on success, or 1 on failure.
func run() -> void:
	# Supersampling with four samples per pixel smooths leaves as well as edges. In a software renderer, it is much faster than multisampling.
	get_viewport().msaa_3d = Viewport.MSAA_DISABLED
	get_viewport().scaling_3d_scale = 2.0
	if folder != "" and DirAccess.make_dir_recursive_absolute(folder) != OK:
		_fail("cannot create the folder %s" % folder)
	if not _failed and only.is_empty() and demo.flight_seconds() > 0.0:
		await _fly()
	for stop: Dictionary in demo.stops():
		if not _failed and (only.is_empty() or only.has(stop.name)):
			await _visit(stop)
	print("demo: %s" % ("FAILED" if _failed else "done"))
	# Restores the default. Otherwise, a failed run would hang in a loop that draws nothing.
	RenderingServer.render_loop_enabled = true
	get_tree().quit(1 if _failed else 0)


## Moves along the flight without drawing, and prints the statistics.
func _fly() -> void:
	RenderingServer.render_loop_enabled = false
	demo.place(demo.stops()[0])
	demo.fly(0.0)
	await _wait_until_idle()
	Engine.max_fps = FLIGHT_FPS
	var figures: Figures = demo.figures
	figures.clear()
	for frame in int(demo.flight_seconds() * FLIGHT_FPS):
		demo.fly(float(frame) / FLIGHT_FPS)
		await get_tree().process_frame
	Engine.max_fps = 0
	figures.frozen = true
	print("demo: flight of %.0f s" % demo.flight_seconds())
	print(figures.text().indent("demo: "))


func _visit(stop: Dictionary) -> void:
	# Draws frames, but without the 3D world. If no frames were drawn, Forward+ and Mobile would wait for one at each upload.
	get_viewport().disable_3d = true
	RenderingServer.render_loop_enabled = true
	var start_msec := Time.get_ticks_msec()
	demo.place(stop)
	demo.show_tiles(stop.get("tiles", false))
	demo.show_overlay(stop.get("tiles", false))
	await _wait_until_idle()
	if _failed:
		return
	var stats: Dictionary = demo.scatter.get_stats()
	print("demo: %s: %d tiles, %d instances, idle after %.1f s" % [
		stop.name, stats.tiles, stats.instances, (Time.get_ticks_msec() - start_msec) / 1000.0])
	if folder == "":
		return
	get_viewport().disable_3d = false
	start_msec = Time.get_ticks_msec()
	for frame in SETTLING_FRAMES:
		await RenderingServer.frame_post_draw
	print("demo: %s: %.1f s per frame" % [stop.name, (Time.get_ticks_msec() - start_msec) / 1000.0 / SETTLING_FRAMES])
	var image := get_viewport().get_texture().get_image()
	var path := folder.path_join("%s.png" % stop.name)
	if image == null or image.is_empty() or image.save_png(path) != OK:
		_fail("cannot write %s" % path)


func _wait_until_idle() -> void:
	var deadline := Time.get_ticks_msec() + int(PATIENCE * 1000.0)
	# The scatter detects the camera's jump in the next frame.
	for frame in 3:
		await get_tree().process_frame
	while not demo.scatter.is_settled():
		if Time.get_ticks_msec() > deadline:
			_fail("not idle after %.0f s: %s" % [PATIENCE, demo.scatter.get_stats()])
			return
		await get_tree().process_frame


func _fail(message: String) -> void:
	_failed = true
	printerr("demo: %s" % message)
