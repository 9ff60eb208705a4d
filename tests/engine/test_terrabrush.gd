extends "plugins_harness.gd"
## Tests the ground of TerraBrush: its heights, edits, holes, and zones that cannot be copied.

func zone_area(node: TerraBrushDouble, zone: Vector2i) -> Rect2:
	var first := node.place_of(zone, Vector2i.ZERO)
	return Rect2(first.x + node.position.x, first.y + node.position.z, node.zones_size - 1.0, node.zones_size - 1.0)


## Returns the height that TerraBrush draws. It is interpolated between samples, unlike the result of getHeightAtPosition().
func drawn_height(node: TerraBrushDouble, at: Vector3) -> float:
	var step := (node.zones_size - 1.0) / (node.image_size() - 1.0)
	var origin := zone_area(node, Vector2i.ZERO).position
	var point := (Vector2(at.x, at.z) - origin) / step
	var first := point.floor()
	var posts: Array[float] = []
	for corner in 4:
		var post := (first + Vector2(corner % 2, floori(corner / 2.0))) * step + origin - Vector2(node.position.x, node.position.z)
		posts.push_back(node.shape(post.x, post.y) + node.position.y)
	var part := point - first
	return lerpf(lerpf(posts[0], posts[1], part.x), lerpf(posts[2], posts[3], part.x), part.y)


func test_terrabrush() -> void:
	for case: Array in [[65, 1], [64, 1], [65, 2]]:
		var node := TerraBrushDouble.new()
		node.zones_size = case[0]
		node.resolution = case[1]
		node.position = Vector3(3.0, -2.0, 5.0)
		node.add_zone(Vector2i(0, 0))
		node.add_zone(Vector2i(-1, 0))
		var scatter := make_on(node)
		await settle(scatter)
		var context := "zones of %d, resolution %d" % case
		check("TerraBrush" in names_of(scatter), "%s: recognized: %s" % [context, names_of(scatter)])
		check_on(scatter, func(at: Vector3) -> float: return drawn_height(node, at),
				zone_area(node, Vector2i(-1, 0)).merge(zone_area(node, Vector2i.ZERO)), 1000, context)
		for post: Vector2i in [Vector2i(3, 4), Vector2i(20, 0), Vector2i(0, 9)]:
			var point := node.place_of(Vector2i.ZERO, post) + Vector2(node.position.x, node.position.z)
			var height: float = scatter.ground.get_height(Vector3(point.x, 0.0, point.y))
			check(absf(height - node.getHeightAtPosition(point.x, point.y, true)) < 1e-3, "%s: its own height at sample %s" % [context, post])
		check_equal(scatter.get_problems().size(), 0, "%s: problems: %s" % [context, scatter.get_problems()])
		scatter.free()
		node.free()


func test_terrabrush_is_edited() -> void:
	var node := TerraBrushDouble.new()
	var zone := node.add_zone(Vector2i.ZERO)
	var scatter := make_on(node)
	await settle(scatter)
	var all := scatter.get_shown_tiles(scatter.layers[0]).size()
	var hill := Rect2(-4.0, -4.0, 8.0, 8.0)
	var sculpt := func() -> void:
		for x in range(28, 37):
			for y in range(28, 37):
				zone.image.set_pixel(x, y, Color(40.0, 0.0, 0.0))
		await frames(3)
	var regenerated_tiles := await regenerated_by(scatter, sculpt)
	check(within(scatter, hill).values().all(func(at: Vector3) -> bool: return absf(at.y - 40.0) < 0.01), "a hill is detected without a signal")
	check(not regenerated_tiles.is_empty() and regenerated_tiles.size() < all, "%d of %d tiles were regenerated" % [regenerated_tiles.size(), all])
	var nothing := await regenerated_by(scatter, func() -> void: await frames(5))
	check_equal(nothing.size(), 0, "no tile is regenerated without an edit")
	await regenerated_by(scatter, func() -> void:
		for x in range(28, 37):
			for y in range(28, 37):
				zone.image.set_pixel(x, y, Color(40.0, 1.0, 0.0))
		await frames(3))
	check(within(scatter, hill.grow(0.9)).is_empty(), "a hole has no instances")
	var before := by_id(scatter).size()
	await regenerated_by(scatter, func() -> void:
		node.add_zone(Vector2i(1, 0))
		await frames(3))
	check(by_id(scatter).size() > before + 300, "instances are placed on a new zone")
	var height: float = by_id(scatter).values()[0].y
	await regenerated_by(scatter, func() -> void:
		node.position.y += 10.0
		await frames(3))
	check(absf(by_id(scatter).values()[0].y - height - 10.0) < 0.01, "instances move with the node")


func test_terrabrush_without_a_terrain() -> void:
	var node := TerraBrushDouble.new()
	var scatter := make_on(node)
	await settle(scatter)
	check_error(["TerraBrush", "no terrain"], "no zones yet")
	node.add_zone(Vector2i.ZERO)
	await frames(3)
	await settle(scatter)
	check(all_transforms(scatter).size() > 500, "instances when the terrain is created")
	check_no_error("created")


func test_terrabrush_has_no_textures() -> void:
	var node := TerraBrushDouble.new()
	node.add_zone(Vector2i.ZERO)
	var layer := make_layer()
	layer.ground_textures = [0]
	var scatter := make_on(node, false, layer)
	await settle(scatter)
	check("ground_textures has no effect" in "\n".join(scatter.get_problems()), "problems: %s" % scatter.get_problems())
	check(all_transforms(scatter).size() > 500, "%d instances" % all_transforms(scatter).size())


func test_terrabrush_with_unknown_zones_is_refused() -> void:
	var cases: Dictionary[String, Callable] = {
		"zonesSize of at least 2": func(node: TerraBrushDouble) -> void: node.zones_size = 1,
		"not square": func(node: TerraBrushDouble) -> void: node.zones.zones[0].image.crop(65, 33),
		"the format RGF": func(node: TerraBrushDouble) -> void: node.zones.zones[0].image.convert(Image.FORMAT_RGBAF),
		"differs in size": func(node: TerraBrushDouble) -> void: node.add_zone(Vector2i(1, 0)).image.resize(33, 33),
		"cannot be copied": func(node: TerraBrushDouble) -> void: node.add_zone(Vector2i(1 << 20, 1 << 20)),
	}
	for words in cases:
		var node := TerraBrushDouble.new()
		node.add_zone(Vector2i.ZERO)
		cases[words].call(node)
		var scatter := make_on(node)
		await settle(scatter)
		check_error(["TerraBrush", words], "an unknown layout")
		check(words in "\n".join(scatter.get_problems()), "problems: %s" % scatter.get_problems())
		check(all_transforms(scatter).is_empty(), "%s: no instances" % words)
		scatter.free()
		node.free()


func test_terrabrush_zones_without_heightmaps_are_skipped() -> void:
	var node := TerraBrushDouble.new()
	node.add_zone(Vector2i.ZERO)
	var empty := node.add_zone(Vector2i(1, 0))
	empty.image = null
	var scatter := make_on(node)
	await settle(scatter)
	check_on(scatter, func(at: Vector3) -> float: return drawn_height(node, at), zone_area(node, Vector2i.ZERO), 500, "the other zone")
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())
