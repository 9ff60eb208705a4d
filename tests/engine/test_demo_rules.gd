extends "demo_scene_harness.gd"
## Tests the demo's rule scene: ferns grow only under oaks, and trees keep their distance. The path is bare, and stones are on steep ground.
## Only reeds grow in the lake, at its shore. Moving the clearing changes only instances near it.

const SCENE := "res://rules.tscn"
## Viewer positions as world x and z: the edge of the western wood, the lake's eastern shore by the path, and the scree.
const PLACES: Array[Vector2] = [Vector2(-125.0, 30.0), Vector2(62.0, 5.0), Vector2(140.0, 60.0)]
## The tolerance in meters for positions that were rounded to floats in a buffer.
const ROUNDING := 0.002

## The instances that were found, as {layer name: {ID: position as a Vector3}}.
var standing := {}


## Moves the viewer to a position (world x and z), and adds the instances around it to `standing`.
func add_instances_around(point: Vector2) -> void:
	viewer.global_position = Vector3(point.x, 10.0, point.y)
	await settle(scatter)
	for index in scatter.layers.size():
		var known: Dictionary = standing.get_or_add(scatter.layers[index].resource_name, {})
		for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[index]):
			var ids: Array[int] = []
			for mesh_ids: PackedInt64Array in tile_ids(scatter, index, tile):
				ids.append_array(mesh_ids)
			var placed := transforms(scatter, index, tile)
			for i in ids.size():
				known[ids[i]] = placed[i].origin


func flat(point: Vector3) -> Vector2:
	return Vector2(point.x, point.z)


## Returns the distance on the map from each instance of layer `of` to the nearest one of layer `to`, or INF if it exceeds `reach`.
func nearest(of: String, to: String, reach: float) -> PackedFloat64Array:
	var cells := {}
	for point: Vector3 in standing[to].values():
		cells.get_or_add(Vector2i((flat(point) / reach).floor()), PackedVector2Array()).append(flat(point))
	var result := PackedFloat64Array()
	for point: Vector3 in standing[of].values():
		var at := flat(point)
		var best := INF
		var cell := Vector2i((at / reach).floor())
		for dx in [-1, 0, 1]:
			for dy in [-1, 0, 1]:
				for other: Vector2 in cells.get(cell + Vector2i(dx, dy), PackedVector2Array()):
					best = minf(best, at.distance_to(other))
		result.append(best if best <= reach else INF)
	return result


func test_each_layer_keeps_its_rules() -> void:
	load_scene(SCENE)
	standing = {}
	await frames(1) # The plant meshes are built in the first frame.
	check_equal(scatter.get_problems(), PackedStringArray(), "warnings of the scene")
	for point in PLACES:
		await add_instances_around(point)
	for layer: String in standing:
		check(standing[layer].size() > 200, "%d instances of %s" % [standing[layer].size(), layer])
	check_neighbors()
	check_path()
	check_heights_and_slopes()


func check_neighbors() -> void:
	var to_oaks := nearest("Fern", "Oak", 8.0)
	check(not to_oaks.has(INF), "ferns in the open: %d of %d" % [to_oaks.count(INF), to_oaks.size()])
	var spruces := nearest("Spruce", "Oak", 5.5 - ROUNDING)
	check(spruces.count(INF) == spruces.size(), "%d spruces are too close to an oak" % (spruces.size() - spruces.count(INF)))
	var scree := nearest("Scree", "Boulders", 1.4 - ROUNDING)
	check(scree.count(INF) == scree.size(), "%d stones are too close to a boulder" % (scree.size() - scree.count(INF)))


func check_path() -> void:
	var path := scene.get_node("Scatter/Path") as Path3D
	var polyline := path.curve.get_baked_points()
	var on_path := 0
	var beside := 0
	for layer: String in standing:
		for point: Vector3 in standing[layer].values():
			# This position is too far from the path to matter.
			if point.x < -20.0 or point.x > 115.0:
				continue
			var closest := path.curve.get_closest_point(path.to_local(Vector3(point.x, 0.0, point.z)))
			# Search again at the curve's height there, because the distance on the map is used, not the distance in space.
			closest = path.curve.get_closest_point(Vector3(point.x, closest.y, point.z))
			var away := flat(closest).distance_to(flat(point))
			on_path += int(away < 0.9)
			beside += int(away > 1.7 and away < 4.0)
	check(polyline.size() > 100, "a long path")
	check(on_path == 0, "%d instances on the path" % on_path)
	check(beside > 200, "%d instances next to the path" % beside)


func check_heights_and_slopes() -> void:
	var deepest := {}
	for layer: String in standing:
		for point: Vector3 in standing[layer].values():
			deepest[layer] = minf(deepest.get(layer, INF), terrain.get_height(point))
	for layer: String in deepest:
		var limit := -0.4 if layer == "Reeds" else 0.0
		check(deepest[layer] >= limit - ROUNDING, "%s at %f m in the lake" % [layer, deepest[layer]])
	check(deepest["Reeds"] < -0.2, "reeds in shallow water")
	var gentlest := 90.0
	for point: Vector3 in standing["Scree"].values():
		gentlest = minf(gentlest, rad_to_deg(acos(terrain.get_normal(point).y)))
	check(gentlest > 21.9, "scree on ground of %f degrees" % gentlest)


func test_a_moving_clearing_has_no_other_effect() -> void:
	load_scene(SCENE)
	standing = {}
	var clearing := scene.get_node("Scatter/Clearing") as Node3D
	var point := flat(clearing.global_position)
	await add_instances_around(point + Vector2(0.0, 30.0))
	var before := standing.duplicate()
	var trees: Array = before["Oak"].values() + before["Spruce"].values()
	check(not trees.any(func(at: Vector3) -> bool: return flat(at).distance_to(point) < 24.0), "trees in the clearing")
	clearing.global_position += Vector3(40.0, 0.0, 0.0)
	standing = {}
	await add_instances_around(point + Vector2(0.0, 30.0))
	var changed := 0
	var strays := 0
	# A fern requires an oak within 9 m. Undergrowth in turn depends on ferns slightly farther away.
	var reach := 30.0 + 9.5
	for layer: String in before:
		for id: int in before[layer].keys() + standing[layer].keys():
			if before[layer].get(id) == standing[layer].get(id):
				continue
			changed += 1
			var at := flat(before[layer].get(id, standing[layer].get(id)))
			var near := minf(at.distance_to(point), at.distance_to(point + Vector2(40.0, 0.0)))
			strays += int(near > reach or (before[layer].has(id) and standing[layer].has(id)))
	check(changed > 100, "%d instances appeared or disappeared" % changed)
	check(strays == 0, "%d instances moved, or changed far from the clearing" % strays)
	clearing.global_position -= Vector3(40.0, 0.0, 0.0)
	standing = {}
	await add_instances_around(point + Vector2(0.0, 30.0))
	check(standing == before, "the same forest when the clearing is back")


func press(key: Key) -> void:
	var event := InputEventKey.new()
	event.keycode = key
	event.pressed = true
	root.push_input(event)


func test_a_key_starts_and_stops_the_clearing() -> void:
	scene = (load(SCENE) as PackedScene).instantiate()
	root.add_child(scene)
	var clearing := scene.get_node("Scatter/Clearing") as Node3D
	await frames(3)
	var start := clearing.global_position
	press(KEY_M)
	await create_timer(0.4).timeout
	check(clearing.global_position != start, "M: the clearing moves")
	press(KEY_M)
	await frames(2)
	var rest := clearing.global_position
	await frames(10)
	check_equal(clearing.global_position, rest, "M again: the clearing stops")


func test_the_drawn_path_matches_the_curve() -> void:
	load_scene(SCENE)
	await frames(3)
	var drawn := scene.get_node("Ground") as MeshInstance3D
	var before := drawn.mesh
	var path := scene.get_node("Scatter/Path") as Path3D
	path.curve.set_point_position(3, path.curve.get_point_position(3) + Vector3(12.0, 0.0, 0.0))
	await until(func() -> bool: return drawn.mesh != before, "the path is redrawn")
	var arrays := drawn.mesh.surface_get_arrays(0)
	var there := path.curve.get_point_position(3)
	var nearest := INF
	var distance := INF
	for index in arrays[Mesh.ARRAY_VERTEX].size():
		var away := flat(arrays[Mesh.ARRAY_VERTEX][index]).distance_to(flat(there))
		if away < nearest:
			nearest = away
			distance = arrays[Mesh.ARRAY_TEX_UV][index].x
	check(distance < 1.5, "the vertex at the moved bend is %f m from the path" % distance)
