extends "demo_scene_harness.gd"
## Tests the demo's surfaces scene. Plants grow below the bridge as well as on it, stalactites on the cave's ceiling, mushrooms on its
## floor, and ivy on the walls of the ruin. Nothing is placed in midair or inside the rock.

const SCENE := "res://surfaces.tscn"
const Shape := preload("res://terrain/gorge_shape.gd")


## Returns the positions of a layer's visible instances within a box.
func positions(layer: String, box: AABB) -> PackedVector3Array:
	var found := PackedVector3Array()
	for index in scatter.layers.size():
		if scatter.layers[index].resource_name != layer:
			continue
		for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[index]):
			for transform in transforms(scatter, index, tile):
				if box.has_point(transform.origin):
					found.append(transform.origin)
	return found


func keep_layers(names: PackedStringArray) -> void:
	var kept: Array[ScatterLayer] = []
	for layer in scatter.layers:
		if layer.resource_name in names:
			kept.append(layer)
	check_equal(kept.size(), names.size(), "the scene has the layers %s" % names)
	scatter.layers = kept


func test_plants_grow_on_the_bridge_and_below_it() -> void:
	load_scene(SCENE)
	keep_layers(["Grass", "Ferns", "Hanging Ivy"])
	viewer.global_position = Vector3(0.0, 8.0, 0.0)
	await settle(scatter)
	var span := AABB(Vector3(-7.0, 0.0, -2.4), Vector3(14.0, 20.0, 4.8))
	var grass := positions("Grass", span)
	var above := 0
	for at in grass:
		above += int(at.y > 12.5)
	check(above > 50, "%d tufts of grass are on the bridge" % above)
	check(grass.size() - above > 20, "%d tufts of grass are below the bridge" % (grass.size() - above))
	check(not positions("Ferns", span).is_empty(), "ferns are at the bridge")
	var hanging := 0
	for at in positions("Hanging Ivy", span):
		var arch := 5.0 + 7.2 * sqrt(maxf(1.0 - (at.x / 8.4) ** 2, 0.0))
		hanging += int(absf(at.y - arch) < 0.5)
	check(hanging > 5, "%d shoots of ivy hang from the arch" % hanging)


func test_the_cave_has_a_floor_and_a_ceiling() -> void:
	load_scene(SCENE)
	keep_layers(["Mushrooms", "Stalactites", "Grass"])
	viewer.global_position = Vector3(30.0, 4.0, 8.0)
	await settle(scatter)
	var tunnel := AABB(Vector3(24.0, 0.0, -10.0), Vector3(14.0, 11.0, 22.0))
	var mushrooms := positions("Mushrooms", tunnel)
	var stalactites := positions("Stalactites", tunnel)
	check(mushrooms.size() > 40, "%d mushrooms are in the cave" % mushrooms.size())
	check(stalactites.size() > 20, "%d stalactites are in the cave" % stalactites.size())
	var shape := Shape.new()
	var worst := 0.0
	for at in mushrooms:
		check(at.y < 5.0, "a mushroom is on the floor: %s" % at)
		worst = maxf(worst, absf(shape.air(at)))
	for at in stalactites:
		check(at.y > 4.5, "a group of stalactites is on the ceiling: %s" % at)
		worst = maxf(worst, absf(shape.air(at)))
	check(worst < 0.8, "an instance is %.2f m away from the rock" % worst)
	check_equal(positions("Grass", AABB(Vector3(29.0, 0.0, -8.0), Vector3(6.0, 9.0, 16.0))), PackedVector3Array(), "no grass grows in the dark")
	check(not positions("Grass", AABB(Vector3(29.0, 9.0, -8.0), Vector3(6.0, 12.0, 16.0))).is_empty(), "grass grows above the cave")


func test_ivy_grows_on_the_walls_of_the_ruin() -> void:
	load_scene(SCENE)
	keep_layers(["Ivy"])
	viewer.global_position = Vector3(-26.0, 16.0, -8.0)
	await settle(scatter)
	var outside := 0
	var inside := 0
	for at in positions("Ivy", AABB(Vector3(-32.5, 14.5, -17.5), Vector3(13.7, 9.0, 9.9))):
		var local := at - Vector3(-32.0, 13.5, -17.0)
		var is_outer := local.x < 0.3 or local.x > 12.3 or local.z < 0.3 or local.z > 8.5
		outside += int(is_outer)
		inside += int(not is_outer)
	check(outside > 30, "%d mats of ivy are on the outer sides" % outside)
	check(inside > 10, "%d mats of ivy are on the inner sides" % inside)


func test_trees_grow_on_all_sides_of_the_planet() -> void:
	load_scene(SCENE)
	scatter = scene.get_node("PlanetScatter")
	scatter.viewers = [scatter.get_path_to(viewer)]
	viewer.global_position = Vector3(0.0, 400.0, 560.0)
	await settle(scatter)
	var center := Vector3(0.0, 400.0, 420.0)
	var octants := {}
	var standing := instances(scatter, 0)
	for id in standing:
		var from := standing[id].origin - center
		octants[from.sign()] = octants.get(from.sign(), 0) + 1
		if not check(absf(from.length() - 59.7) < 0.2 and standing[id].basis.y.angle_to(from) < 0.001, "an oak is upright on the planet"):
			break
	check(octants.size() == 8 and octants.values().min() > 10, "oaks are on all sides: %s" % octants)


func test_moss_and_mushrooms_grow_on_logs() -> void:
	load_scene(SCENE)
	keep_layers(["Boulders", "Logs", "Moss on Logs", "Mushrooms on Logs"])
	viewer.global_position = Vector3(4.9, 2.5, -14.2)
	await settle(scatter)
	var gorge := AABB(Vector3(-30.0, -1.0, -40.0), Vector3(60.0, 13.0, 60.0))
	var hosts := positions("Logs", gorge)
	check(hosts.size() > 2, "%d logs" % hosts.size())
	hosts.append_array(positions("Boulders", gorge))
	for layer: String in ["Moss on Logs", "Mushrooms on Logs"]:
		var found := positions(layer, gorge)
		check(found.size() > 10, "%s: %d" % [layer, found.size()])
		for at in found:
			if not check(Array(hosts).any(func(host: Vector3) -> bool: return host.distance_to(at) < 2.5), "%s is at %s" % [layer, at]):
				break
