extends SceneTree
## Base class for the engine tests: `godot --headless --path PROJECT --script tests/engine/test_X.gd`.
##
## Runs every method whose name starts with "test_", each in an empty tree; with `-- test_NAME`, only this method. A failed check
## prints a line that starts with "FAILED". Errors and warnings that the test does not expect are also failures. The last line is
## "thicket engine tests: N checks, 0 failed". The exit code is 0 only if no check failed.

## Collects the errors and warnings that the engine prints on any thread.
class ErrorLog extends Logger:
	var _mutex := Mutex.new()
	var _messages: PackedStringArray

	func _log_error(_function: String, _file: String, _line: int, code: String, rationale: String, _editor_notify: bool,
			_error_type: int, _script_backtraces: Array[ScriptBacktrace]) -> void:
		_mutex.lock()
		_messages.push_back(rationale if rationale else code)
		_mutex.unlock()

	## Returns the messages printed since the last call.
	func take() -> PackedStringArray:
		_mutex.lock()
		var taken := _messages
		_messages = PackedStringArray()
		_mutex.unlock()
		return taken


const IDLE_TIMEOUT_MSEC := 180000  # A build that counts lines is slow.

var errors := ErrorLog.new()
var checks := 0
var failures := 0
var current := ""
var arguments := OS.get_cmdline_user_args()


func _initialize() -> void:
	OS.add_logger(errors)
	_run.call_deferred()


func _run() -> void:
	var only := arguments[0] if arguments.size() > 0 and arguments[0].begins_with("test_") else ""
	for method: Dictionary in (get_script() as Script).get_script_method_list():
		var method_name: String = method["name"]
		if not method_name.begins_with("test_") or (only and only != method_name):
			continue
		current = method_name
		var checks_before := checks
		@warning_ignore("redundant_await")
		await call(method_name)
		for message in errors.take():
			check(false, "the engine printed: " + message)
		if checks == checks_before:
			check(false, "the test made no check")
		await clean()
	print("thicket engine tests: %d checks, %d failed" % [checks, failures])
	OS.remove_logger(errors)
	quit(0 if failures == 0 else 1)


## Returns whether the engine refused to free a node during a call. Both of its messages for this case contain "locked". Any other message
## is a failure.
func was_kept_from_being_freed() -> bool:
	var messages := errors.take()
	for message in messages:
		check("locked" in message, "the engine printed: " + message)
	return not messages.is_empty()


## Frees the nodes that a test left in the tree.
func clean() -> void:
	for child in root.get_children():
		child.queue_free()
	await frames(2)


func check(condition: bool, message: String) -> bool:
	checks += 1
	if not condition:
		failures += 1
		print("FAILED %s: %s" % [current, message])
	return condition


func check_equal(got: Variant, expected: Variant, message: String) -> bool:
	var equal: bool = typeof(got) == typeof(expected) and got == expected
	return check(equal, "%s: got %s, expected %s" % [message, got, expected])


## Checks that the engine printed exactly one message since the last check, and that it contains all of these words.
func check_error(words: Array, context: String) -> void:
	var messages := errors.take()
	if not check(messages.size() == 1, "%s: expected one error, got %s" % [context, messages]):
		return
	for word: Variant in words:
		check(str(word) in messages[0], "%s: expected '%s' in '%s'" % [context, word, messages[0]])


func check_no_error(context: String) -> void:
	var messages := errors.take()
	check(messages.is_empty(), "%s: expected no error, got %s" % [context, messages])


func frames(count: int) -> void:
	for index in count:
		await process_frame


## Waits until `condition` returns true. After IDLE_TIMEOUT_MSEC, records a failure and returns false.
func until(condition: Callable, message: String) -> bool:
	var deadline := Time.get_ticks_msec() + IDLE_TIMEOUT_MSEC
	while not condition.call():
		if Time.get_ticks_msec() > deadline:
			return check(false, "not within %d ms: %s" % [IDLE_TIMEOUT_MSEC, message])
		await process_frame
	return check(true, message)


## Waits until a scatter has settled. After IDLE_TIMEOUT_MSEC, records a failure and returns false.
func settle(scatter: TerrainScatter3D) -> bool:
	var deadline := Time.get_ticks_msec() + IDLE_TIMEOUT_MSEC
	await frames(2)
	while not scatter.is_settled():
		if Time.get_ticks_msec() > deadline:
			return check(false, "still not settled after %d ms: %s" % [IDLE_TIMEOUT_MSEC, scatter.get_stats()])
		await process_frame
	return true


## Adds a node to the tree that `make_scatter` can use as a viewer.
func make_viewer(at := Vector3.ZERO) -> Node3D:
	var viewer := Node3D.new()
	root.add_child(viewer)
	viewer.global_position = at
	return viewer


func make_layer(radius := 2.0) -> ScatterLayer:
	var layer := ScatterLayer.new()
	layer.radius = radius
	layer.tile_size = 32.0
	layer.view_distance = 64.0
	layer.meshes = [BoxMesh.new()]
	return layer


## Returns the entries of a layer's meshes with coarser LODs added. `rows[i]` contains one mesh per entry for `distances[i]`, in meters.
## An entry with null in a row gets no LOD at that distance.
func with_lods(meshes: Array, rows: Array, distances: Array) -> Array:
	var models := []
	for entry in meshes.size():
		var lods: Array[ScatterLod] = []
		for row in rows.size():
			if rows[row][entry] != null:
				lods.append(make_lod(rows[row][entry], distances[row]))
		models.append(with_far_lods(meshes[entry], lods))
	return models


func with_far_lods(entry: Resource, lods: Array[ScatterLod]) -> Resource:
	if lods.is_empty():
		return entry
	var model := ScatterModel.new()
	if entry is Mesh:
		lods.push_front(make_lod(entry as Mesh, 0.0))
		model.lods = lods
		return model
	if entry is ScatterModel:
		model = entry.duplicate()
	else:
		model.scene = entry
	model.far_lods = lods
	return model


func make_lod(mesh: Mesh, distance: float) -> ScatterLod:
	var lod := ScatterLod.new()
	lod.mesh = mesh
	lod.distance = distance
	return lod


## Returns the mesh that is drawn for an LOD of one of the layer's meshes. LOD 0 is the finest.
func lod_mesh(layer: ScatterLayer, entry: int, lod: int) -> Mesh:
	return layer.get_mesh_lods(entry)[lod].mesh


## Returns a scene in which one node has an instance shader parameter, as the editor saves it. Inserts the parameter into the file, because
## a headless engine does not save it.
func with_shader_parameter(scene: PackedScene, node: String, value: String) -> PackedScene:
	ResourceSaver.save(scene, "user://with_parameter.tscn")
	var text := FileAccess.get_file_as_string("user://with_parameter.tscn")
	var at := text.find("\n", text.find('[node name="%s"' % node)) + 1
	var file := FileAccess.open("user://with_parameter.tscn", FileAccess.WRITE)
	file.store_string(text.insert(at, "instance_shader_parameters/%s\n" % value))
	file.close()
	return ResourceLoader.load("user://with_parameter.tscn", "", ResourceLoader.CACHE_MODE_IGNORE)


## Returns a curve that is a straight line between two points. Their x coordinates limit its domain.
func make_line(from: Vector2, to: Vector2) -> Curve:
	var curve := Curve.new()
	curve.min_domain = from.x
	curve.max_domain = to.x
	curve.add_point(from, 0.0, (to.y - from.y) / (to.x - from.x))
	curve.add_point(to, (to.y - from.y) / (to.x - from.x), 0.0)
	return curve


## Adds a scatter to the tree and returns it without waiting until it settles.
func make_scatter(layers: Array[ScatterLayer], terrain: ScatterGround, viewer: Node3D) -> TerrainScatter3D:
	var scatter := TerrainScatter3D.new()
	scatter.seed = 7
	scatter.layers = layers
	scatter.ground = terrain
	scatter.frame_budget_usec = 20000
	root.add_child(scatter)
	scatter.viewers = [scatter.get_path_to(viewer)]
	return scatter


## Returns a tile's buffers, one per mesh.
func buffers_of(tile: ScatterTile) -> Array:
	return range(tile.get_mesh_count()).map(tile.get_buffer)


## Returns a tile's instance IDs, one array per mesh.
func ids_of(tile: ScatterTile) -> Array:
	return range(tile.get_mesh_count()).map(tile.get_ids)


## Returns the layer at an index. Any other reference to a layer is returned unchanged.
func layer_of(scatter: TerrainScatter3D, layer: Variant) -> Variant:
	return scatter.layers[layer] if layer is int else layer


func tile_buffers(scatter: TerrainScatter3D, layer: Variant, tile: Vector2i) -> Array:
	return buffers_of(scatter.get_tile(layer_of(scatter, layer), tile))


func tile_ids(scatter: TerrainScatter3D, layer: Variant, tile: Vector2i) -> Array:
	return ids_of(scatter.get_tile(layer_of(scatter, layer), tile))


func tile_multimeshes(scatter: TerrainScatter3D, layer: Variant, tile: Vector2i) -> Array:
	var displayed_tile := scatter.get_tile(layer_of(scatter, layer), tile)
	return range(displayed_tile.get_mesh_count()).map(displayed_tile.get_multimesh)


## Returns a query's result as an array that compares by value.
func content_of(found: ScatterInstances) -> Array:
	var layer_ids := found.layers.map(func(layer: ScatterLayer) -> int: return layer.layer_id)
	return [found.ids, layer_ids, found.layer_indices, found.meshes, found.positions, found.transforms]


## Returns the visible tiles of the layer at an index, or an empty array if there is no such layer.
func shown_tiles(scatter: TerrainScatter3D, layer: int) -> Array[Vector2i]:
	var found := scatter.layers[layer] if layer < scatter.layers.size() else null
	return scatter.get_shown_tiles(found) if found != null else ([] as Array[Vector2i])


## Returns {tile: digest} for a layer's visible tiles. Checks that a tile has instances, because two empty results are always equal.
func digests(scatter: TerrainScatter3D, layer: int) -> Dictionary:
	var result := {}
	for tile in shown_tiles(scatter, layer):
		result[tile] = scatter.get_tile(scatter.layers[layer], tile).get_digest()
	check(result.values().any(func(digest: int) -> bool: return digest != 0), "layer %d has visible instances to compare" % layer)
	return result


## Returns the number of floats per instance in a buffer of this layer.
func floats_of(layer: ScatterLayer) -> int:
	return 12 + 4 * int(layer.use_colors) + 4 * int(layer.use_custom_data)


## Returns the world transforms of a tile's instances, read from the RenderingServer, one mesh after the other.
func transforms(scatter: TerrainScatter3D, layer: int, tile: Vector2i) -> Array[Transform3D]:
	var result: Array[Transform3D] = []
	var origin := scatter.get_tile(scatter.layers[layer], tile).get_origin()
	var floats := floats_of(scatter.layers[layer])
	for buffer: PackedFloat32Array in tile_buffers(scatter, layer, tile):
		for at in range(0, buffer.size(), floats):
			result.push_back(Transform3D(
					Vector3(buffer[at], buffer[at + 4], buffer[at + 8]),
					Vector3(buffer[at + 1], buffer[at + 5], buffer[at + 9]),
					Vector3(buffer[at + 2], buffer[at + 6], buffer[at + 10]),
					origin + Vector3(buffer[at + 3], buffer[at + 7], buffer[at + 11])))
	return result


## Returns {ID: world transform} for all visible instances of a layer, read from the RenderingServer.
func instances(scatter: TerrainScatter3D, layer: int) -> Dictionary[int, Transform3D]:
	var result: Dictionary[int, Transform3D] = {}
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
		var ids := PackedInt64Array()
		for part: PackedInt64Array in tile_ids(scatter, layer, tile):
			ids.append_array(part)
		var standing := transforms(scatter, layer, tile)
		check(ids.size() == standing.size(), "one ID for each transform")
		for index in ids.size():
			result[ids[index]] = standing[index]
	check(result.size() == _sum_of_ids(scatter, layer), "no id occurs twice")
	return result


func _sum_of_ids(scatter: TerrainScatter3D, layer: int) -> int:
	var sum := 0
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
		for part: PackedInt64Array in tile_ids(scatter, layer, tile):
			sum += part.size()
	return sum


## Returns an instance's position on the map: its world x and z.
func on_map(at: Transform3D) -> Vector2:
	return Vector2(at.origin.x, at.origin.z)


## Returns the map positions of instances that exist in only one of the two states, or that differ. Positions are compared with a tolerance,
## because rounding depends on the height of a tile's origin.
func changed_places(before: Dictionary[int, Transform3D], after: Dictionary[int, Transform3D]) -> PackedVector2Array:
	var points: PackedVector2Array
	for id in before:
		var moved := not after.has(id) or after[id].origin.distance_to(before[id].origin) > 1e-5
		if moved or after[id].basis != before[id].basis:
			points.push_back(on_map(before[id]))
	for id in after:
		if not before.has(id):
			points.push_back(on_map(after[id]))
	return points
