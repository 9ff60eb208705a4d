extends SceneTree
## Measures the cost of loaded, replaced or edited ground on the main thread. The values are the 99th percentile and the maximum
## of the node's time per frame (`frame_usec` in its stats), and the time until all tiles are up to date. Prints rows of a
## Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/ground_changes.gd [-- ONLY]
##
## ONLY is a part of a row's name. With `--xvfb --rendering-driver opengl3` in place of `--headless`, the triangles of
## meshes must be read back from the renderer. The frame budget is the node's default.

const MILLION := 706 ## The subdivisions of a plane with a million triangles.
const CHUNK := 64.0 ## Width of a chunk in meters.
const CHUNK_QUADS := 127 ## Results in chunks of 32,000 triangles.
const SPEED := 50.0 ## Speed of the viewer in meters per second.

var _viewer := Node3D.new()
var _only := ""


func _initialize() -> void:
	_run.call_deferred()


func _run() -> void:
	RenderingServer.render_loop_enabled = false
	root.add_child(_viewer)
	var arguments := OS.get_cmdline_user_args()
	_only = arguments[0] if arguments.size() > 0 else ""
	print("| measurement | p99 ms | max ms | up to date after s | tiles |")
	print("| --- | --- | --- | --- | --- |")
	await _measure("a first mesh of a million triangles", _million)
	await _measure("a mesh of a million triangles replaced", _million_replaced)
	await _measure("a mesh of 32,000 triangles replaced", _chunk_replaced)
	await _measure("chunks of 32,000 triangles at 50 m/s", _chunks)
	for side: int in [1024, 4096, 8192]:
		await _measure("a first heightmap of %d posts squared" % side, _heightmap.bind(side))
		await _measure("16 x 16 of %d posts squared, image set again" % side, _posts.bind(side, false))
		if ScatterGroundHeightmap.new().has_method(&"update_region"):
			await _measure("16 x 16 of %d posts squared, update_region" % side, _posts.bind(side, true))
	quit()


## Runs a case, which fills its [Frames], and prints its row.
func _measure(label: String, change: Callable) -> void:
	if _only and not _only in label:
		return
	var frames := Frames.new()
	await change.call(frames)
	frames.usec.sort()
	print("| %s | %.2f | %.2f | %.2f | %d |" % [label, frames.usec[floori(0.99 * (frames.usec.size() - 1))] / 1000.0,
			frames.usec[-1] / 1000.0, frames.seconds, frames.tiles])
	for child in root.get_children():
		if child != _viewer:
			child.free()
	await process_frame


## The measurements of a case.
class Frames:
	var usec: PackedInt64Array
	var seconds := 0.0
	var tiles := 0


func _scatter(terrain: ScatterGround) -> TerrainScatter3D:
	var layer := ScatterLayer.new()
	layer.radius = 2.0
	layer.tile_size = 32.0
	layer.view_distance = 128.0
	layer.meshes = [BoxMesh.new()]
	var scatter := TerrainScatter3D.new()
	scatter.layers = [layer]
	scatter.ground = terrain
	root.add_child(scatter)
	scatter.viewers = [scatter.get_path_to(_viewer)]
	_viewer.position = Vector3.ZERO
	return scatter


## Waits until the scatter has settled, and for at least [param at_least] frames. Records the frames.
func _follow(scatter: TerrainScatter3D, frames: Frames, at_least := 30) -> void:
	var start := Time.get_ticks_usec()
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	var waited := 0
	while waited < at_least or not scatter.is_settled():
		await process_frame # The node processes the frame after this signal.
		frames.usec.push_back(scatter.get_stats()["frame_usec"])
		waited += 1
		if scatter.get_stats()["tiles_made"] > tiles_made:
			frames.seconds = (Time.get_ticks_usec() - start) / 1e6 if frames.tiles == 0 else frames.seconds
			frames.tiles = scatter.get_stats()["tiles_made"] - tiles_made


func _grid(width: float, quads: int, height := 0.0) -> ArrayMesh:
	var plane := PlaneMesh.new()
	plane.size = Vector2(width, width)
	plane.subdivide_width = quads
	plane.subdivide_depth = quads
	plane.center_offset.y = height
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, plane.get_mesh_arrays())
	return mesh


func _put(mesh: Mesh, at := Vector3.ZERO) -> MeshInstance3D:
	var instance := MeshInstance3D.new()
	instance.mesh = mesh
	instance.position = at
	instance.add_to_group(&"ground")
	root.add_child(instance)
	return instance


func _on_meshes() -> TerrainScatter3D:
	var terrain := ScatterGroundMeshes.new()
	terrain.group = &"ground"
	return _scatter(terrain)


func _million(frames: Frames) -> void:
	_put(_grid(1000.0, MILLION))
	await _follow(_on_meshes(), frames)


func _million_replaced(frames: Frames) -> void:
	var ground := _put(_grid(1000.0, MILLION))
	var other := _grid(1000.0, MILLION, 1.0)
	var scatter := _on_meshes()
	await _follow(scatter, Frames.new())
	ground.mesh = other
	await _follow(scatter, frames, 100)


func _chunk_replaced(frames: Frames) -> void:
	var ground := _put(_grid(CHUNK, CHUNK_QUADS))
	_put(_grid(CHUNK, CHUNK_QUADS), Vector3(CHUNK, 0.0, 0.0))
	var other := _grid(CHUNK, CHUNK_QUADS, 1.0)
	var scatter := _on_meshes()
	await _follow(scatter, Frames.new())
	ground.mesh = other
	await _follow(scatter, frames, 100)


## Creates rows of chunks ahead of the viewer, and frees them behind it, as a streaming world does. Their creation is
## not part of the node's time.
func _chunks(frames: Frames) -> void:
	var rows: Dictionary[int, Array] = {}
	var scatter: TerrainScatter3D
	var start := Time.get_ticks_usec()
	while Time.get_ticks_usec() - start < 12e6:
		_viewer.position.x = SPEED * (Time.get_ticks_usec() - start) / 1e6
		var at := floori(_viewer.position.x / CHUNK)
		for row: int in range(at - 3, at + 4):
			if not rows.has(row):
				rows[row] = range(-3, 4).map(func(z: int) -> MeshInstance3D:
						return _put(_grid(CHUNK, CHUNK_QUADS), Vector3(row * CHUNK, 0.0, z * CHUNK)))
		for row: int in rows.keys():
			if row < at - 3:
				for chunk: Node in rows[row]:
					chunk.free()
				rows.erase(row)
		if scatter == null:
			scatter = _on_meshes()
			await _follow(scatter, Frames.new())
			start = Time.get_ticks_usec()
		await process_frame
		frames.usec.push_back(scatter.get_stats()["frame_usec"])
	frames.tiles = scatter.get_stats()["tiles_made"]
	frames.seconds = NAN


func _map(side: int) -> Image:
	return Image.create_empty(side, side, false, Image.FORMAT_RF)


func _on_map(image: Image) -> TerrainScatter3D:
	var terrain := ScatterGroundHeightmap.new()
	terrain.heights_in_meters = true
	terrain.rect = Rect2(-256.0, -256.0, 512.0, 512.0)
	terrain.image = image
	return _scatter(terrain)


func _heightmap(frames: Frames, side: int) -> void:
	await _follow(_on_map(_map(side)), frames)


func _posts(frames: Frames, side: int, by_region: bool) -> void:
	var image := _map(side)
	var scatter := _on_map(image)
	await _follow(scatter, Frames.new())
	var region := Rect2i(side / 2 + 20, side / 2 + 20, 16, 16)
	image.fill_rect(region, Color(3.0, 0.0, 0.0))
	if by_region:
		scatter.ground.call(&"update_region", region)
	else:
		(scatter.ground as ScatterGroundHeightmap).image = image
	await _follow(scatter, frames, 100)
