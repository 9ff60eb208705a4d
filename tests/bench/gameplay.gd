extends "bench.gd"
## Measures the cost of a game's queries and changes: queries on cached and on missing tiles, removals, and the size of a state.
## Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/gameplay.gd [-- ROUNDS]
##
## Times are the wall time of calls from GDScript, which a busy machine increases. The lowest round is the least
## disturbed one.

const DEFAULT_ROUNDS := 9
const RADIUS := 100.0 ## The radius of the queried circle in meters.
const CALLS := 500    ## The number of rays and similar calls per round.
const MILLION := 1000000

var _random := RandomNumberGenerator.new()
var _center := Vector3(310.0, 0.0, -270.0) ## A position on the ground.


func run() -> String:
	_random.seed = 1
	var rounds := rounds_or(DEFAULT_ROUNDS)
	_make_scene()
	var failure := await idle()
	if failure == "":
		_measure_circles(rounds)
		_measure_single(rounds)
		_measure_removals(rounds)
		_measure_states()
	return failure


## Creates trees, ferns and grass on the demo's ground, around one viewer.
func _make_scene() -> void:
	var terrain := demo_terrain()
	var viewer := Node3D.new()
	_center.y = terrain.get_height(_center)
	viewer.position = _center
	make_scatter(terrain, [_make_layer(4.0, 64.0), _make_layer(1.35, 32.0), _make_layer(0.4, 16.0)], viewer)


func _make_layer(radius: float, tile_size: float) -> ScatterLayer:
	var layer := ScatterLayer.new()
	layer.radius = radius
	layer.tile_size = tile_size
	layer.view_distance = 160.0
	layer.instance_radius = 0.1 * radius
	layer.instance_height = radius
	layer.meshes = [BoxMesh.new()]
	return layer


func _measure_circles(rounds: int) -> void:
	var layer_sets := {"trees": scatter.layers.slice(0, 1), "trees and ferns": scatter.layers.slice(0, 2), "grass": scatter.layers.slice(2, 3)}
	for label: String in layer_sets:
		var layers: Array = layer_sets[label]
		var warm := []
		var cold := []
		var read := []
		var known_ids: PackedInt64Array = scatter.query_sphere(_center, RADIUS, layers).ids
		for round in rounds:
			var distant := _on_ground(_center + Vector3(400.0, 0.0, 300.0 * (round + 1)))
			cold.push_back(time_of(scatter.query_sphere.bind(distant, RADIUS, layers)) / 1e3)
			warm.push_back(time_of(scatter.query_sphere.bind(_center, RADIUS, layers)) / 1e3)
			read.push_back(time_of(_read_all.bind(layers)) / 1e3)
		var query := "query_sphere of %.0f m, %d instances of %s, " % [RADIUS, known_ids.size(), label]
		row(query + "tiles known", warm, "ms", 2)
		row(query + "tiles known, ids, positions and transforms read", read, "ms", 2)
		row("query_sphere of %.0f m elsewhere, %s, tiles generated on demand" % [RADIUS, label], cold, "ms", 1)


func _read_all(layers: Array) -> int:
	var all := scatter.query_sphere(_center, RADIUS, layers)
	return all.ids.size() + all.positions.size() + all.transforms.size()


## Measures queries for rays, nearest instances and single instances among trees and ferns.
func _measure_single(rounds: int) -> void:
	var ids: PackedInt64Array = scatter.query_sphere(_center, RADIUS, [scatter.layers[0], scatter.layers[1]]).ids
	var rays := []
	var nearest := []
	var by_id := []
	for round in rounds:
		rays.push_back(_each(func() -> void:
			var from := _somewhere()
			scatter.query_ray(from, from + 50.0 * Vector3.FORWARD.rotated(Vector3.UP, _random.randf() * TAU), [scatter.layers[0], scatter.layers[1]])))
		nearest.push_back(_each(func() -> void: scatter.query_nearest(_somewhere(), 30.0, [scatter.layers[0], scatter.layers[1]])))
		by_id.push_back(_each(func() -> void: scatter.get_instance(ids[_random.randi() % ids.size()])))
	row("query_ray over 50 m through trees and ferns, tiles known", rays, "µs", 1)
	row("query_nearest within 30 m, trees and ferns, tiles known", nearest, "µs", 1)
	row("get_instance by id, tiles known", by_id, "µs", 1)


## Returns a random position 1 m above the ground, near enough for rays to stay within cached tiles.
func _somewhere() -> Vector3:
	var offset := 40.0 * Vector3(_random.randf_range(-1, 1), 0, _random.randf_range(-1, 1))
	return _on_ground(_center + offset) + Vector3.UP


func _on_ground(at: Vector3) -> Vector3:
	return Vector3(at.x, scatter.ground.get_height(at), at.z)


func _each(call: Callable) -> float:
	return time_of(func() -> void:
		for index in CALLS:
			call.call()) / CALLS


## Measures removals one by one, and of all ferns around a position in one call. The times include the update of the displayed
## tiles.
func _measure_removals(rounds: int) -> void:
	var single := []
	var rates := []
	var count := 0
	for round in rounds:
		var ids: PackedInt64Array = scatter.query_sphere(_center, 30.0, scatter.layers[1]).ids
		single.push_back(ids.size() * 1e6 / time_of(func() -> void:
			for id in ids:
				scatter.remove_instance(id)
			_draw()))
		_restore(ids)
		count = ids.size()
		rates.push_back(count * 1e6 / time_of(func() -> void:
			scatter.remove_in_sphere(_center, 30.0, scatter.layers[1])
			_draw()))
		_restore(ids)
	row("remove_instance, %d one by one in a frame, redraw included" % count, single, "per second", 0)
	row("remove_in_sphere, %d at once, redraw included" % count, rates, "per second", 0)


## Updates the displayed tiles, because reading a tile applies all changes to it.
func _draw() -> void:
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[1]):
		scatter.get_tile(scatter.layers[1], tile)


func _restore(ids: PackedInt64Array) -> void:
	for id in ids:
		scatter.restore_instance(id)
	_draw()


func _measure_states() -> void:
	var spread := ScatterState.new()
	while spread.get_removed_count() < MILLION:
		spread.remove(_random.randi() << 16 | _random.randi() & 0xffff) # The 48 bits of an ID that identify a cell.
	_row_bytes("state, %d removals spread over all cells of a layer" % MILLION, spread)
	var bytes := spread.to_bytes()
	var loaded_state := ScatterState.new()
	row("state, %d removals: to_bytes" % MILLION, [time_of(spread.to_bytes) / 1e3], "ms", 0)
	row("state, %d removals: from_bytes" % MILLION, [time_of(loaded_state.from_bytes.bind(bytes)) / 1e3], "ms", 0)
	var wood := ScatterState.new()
	var ids: PackedInt64Array = scatter.query_sphere(_center, 2.0 * RADIUS, scatter.layers[1]).ids
	for id in ids:
		if _random.randi() % 3 == 0:
			wood.remove(id)
	_row_bytes("state, %d removals, a third of the ferns of a wood" % wood.get_removed_count(), wood)


func _row_bytes(label: String, state: ScatterState) -> void:
	row(label + ": bytes per removal", [float(state.to_bytes().size()) / state.get_removed_count()], "", 2)
