extends SceneTree
## Quits while tiles are generated and uploaded, and while a thread applies a diff. The runner checks the exit code and the output for
## leaks. `-- FRAMES` sets the number of frames before quitting.

class ThreadedGround extends ScatterGround:
	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(sin(at.x))
		return heights

	func _is_thread_safe() -> bool:
		return true


class Ground extends ThreadedGround:
	func _is_thread_safe() -> bool:
		return false


func _initialize() -> void:
	var removals := ScatterState.new()
	for index in 200_000:
		removals.remove(1 << 50 | index << 3)
	var diff := removals.diff_since(0)
	var state := ScatterState.new()
	var camera := Camera3D.new()
	root.add_child(camera)
	camera.make_current()
	for terrain: ScatterGround in [ScatterGroundFlat.new(), ThreadedGround.new(), Ground.new()]:
		var layer := ScatterLayer.new()
		layer.radius = 0.25
		layer.tile_size = 64.0
		layer.view_distance = 1000.0
		layer.meshes = [BoxMesh.new(), SphereMesh.new()]
		var scatter := TerrainScatter3D.new()
		scatter.layers = [layer]
		scatter.ground = terrain
		scatter.state = state
		root.add_child(scatter)
	for frame in int(OS.get_cmdline_user_args()[0]):
		await process_frame
	state.apply_diff_async(diff, func(_error: Error) -> void: print("the callback ran after quitting"))
	print("thicket quits in mid-generation")
	quit()
