extends "demo_scene_harness.gd"
## Tests the demo's script terrain: plants are on the surface that the formula describes, up to its edge and not beyond it. The drawn ground
## matches the formula. Checks every fourth plant.

const SCENE := "res://script_terrain.tscn"
## Viewer positions as world x and z: the rim of the sinkhole, a cape, and the open sea.
const PLACES: Array[Vector2] = [Vector2(44.0, 20.0), Vector2(-60.0, 110.0), Vector2(1600.0, 0.0)]


func test_plants_are_on_the_surface_of_the_formula() -> void:
	load_scene(SCENE)
	var count := 0
	var worst := 0.0
	var hollow := 0
	var at_the_edge := 0
	for point in PLACES:
		viewer.global_position = Vector3(point.x, 30.0, point.y)
		await settle(scatter)
		for index in scatter.layers.size():
			var offset: float = scatter.layers[index].height_offset
			for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[index]):
				for transform in transforms(scatter, index, tile):
					var at := transform.origin
					count += 1
					if count % 4 != 0:
						continue
					var height := terrain.get_height(at)
					if is_nan(height):
						hollow += 1
						continue
					worst = maxf(worst, absf(at.y - offset - height))
					at_the_edge += int(is_nan(terrain.get_height(at + Vector3(1.0, 0.0, 0.0))))
	check(count > 100000, "%d plants were found" % count)
	check(hollow == 0, "%d plants where there is no ground" % hollow)
	# Buffers store positions as floats. On a slope, that rounding causes a difference in height.
	check(worst < 0.01, "a plant is %f m off the ground" % worst)
	check(at_the_edge > 30, "only %d of the plants are within a meter of the edge" % at_the_edge)


func test_the_drawn_ground_is_the_same() -> void:
	load_scene(SCENE)
	await frames(3)
	var drawn := scene.get_node("Ground") as MeshInstance3D
	check_equal(drawn.mesh.get_surface_count(), 2, "surfaces: ground and walls")
	var faces := PackedVector3Array()
	var arrays := drawn.mesh.surface_get_arrays(0)
	for index: int in arrays[Mesh.ARRAY_INDEX]:
		faces.append(arrays[Mesh.ARRAY_VERTEX][index])
	var worst := 0.0
	var area := 0.0
	for first in range(0, faces.size(), 3):
		var a := faces[first]
		var b := faces[first + 1]
		var c := faces[first + 2]
		var middle := (a + b + c) / 3.0
		worst = maxf(worst, absf(middle.y - terrain.get_height(middle)))
		area += 0.5 * Vector2(b.x - a.x, b.z - a.z).cross(Vector2(c.x - a.x, c.z - a.z))
	check(worst < 0.05, "drawn %f m off the ground" % worst)
	# Estimates the ground's area from random positions.
	var rng := RandomNumberGenerator.new()
	rng.seed = 3
	var hits := 0
	for i in 5000:
		hits += int(is_finite(terrain.get_height(Vector3(rng.randf_range(-210, 210), 0.0, rng.randf_range(-210, 210)))))
	var expected := hits / 5000.0 * 420.0 * 420.0
	check(absf(area / expected - 1.0) < 0.05, "%.0f m² drawn, %.0f m² of ground" % [area, expected])


func test_a_changed_setting_changes_the_ground() -> void:
	load_scene(SCENE)
	await frames(3)
	var before := (scene.get_node("Ground") as MeshInstance3D).mesh
	check(is_nan(terrain.get_height(Vector3(200.0, 0.0, 0.0))), "sea at first")
	terrain.set(&"coast", 250.0)
	await frames(3)
	check(is_finite(terrain.get_height(Vector3(200.0, 0.0, 0.0))), "land when the coast is farther out")
	check((scene.get_node("Ground") as MeshInstance3D).mesh != before, "the ground is redrawn")
