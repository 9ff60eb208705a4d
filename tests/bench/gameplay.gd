extends SceneTree
## What a game's questions and changes cost: queries on tiles that are known and on tiles that are not, removals, and
## the size of a state. Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/gameplay.gd [-- ROUNDS]
##
## Times are on the clock, of calls from GDScript, which a busy machine lengthens; the lowest round is the one that was
## disturbed least.

const DEFAULT_ROUNDS := 9
const RADIUS := 100.0 ## Metres, of the circle that is asked.
const CALLS := 500    ## Rays and the like in a round.
const PATIENCE_SECONDS := 120.0
const MILLION := 1000000

var _scatter: TerrainScatter3D
var _random := RandomNumberGenerator.new()
var _center := Vector3(310.0, 0.0, -270.0) ## On the ground.


func _initialize() -> void:
	_random.seed = 1
	_run.call_deferred()


func _run() -> void:
	var rounds := DEFAULT_ROUNDS
	var arguments := OS.get_cmdline_user_args()
	if arguments.size() > 0:
		rounds = maxi(1, arguments[0].to_int())
	_make_scene()
	if not await _idle():
		return _end("not idle after %.0f s" % PATIENCE_SECONDS)
	_measure_circles(rounds)
	_measure_single(rounds)
	_measure_removals(rounds)
	_measure_states()
	_end("")


## Trees, ferns and grass on the demo's ground, around one viewer.
func _make_scene() -> void:
	var demo := (load(ProjectSettings.get_setting("application/run/main_scene")) as PackedScene).instantiate()
	var terrain: ScatterTerrain
	for node in demo.find_children("*", "TerrainScatter3D", true, false):
		terrain = node.get(&"terrain")
	demo.free()
	var viewer := Node3D.new()
	root.add_child(viewer)
	_center.y = terrain.get_height(_center)
	viewer.global_position = _center
	_scatter = TerrainScatter3D.new()
	_scatter.terrain = terrain
	_scatter.layers = [_make_layer(4.0, 64.0), _make_layer(1.35, 32.0), _make_layer(0.4, 16.0)]
	root.add_child(_scatter)
	_scatter.viewers = [_scatter.get_path_to(viewer)]


func _make_layer(radius: float, tile_size: float) -> ScatterLayer:
	var layer := ScatterLayer.new()
	layer.radius = radius
	layer.tile_size = tile_size
	layer.view_distance = 160.0
	layer.instance_radius = 0.1 * radius
	layer.instance_height = radius
	layer.meshes = [BoxMesh.new()]
	return layer


func _idle() -> bool:
	var limit := Time.get_ticks_msec() + int(PATIENCE_SECONDS * 1000.0)
	await process_frame
	await process_frame
	while not _scatter.is_idle():
		if Time.get_ticks_msec() > limit:
			return false
		await process_frame
	return true


## Microseconds that a call takes.
func _time(call: Callable) -> float:
	var start := Time.get_ticks_usec()
	call.call()
	return float(Time.get_ticks_usec() - start)


func _measure_circles(rounds: int) -> void:
	var asked := {"trees": [0], "trees and ferns": [0, 1], "grass": [2]}
	for what: String in asked:
		var layers := PackedInt32Array(asked[what])
		var warm := []
		var cold := []
		var found: PackedInt64Array = _scatter.query_sphere(_center, RADIUS, layers)["ids"]
		for round in rounds:
			var far := _on_ground(_center + Vector3(400.0, 0.0, 300.0 * (round + 1)))
			cold.push_back(_time(_scatter.query_sphere.bind(far, RADIUS, layers)) / 1e3)
			warm.push_back(_time(_scatter.query_sphere.bind(_center, RADIUS, layers)) / 1e3)
		_row("query_sphere of %.0f m, %d instances of %s, tiles known" % [RADIUS, found.size(), what], warm, "ms", 2)
		_row("the same elsewhere, tiles made on the spot", cold, "ms", 1)


## Rays, nearest and single instances among trees and ferns.
func _measure_single(rounds: int) -> void:
	var ids: PackedInt64Array = _scatter.query_sphere(_center, RADIUS, [0, 1])["ids"]
	var rays := []
	var nearest := []
	var by_id := []
	for round in rounds:
		rays.push_back(_each(func() -> void:
			var from := _somewhere()
			_scatter.query_ray(from, from + 50.0 * Vector3.FORWARD.rotated(Vector3.UP, _random.randf() * TAU), [0, 1])))
		nearest.push_back(_each(func() -> void: _scatter.query_nearest(_somewhere(), 30.0, [0, 1])))
		by_id.push_back(_each(func() -> void: _scatter.get_instance(ids[_random.randi() % ids.size()])))
	_row("query_ray over 50 m through trees and ferns, tiles known", rays, "µs", 1)
	_row("query_nearest within 30 m, trees and ferns, tiles known", nearest, "µs", 1)
	_row("get_instance by id, tiles known", by_id, "µs", 1)


## A place a metre above the ground, near enough for rays to stay where tiles are known.
func _somewhere() -> Vector3:
	var off := 40.0 * Vector3(_random.randf_range(-1, 1), 0, _random.randf_range(-1, 1))
	return _on_ground(_center + off) + Vector3.UP


func _on_ground(at: Vector3) -> Vector3:
	return Vector3(at.x, _scatter.terrain.get_height(at), at.z)


func _each(call: Callable) -> float:
	return _time(func() -> void:
		for index in CALLS:
			call.call()) / CALLS


## One by one, and the ferns around a place at once; the picture drawn anew is part of it.
func _measure_removals(rounds: int) -> void:
	var single := []
	var many := []
	var count := 0
	for round in rounds:
		var ids: PackedInt64Array = _scatter.query_sphere(_center, 30.0, [1])["ids"]
		single.push_back(ids.size() * 1e6 / _time(func() -> void:
			for id in ids:
				_scatter.remove_instance(id)
			_draw()))
		_restore(ids)
		count = ids.size()
		many.push_back(count * 1e6 / _time(func() -> void:
			_scatter.remove_in_sphere(_center, 30.0, [1])
			_draw()))
		_restore(ids)
	_row("remove_instance, %d one by one in a frame, picture included" % count, single, "a second", 0)
	_row("remove_in_sphere, %d at once, picture included" % count, many, "a second", 0)


## Whoever looks at a tile sees what was changed.
func _draw() -> void:
	for tile: Vector2i in _scatter.get_shown_tiles(1):
		_scatter.get_tile_ids(1, tile)


func _restore(ids: PackedInt64Array) -> void:
	for id in ids:
		_scatter.restore_instance(id)
	_draw()


func _measure_states() -> void:
	var spread := ScatterState.new()
	while spread.get_removed_count() < MILLION:
		spread.remove(_random.randi() << 16 | _random.randi() & 0xffff) # The 48 bits of a cell.
	_row_bytes("state, %d removals spread over all cells of a layer" % MILLION, spread)
	var bytes := spread.to_bytes()
	var loaded := ScatterState.new()
	_row("state, %d removals: to_bytes" % MILLION, [_time(spread.to_bytes) / 1e3], "ms", 0)
	_row("state, %d removals: from_bytes" % MILLION, [_time(loaded.from_bytes.bind(bytes)) / 1e3], "ms", 0)
	var wood := ScatterState.new()
	var ids: PackedInt64Array = _scatter.query_sphere(_center, 2.0 * RADIUS, [1])["ids"]
	for id in ids:
		if _random.randi() % 3 == 0:
			wood.remove(id)
	_row_bytes("state, %d removals, a third of the ferns of a wood" % wood.get_removed_count(), wood)


func _row_bytes(what: String, state: ScatterState) -> void:
	_row(what + ": bytes a removal", [float(state.to_bytes().size()) / state.get_removed_count()], "", 2)


## What, the median, the lowest and the highest round, and how many.
func _row(what: String, rounds: Array, unit: String, digits: int) -> void:
	var sorted := rounds.duplicate()
	sorted.sort()
	var end := "" if unit == "" else " " + unit
	var number := "%." + str(digits) + "f"
	var median: String = number % sorted[sorted.size() / 2]
	var ends := [number % sorted[0], number % sorted[-1], end]
	print("| %s | %s%s | %s to %s%s | %d |" % ([what, median, end] + ends + [sorted.size()]))


func _end(failure: String) -> void:
	if failure != "":
		printerr("gameplay: " + failure)
	if _scatter != null:
		_scatter.queue_free()
	quit(0 if failure == "" else 1)
