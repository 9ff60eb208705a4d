extends "terrain_harness.gd"
## Tests ground from noise, scripts with textures, meshes and colliders. Heights and holes are correct, and all ways to query the ground
## agree.

## Sloping ground with one texture for negative and one for positive x, and some invalid weights.
class Textured extends ScatterGround:
	var extra := 0

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(0.1 * at.x)
		return heights

	func _get_weights(positions: PackedVector2Array, textures: PackedInt32Array) -> PackedFloat32Array:
		var weights := PackedFloat32Array()
		for at in positions:
			weights.push_back(NAN if at.y > 40.0 else 5.0 if (0 if at.x < 0.0 else 1) in textures else -1.0)
		weights.resize(weights.size() + extra)
		return weights


class ThreadedTextured extends Textured:
	func _is_thread_safe() -> bool:
		return true


func make_hills() -> ScatterGroundNoise:
	var terrain := ScatterGroundNoise.new()
	var noise := FastNoiseLite.new()
	noise.seed = 5
	noise.frequency = 0.02
	noise.fractal_octaves = 4
	terrain.noise = noise
	terrain.amplitude = 25.0
	terrain.base_height = 100.0
	return terrain


func test_noise_heights_and_normals() -> void:
	var terrain := make_hills()
	var noise := terrain.noise
	for at: Vector3 in [Vector3.ZERO, Vector3(12.5, 9.0, -70.25), Vector3(-1e5, 0.0, 3.0)]:
		var height := func(x: float, z: float) -> float: return 100.0 + 25.0 * noise.get_noise_2d(x, z)
		check(absf(terrain.get_height(at) - height.call(at.x, at.z)) < 1e-4, "height at %s" % at)
		var x: float = height.call(at.x + 0.5, at.z) - height.call(at.x - 0.5, at.z)
		var z: float = height.call(at.x, at.z + 0.5) - height.call(at.x, at.z - 0.5)
		check(terrain.get_normal(at).distance_to(Vector3(-x, 1.0, -z).normalized()) < 1e-3, "normal at %s" % at)
	check(is_nan(terrain.get_height(Vector3(INF, 0.0, 0.0))), "no ground at infinity")
	check(is_finite(terrain.get_height(Vector3(3e9, 0.0, -3e9))), "ground far away")
	check(terrain.get_normal(Vector3(3e9, 0.0, -3e9)).y > 0.0, "a normal far away")


func test_noise_as_ground() -> void:
	var terrain := make_hills()
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	var stand := all_transforms(scatter)
	check(stand.size() > 1000, "instances: %d" % stand.size())
	var wrong := 0
	for one in stand:
		wrong += int(absf(one.origin.y - terrain.get_height(one.origin)) > 0.01)
	check_equal(wrong, 0, "instances off the ground")
	var before := digests(scatter, 0)
	(terrain.noise as FastNoiseLite).frequency = 0.05
	await settle(scatter)
	check(digests(scatter, 0) != before, "an edited Noise resource has an effect")
	(terrain.noise as FastNoiseLite).frequency = 0.02
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "the old noise restores the old instances")
	terrain.amplitude = 30.0
	terrain.base_height = -5.0
	await settle(scatter)
	check(digests(scatter, 0) != before, "an edited height has an effect")
	var old: Noise = terrain.noise
	terrain.noise = null
	await settle(scatter)
	check_equal(scatter.get_stats()["tiles"], 0, "tiles without noise")
	check("ScatterGroundNoise.noise" in "\n".join(scatter.get_problems()), "a warning without noise")
	terrain.noise = old
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "no problems with noise")
	check(scatter.get_stats()["tiles"] > 0, "tiles with noise again")


func test_noise_does_not_depend_on_tiles() -> void:
	await check_tiling(make_hills(), "noise")


func test_noise_rejects_invalid_values() -> void:
	var terrain := make_hills()
	for property: String in ["amplitude", "base_height"]:
		for value: float in [NAN, INF, 1e9, -2e6]:
			var good: float = terrain.get(property)
			terrain.set(property, value)
			check_error(["ScatterGroundNoise." + property], "%s = %s" % [property, value])
			check_equal(terrain.get(property), good, property)
	terrain.amplitude = -1.0
	check_error(["ScatterGroundNoise.amplitude", "-1"], "a negative amplitude")


func test_weights_of_scripts() -> void:
	var found: Array[Dictionary] = []
	for terrain: Textured in [Textured.new(), ThreadedTextured.new()]:
		var layer := make_layer()
		layer.ground_textures = PackedInt32Array([1, 7])
		var scatter := make_scatter([layer], terrain, make_viewer())
		await settle(scatter)
		var stand := all_transforms(scatter)
		check(stand.size() > 300, "instances: %d" % stand.size())
		check(stand.all(func(one: Transform3D) -> bool: return one.origin.x >= 0.0 and one.origin.z <= 40.0),
				"all instances are on their texture")
		found.push_back(digests(scatter, 0))
		layer.ground_textures = PackedInt32Array()
		await settle(scatter)
		check(all_transforms(scatter).size() > 2 * stand.size(), "without ground_textures, all ground is permitted")
		var before := digests(scatter, 0)
		layer.ground_textures = PackedInt32Array([0])
		terrain.extra = 3
		await settle(scatter)
		check_error(["_get_weights()", "wrong size"], "three weights too many")
		check_equal(digests(scatter, 0), before, "the instances do not change")
	check_equal(found[0], found[1], "the instances are the same on the main thread and on workers")


## Adds a node to the tree with a global transform.
func put(node: Node3D, at: Transform3D) -> void:
	root.add_child(node)
	node.global_transform = at


func test_grounds_without_textures() -> void:
	var layer := make_layer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	var image := Image.create_empty(4, 4, false, Image.FORMAT_RF)
	var plain_map := ScatterGroundHeightmap.new()
	plain_map.image = image
	var weighed_map := plain_map.duplicate() as ScatterGroundHeightmap
	weighed_map.weight_image = image
	var warns := func(terrain: ScatterGround) -> bool:
		scatter.ground = terrain
		return "ScatterLayer.ground_textures has no effect" in "\n".join(scatter.get_problems())
	for terrain: ScatterGround in [ScatterGroundFlat.new(), make_hills(), plain_map, Textured.new(), weighed_map]:
		layer.ground_textures = PackedInt32Array()
		check(not warns.call(terrain), "no warning for %s without textures in the layer" % terrain)
		layer.ground_textures = PackedInt32Array([0])
		check_equal(warns.call(terrain), not (terrain is Textured or terrain == weighed_map), "a warning for %s" % terrain)
	check(not warns.call(null), "without a ground, this warning is not shown")


func make_collider(shape: Shape3D, at: Transform3D, layers := 1) -> void:
	var body := StaticBody3D.new()
	body.collision_layer = layers
	var collision := CollisionShape3D.new()
	collision.shape = shape
	body.add_child(collision)
	put(body, at)


## Adds an 80 m floor with its top at height 2 and a gap from x = 10 to 20. Above it are a 30 degree ramp, at negative x, and a roof.
func make_colliders() -> void:
	for part: Array in [[-40.0, 10.0], [20.0, 40.0]]:
		var floor_box := BoxShape3D.new()
		floor_box.size = Vector3(part[1] - part[0], 4.0, 80.0)
		make_collider(floor_box, Transform3D(Basis(), Vector3(0.5 * (part[0] + part[1]), 0.0, 0.0)))
	var ramp := BoxShape3D.new()
	ramp.size = Vector3(20.0, 1.0, 20.0)
	make_collider(ramp, Transform3D(Basis(Vector3.BACK, deg_to_rad(30.0)), Vector3(-20.0, 15.0, 0.0)))
	var roof := BoxShape3D.new()
	roof.size = Vector3(200.0, 1.0, 200.0)
	make_collider(roof, Transform3D(Basis(), Vector3(0.0, 80.0, 0.0)), 2)


func test_colliders() -> void:
	make_colliders()
	var terrain := ScatterGroundColliders.new()
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	var stand := all_transforms(scatter)
	check(stand.size() > 500, "instances: %d" % stand.size())
	var wrong := 0
	var on_ramp := 0
	for one in stand:
		var at := one.origin
		if absf(at.y - 2.0) > 0.001:
			on_ramp += 1
			wrong += int(absf(at.x + 20.0) > 10.0 or absf(at.z) > 10.01 or at.y < 9.0)
		wrong += int((at.x > 10.001 and at.x < 19.999) or absf(at.x) > 40.001 or absf(at.z) > 40.001)
	check_equal(wrong, 0, "instances in the gap, outside of the floor or in the air")
	check(on_ramp > 20, "instances on the ramp: %d" % on_ramp)
	check(is_nan(terrain.get_height(Vector3(15.0, 0.0, 0.0))), "no ground in the gap")
	check(absf(terrain.get_height(Vector3(5.0, 0.0, 0.0)) - 2.0) < 0.001, "the height of the floor")
	var slope := terrain.get_normal(Vector3(-20.0, 0.0, 0.0))
	check(slope.distance_to(Vector3(-0.5, sqrt(0.75), 0.0)) < 0.001, "the ramp's normal: %s" % slope)
	var before := digests(scatter, 0)
	terrain.rays_per_frame = 37
	scatter.regenerate()
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "the instances are the same with fewer rays per frame")
	terrain.collision_mask = 2
	await settle(scatter)
	var heights := all_transforms(scatter).map(func(one: Transform3D) -> float: return one.origin.y)
	check(heights.all(func(height: float) -> bool: return absf(height - 80.5) < 0.001), "all instances are on the roof")
	terrain.collision_mask = 1
	terrain.ray_top = 10.0
	await settle(scatter)
	heights = all_transforms(scatter).map(func(one: Transform3D) -> float: return one.origin.y)
	check(heights.size() > 500 and heights.max() < 10.0, "all instances are below the top of the rays")


func test_colliders_do_not_depend_on_tiles() -> void:
	make_colliders()
	await check_tiling(ScatterGroundColliders.new(), "colliders")


func test_rays_are_limited_per_physics_frame() -> void:
	make_colliders()
	var terrain := ScatterGroundColliders.new()
	terrain.rays_per_frame = 100
	var scatter := make_scatter([make_layer(1.0)], terrain, make_viewer())
	var start := Engine.get_physics_frames()
	await settle(scatter)
	var sampled: int = scatter.get_stats()["points_sampled"]
	var passed := Engine.get_physics_frames() - start
	check(sampled > 5000, "points: %d" % sampled)
	check(passed >= 0.9 * sampled / 100.0, "%d points took %d physics frames" % [sampled, passed])


func test_colliders_reject_invalid_values() -> void:
	make_colliders()
	var terrain := ScatterGroundColliders.new()
	for wrong: Array in [["collision_mask", -1], ["collision_mask", 1 << 32], ["rays_per_frame", 0],
			["rays_per_frame", 1 << 40], ["ray_top", NAN], ["ray_top", 2e6], ["ray_bottom", INF], ["ray_bottom", -2e6]]:
		var good: Variant = terrain.get(wrong[0])
		terrain.set(wrong[0], wrong[1])
		check_error(["ScatterGroundColliders." + wrong[0]], "%s = %s" % wrong)
		check_equal(terrain.get(wrong[0]), good, wrong[0])
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	var before := digests(scatter, 0)
	check(before.size() > 10, "many tiles are visible")
	terrain.ray_bottom = 2000.0
	await settle(scatter)
	check_error(["ScatterGroundColliders.ray_bottom", "2000"], "a bottom above the top")
	check_equal(digests(scatter, 0), before, "the instances do not change")
	check("ray_bottom" in "\n".join(scatter.get_problems()), "the value is reported as a problem")
	terrain.ray_bottom = -1000.0
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "a valid value restores the same instances")
	terrain.collision_mask = 0
	await settle(scatter)
	check_equal(scatter.get_stats()["instances"], 0, "instances without a layer")
	check("collision_mask" in "\n".join(scatter.get_problems()), "a warning without a layer")


func make_mesh(mesh: Mesh, at: Transform3D, group := &"ground") -> MeshInstance3D:
	var instance := MeshInstance3D.new()
	instance.mesh = mesh
	instance.add_to_group(group)
	put(instance, at)
	return instance


func make_meshes() -> Array[MeshInstance3D]:
	var plane := PlaneMesh.new()
	plane.size = Vector2(60.0, 40.0)
	var box := BoxMesh.new()
	box.size = Vector3(10.0, 10.0, 10.0)
	return [make_mesh(plane, Transform3D(Basis(), Vector3(10.0, 3.0, 0.0))),
		make_mesh(plane, Transform3D(Basis(Vector3.BACK, deg_to_rad(20.0)), Vector3(-60.0, 5.0, 0.0))),
		make_mesh(box, Transform3D(Basis(Vector3.UP, 0.6), Vector3(20.0, 0.0, 0.0)))]


func test_meshes() -> void:
	var instances := make_meshes()
	make_mesh(BoxMesh.new(), Transform3D(Basis().scaled(Vector3.ONE * 90.0), Vector3.ZERO), &"other")
	var terrain := ScatterGroundMeshes.new()
	terrain.group = &"ground"
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	var wrong := 0
	var on_box := 0
	var stand := all_transforms(scatter)
	for one in stand:
		wrong += int(absf(one.origin.z) > 20.001 or one.origin.x > 40.001)
		var local := instances[2].global_transform.affine_inverse() * one.origin
		var from_box := maxf(absf(local.x), absf(local.z)) - 5.0
		if absf(from_box) < 0.01:
			continue
		on_box += int(from_box < 0.0)
		var slope := 5.0 + (one.origin.x + 60.0) * tan(deg_to_rad(20.0))
		var height := 5.0 if from_box < 0.0 else 3.0 if one.origin.x > -20.0 else slope
		wrong += int(absf(one.origin.y - height) > 0.01)
	check(stand.size() > 300 and on_box > 10, "instances: %d, on the box %d" % [stand.size(), on_box])
	check_equal(wrong, 0, "instances off the meshes")
	check(is_nan(terrain.get_height(Vector3(0.0, 0.0, 25.0))), "no ground outside of the meshes")
	var leaning := Vector3.UP.rotated(Vector3.BACK, deg_to_rad(20.0))
	check(terrain.get_normal(Vector3(-60.0, 0.0, 0.0)).distance_to(leaning) < 1e-4, "the normal of the leaning mesh")
	var rects: Array[Rect2] = []
	terrain.ground_changed.connect(func(rect: Rect2) -> void: rects.push_back(rect))
	terrain.refresh()
	check_equal(rects.size(), 0, "no areas are reported without a change")
	instances[2].global_position = Vector3(0.0, 0.0, 5.0)
	terrain.refresh()
	if check_equal(rects.size(), 2, "moving a box reports two areas"):
		var reach := 5.0 * (cos(0.6) + sin(0.6))
		for from: Vector2 in [Vector2(20.0, 0.0), Vector2(0.0, 5.0)]:
			var around := Rect2(from.x - reach, from.y - reach, 2.0 * reach, 2.0 * reach)
			check(rects.any(around.is_equal_approx), "%s is among the areas: %s" % [around, rects])
	check(absf(terrain.get_height(Vector3(0.0, 0.0, 5.0)) - 5.0) < 1e-5, "the box is at its new position")
	await settle(scatter)
	var top := Vector3(0.0, 5.0, 5.0)
	var distances := all_transforms(scatter).map(func(one: Transform3D) -> float: return one.origin.distance_to(top))
	check(distances.min() < 3.0, "instances on the moved box")
	for instance in instances:
		instance.free()
	terrain.refresh()
	check(rects.size() > 2, "freeing all meshes reports their areas")
	await settle(scatter)
	check_equal(scatter.get_stats()["instances"], 0, "instances without meshes")
	check("\"ground\"" in "\n".join(scatter.get_problems()), "a warning for a group without meshes")
	terrain.group = &""
	check("ScatterGroundMeshes.group" in "\n".join(scatter.get_problems()), "a warning without a group")


func test_nodes_share_the_data_of_meshes() -> void:
	var instances := make_meshes()
	var terrain := ScatterGroundMeshes.new()
	terrain.group = &"ground"
	var both: Array[TerrainScatter3D] = []
	for index in 2:
		both.push_back(make_scatter([make_layer()], terrain, make_viewer()))
	for scatter in both:
		await settle(scatter)
	var later := make_scatter([make_layer()], terrain, make_viewer())
	await settle(later)
	var expected := digests(later, 0)
	check(later.get_stats()["instances"] > 300, "%d instances" % later.get_stats()["instances"])
	for scatter in both:
		check_equal(digests(scatter, 0), expected, "a node that was added later has the same instances")
	var meshes := {}
	for instance: MeshInstance3D in instances:
		meshes[instance.mesh] = true
	check_equal(later.get_stats()["ground_reads"], meshes.size(), "each mesh is read once")


func test_meshes_do_not_depend_on_tiles() -> void:
	make_meshes()
	var terrain := ScatterGroundMeshes.new()
	terrain.group = &"ground"
	await check_tiling(terrain, "meshes")
