extends "regions_harness.gd"
## Tests ScatterRegion3D: shapes, reactions to changes, rejected values, problems, and adding and removing regions.


func test_shapes() -> void:
	var scatter := make_field()
	await settle(scatter)
	var before := instances(scatter, 0)
	var frame := Transform3D(Basis.from_euler(Vector3(0.4, 0.9, -0.3)).scaled_local(Vector3(2.0, 1.0, 0.5)),
			Vector3(7.0, 1.0, -11.0))
	var polygon := PackedVector2Array(
			[Vector2(-9, -9), Vector2(12, -6), Vector2(0, 0), Vector2(10, 14), Vector2(-9, 9)])
	for exclude: bool in [true, false]:
		for shape: ScatterRegion3D.Shape in [ScatterRegion3D.SHAPE_BOX, ScatterRegion3D.SHAPE_SPHERE,
				ScatterRegion3D.SHAPE_CYLINDER, ScatterRegion3D.SHAPE_POLYGON]:
			var region := make_region(shape, exclude)
			region.size = Vector3(14.0, 9.0, 30.0)
			region.radius = 16.0
			region.height = 60.0
			region.polygon = polygon
			region.transform = frame
			if shape == ScatterRegion3D.SHAPE_SPHERE:
				region.scale = Vector3.ONE
			elif shape == ScatterRegion3D.SHAPE_CYLINDER:
				region.scale = Vector3(1.0, 0.5, 1.0)
			elif shape == ScatterRegion3D.SHAPE_POLYGON:
				region.rotation = Vector3(0.0, 0.9, 0.0)
			scatter.add_child(region)
			await settle(scatter)
			check_kept(scatter, before, func(at: Vector3) -> bool: return within(region, at) != exclude,
					"shape %d, exclude %s" % [shape, exclude])
			region.free()
			await settle(scatter)
			check(instances(scatter, 0) == before, "all instances return after shape %d" % shape)


func test_paths() -> void:
	var scatter := make_field()
	await settle(scatter)
	var before := instances(scatter, 0)
	var path := make_path([Vector3(-30, 5, -20), Vector3(0, 900, 10), Vector3(40, -3, 0)])
	root.add_child(path)
	var region := make_region(ScatterRegion3D.SHAPE_PATH)
	region.width = 5.0
	scatter.add_child(region)
	region.path = region.get_path_to(path)
	await check_path(scatter, before, path, "a path at a distance")
	region.position = Vector3(50, 0, 50)
	await check_path(scatter, before, path, "the region moved")
	path.transform = Transform3D(Basis(Vector3.UP, 1.0), Vector3(3.0, 0.0, -4.0))
	await check_path(scatter, before, path, "the path moved")
	path.curve.set_point_position(1, Vector3(10, 0, -30))
	await check_path(scatter, before, path, "a point of the curve moved")
	path.curve = make_curve([Vector3(-20, 0, 0), Vector3(20, 0, 0)])
	await check_path(scatter, before, path, "a new curve")
	root.remove_child(path)
	await settle(scatter)
	check(instances(scatter, 0) == before, "a path outside of the tree")
	scatter.add_child(path)
	region.path = NodePath()
	region.reparent(path)
	await check_path(scatter, before, path, "the parent's path")
	path.free()
	await settle(scatter)
	check(instances(scatter, 0) == before, "path and region are freed")


func test_ignore_height_and_falloff() -> void:
	var scatter := make_field()
	await settle(scatter)
	var before := instances(scatter, 0)
	var region := make_region(ScatterRegion3D.SHAPE_CYLINDER)
	region.radius = 20.0
	region.position.y = 100.0
	scatter.add_child(region)
	await settle(scatter)
	check(instances(scatter, 0) == before, "a region high above the ground has no effect")
	region.ignore_height = true
	await settle(scatter)
	check_kept(scatter, before, func(at: Vector3) -> bool: return Vector2(at.x, at.z).length() >= 20.0, "with ignore_height, only instances below the region are removed")
	var sharp := instances(scatter, 0)
	region.falloff = 15.0
	await settle(scatter)
	var soft := instances(scatter, 0)
	var deep := 0
	var outer := 0
	for id in soft:
		check(before.has(id), "a region adds no instances")
		deep += int(on_map(soft[id]).length() < 5.0 - BEYOND)
		outer += int(not sharp.has(id))
	check_equal(deep, 0, "instances deeper than the falloff")
	check(outer > 50, "%d remain in the falloff" % outer)
	for id in sharp:
		check(soft.has(id), "nothing is removed outside")


func test_layers_by_name() -> void:
	var scatter := make_field(3)
	await settle(scatter)
	var before := [digests(scatter, 0), digests(scatter, 1), digests(scatter, 2)]
	var region := make_region(ScatterRegion3D.SHAPE_SPHERE)
	region.radius = 20.0
	region.layers = ["layer 1", "layer 2"]
	scatter.add_child(region)
	await settle(scatter)
	for layer in 3:
		check_equal(digests(scatter, layer) == before[layer], layer == 0, "layer %d is unchanged" % layer)
	var excluded := [digests(scatter, 0), digests(scatter, 1), digests(scatter, 2)]
	scatter.layers[1].resource_name = "other"
	check_equal(region.layers, ["other", "layer 2"], "the region refers to the renamed layer")
	for names: Array in [region.layers, [scatter.layers[1], scatter.layers[2]], [&"other", scatter.layers[2]]]:
		region.layers = names
		await settle(scatter)
		for layer in 3:
			check(digests(scatter, layer) == excluded[layer], "layer %d, by %s" % [layer, names])
	region.layers = [scatter.layers[1]]
	check_equal(region.layers, ["other"], "references to a layer use its name if it has one")
	check_equal(region.get_problems(), PackedStringArray(), "no problems")
	region.layers.push_back("layer 2")
	check_error(["read-only"], "an edit without a signal")
	region.layers = [null]
	check_error(["ScatterRegion3D.layers", "null"], "an invalid layer")
	check_equal(region.layers, ["other"], "the old list stays")
	region.layers = ["layer 1", 5, "layer 2"]
	await settle(scatter)
	check(digests(scatter, 1) == before[1], "a layer with another name")
	check_equal(region.get_problems().size(), 2, "problems with unknown layers")
	check("\"layer 1\"" in region.get_problems()[0] and "5" in region.get_problems()[1], "they are listed: %s" % region.get_problems())
	region.layers = []
	await settle(scatter)
	for layer in 3:
		check(digests(scatter, layer) != before[layer], "no names: layer %d" % layer)
	check_equal(region.get_problems().size(), 0, "problems")


func test_hidden_regions() -> void:
	var scatter := make_field()
	await settle(scatter)
	var before := digests(scatter, 0)
	var between := Node3D.new()
	scatter.add_child(between)
	var region := make_region(ScatterRegion3D.SHAPE_SPHERE)
	between.add_child(region)
	await settle(scatter)
	var with_region := digests(scatter, 0)
	check(with_region != before, "a region deeper in the tree is used")
	for node: Node3D in [region, between]:
		node.hide()
		await settle(scatter)
		check(digests(scatter, 0) == before, "a hidden region has no effect")
		node.show()
		await settle(scatter)
		check(digests(scatter, 0) == with_region, "a region that is shown again has its effect")
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	scatter.hide()
	await settle(scatter)
	scatter.show()
	await settle(scatter)
	check_equal(scatter.get_stats()["tiles_made"], tiles_made, "a hidden scatter regenerates nothing")


func test_adding_and_removing_regions() -> void:
	var scatter := make_field()
	await settle(scatter)
	var before := digests(scatter, 0)
	var region := make_region(ScatterRegion3D.SHAPE_BOX)
	scatter.add_child(region)
	await settle(scatter)
	var with_region := digests(scatter, 0)
	scatter.remove_child(region)
	await settle(scatter)
	check(digests(scatter, 0) == before, "a region outside of the tree has no effect")
	region.position.x = 3.0
	region.position.x = 0.0
	scatter.add_child(region)
	await settle(scatter)
	check(digests(scatter, 0) == with_region, "a region that returns to the tree has its effect")
	root.remove_child(scatter)
	root.add_child(scatter)
	await settle(scatter)
	check(digests(scatter, 0) == with_region, "a region that is added with its scatter has its effect")
	var other := make_field()
	region.reparent(other)
	await settle(scatter)
	await settle(other)
	check(digests(scatter, 0) == before, "the region moved away")
	check(digests(other, 0) == with_region, "the region affects its new scatter")
	other.remove_child(region)
	other.free()
	check_equal(region.get_problems().size(), 0, "no problems outside of the tree")
	root.add_child(region)
	check("TerrainScatter3D" in "".join(region.get_problems()), "a problem: a region must be below a scatter")
	region.free()
	region = make_region(ScatterRegion3D.SHAPE_BOX)
	scatter.add_child(region)
	await frames(1)
	scatter.free()
	check(not is_instance_valid(region), "freed with its scatter")


func test_freed_in_any_frame() -> void:
	for round in 12:
		var scatter := make_field()
		var regions: Array[ScatterRegion3D] = []
		for index in 4:
			regions.push_back(make_region(index as ScatterRegion3D.Shape, index % 2 == 0))
			scatter.add_child(regions[-1])
		await frames(round % 4)
		regions[0].queue_free()
		regions[1].position.x += 5.0
		regions[2].free()
		await frames(round % 3)
		if round % 2:
			scatter.queue_free()
		else:
			scatter.free()
		await frames(1)
		check(not is_instance_valid(regions[3]), "the region is freed")


func test_properties_without_effect_are_hidden() -> void:
	var counts: Array[PackedStringArray] = [
		["ignore_height", "size"], ["ignore_height", "radius"], ["ignore_height", "radius", "height"], ["polygon"],
		["path", "width"],
	]
	var region := ScatterRegion3D.new()
	var notifications := [0]
	region.property_list_changed.connect(func() -> void: notifications[0] += 1)
	for shape: ScatterRegion3D.Shape in counts.size():
		region.shape = shape
		var seen := PackedStringArray()
		var stored := PackedStringArray()
		for property in region.get_property_list():
			if property["usage"] & PROPERTY_USAGE_EDITOR:
				seen.push_back(property["name"])
			if property["usage"] & PROPERTY_USAGE_STORAGE:
				stored.push_back(property["name"])
		for name: String in ["ignore_height", "size", "radius", "height", "polygon", "path", "width"]:
			check_equal(name in seen, name in counts[shape], "shape %d shows %s" % [shape, name])
			check(name in stored, "shape %d stores %s" % [shape, name])
		for name: String in ["shape", "exclude", "layers", "falloff"]:
			check(name in seen, "shape %d shows %s" % [shape, name])
	check_equal(notifications[0], counts.size() - 1, "one notification of the inspector per change")
	region.free()


func test_saved_and_loaded() -> void:
	var scatter := make_field()
	var path := make_path([Vector3(-20, 0, 0), Vector3(20, 0, 9)])
	scatter.add_child(path)
	path.owner = scatter
	var shapes := [ScatterRegion3D.SHAPE_BOX, ScatterRegion3D.SHAPE_POLYGON, ScatterRegion3D.SHAPE_PATH]
	for shape: ScatterRegion3D.Shape in shapes:
		var region := make_region(shape)
		region.polygon = PackedVector2Array([Vector2(20, 20), Vector2(40, 20), Vector2(20, 45)])
		region.layers = ["layer 0"]
		path.add_child(region)
		region.owner = scatter
	await settle(scatter)
	var packed := PackedScene.new()
	check_equal(packed.pack(scatter), OK, "the scatter is packed")
	var copy: TerrainScatter3D = packed.instantiate()
	copy.viewers = []
	root.add_child(copy)
	copy.viewers = [copy.get_path_to(make_viewer())]
	await settle(copy)
	check(digests(copy, 0) == digests(scatter, 0), "the same instances")


func test_rejected_values() -> void:
	var region := ScatterRegion3D.new()
	for property: String in ["falloff", "radius", "height", "width"]:
		for value: float in [NAN, INF, -1.0, 1e9]:
			var good: float = region.get(property)
			region.set(property, value)
			check_error(["ScatterRegion3D." + property], "%s = %s" % [property, value])
			check_equal(region.get(property), good, property)
	for size: Vector3 in [Vector3(1, 0, 1), Vector3(NAN, 1, 1), Vector3(1, 1, -2), Vector3(1e8, 1, 1)]:
		region.size = size
		check_error(["ScatterRegion3D.size"], "size %s" % size)
	region.polygon = PackedVector2Array([Vector2(0, 0), Vector2(INF, 0), Vector2(0, 1)])
	check_error(["ScatterRegion3D.polygon", "finite"], "a corner at infinity")
	var large: PackedVector2Array
	large.resize(65537)
	region.polygon = large
	check_error(["ScatterRegion3D.polygon", "65537"], "too many corners")
	region.set("shape", 5)
	check_error(["ScatterRegion3D.shape", "5"], "no such shape")
	check(region.size == Vector3(10, 10, 10) and region.polygon.is_empty() and region.shape == 0, "the properties are unchanged")
	region.free()


func test_shear_and_scales() -> void:
	var scatter := make_field()
	await settle(scatter)
	var before := digests(scatter, 0)
	var stretched := Node3D.new()
	stretched.scale = Vector3(3.0, 1.0, 1.0)
	scatter.add_child(stretched)
	var region := make_region(ScatterRegion3D.SHAPE_BOX)
	region.rotation.y = 0.5
	stretched.add_child(region)
	await settle(scatter)
	check_error(["ScatterRegion3D.shear"], "a sheared box")
	check(digests(scatter, 0) == before, "the sheared box has no effect")
	check("shear" in "".join(region.get_problems()), "the shear is a problem")
	region.position.x = 2.0
	await settle(scatter)
	check_no_error("no second error")
	region.rotation.y = 0.0
	await settle(scatter)
	check(digests(scatter, 0) != before, "a scaled box has an effect")
	check_equal(region.get_problems().size(), 0, "problems of a box")
	region.shape = ScatterRegion3D.SHAPE_SPHERE
	check("largest" in "".join(region.get_problems()), "a problem: a sphere has one radius")
	region.scale = Vector3(0, 1, 1)
	await settle(scatter)
	errors.take() # The engine also prints an error for such a basis.
	check(digests(scatter, 0) == before, "an empty region has no effect")


func test_problems() -> void:
	var scatter := make_field()
	var region := make_region(ScatterRegion3D.SHAPE_POLYGON)
	scatter.add_child(region)
	region.polygon = PackedVector2Array([Vector2(0, 0), Vector2(9, 0)])
	check("fewer than 3 corners" in "".join(region.get_problems()), "two corners")
	region.polygon.push_back(Vector2(9, 9))
	region.polygon = PackedVector2Array([Vector2(0, 0), Vector2(9, 0), Vector2(9, 9)])
	check_equal(region.get_problems().size(), 0, "three corners")
	region.shape = ScatterRegion3D.SHAPE_PATH
	check("No path" in "".join(region.get_problems()), "no path")
	region.path = ^".."
	check("No path" in "".join(region.get_problems()), "a node that is not a path")
	var path := Path3D.new()
	scatter.add_child(path)
	region.path = region.get_path_to(path)
	check("2 points" in "".join(region.get_problems()), "a path without a curve")
	path.curve = make_curve([Vector3.ZERO])
	check("2 points" in "".join(region.get_problems()), "a curve with one point")
	path.curve.add_point(Vector3(5, 0, 5))
	check_equal(region.get_problems().size(), 0, "no problems with a valid path")
	await settle(scatter)
