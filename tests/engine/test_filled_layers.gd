extends "edits_harness.gd"
## Tests layers that fill gaps in everything that uses windows of them: regions, queries of rectangles, navigation and bakes. Also tests which new
## layers of the panel fill gaps.

const Bake := preload("res://addons/thicket/bake.gd")
const NewLayers := preload("res://addons/thicket/editor/layers/new_layers.gd")

const APART := 4.0 ## The distance in meters that birches keep from oaks.


## Returns oaks, and birches that fill the gaps between them.
func make_species() -> Array[ScatterLayer]:
	var oaks := named_layer("oak", 31, 4.0)
	oaks.density = 0.5
	var birches := named_layer("birch", 32, 4.0)
	birches.spacing = {"oak": APART}
	birches.spacing_fills = true
	for layer: ScatterLayer in [oaks, birches]:
		layer.tile_size = 32.0
		layer.view_distance = 90.0
	return [oaks, birches]


## Returns the instances within a square around the origin.
func in_square(all: Dictionary[int, Transform3D], half: float) -> Dictionary[int, Transform3D]:
	var result: Dictionary[int, Transform3D] = {}
	for id in all:
		if maxf(absf(all[id].origin.x), absf(all[id].origin.z)) < half:
			result[id] = all[id]
	return result


## Birches fill an area from which a region excludes oaks. A region that excludes birches moves no other birch.
func test_regions() -> void:
	var scatter := make_scatter(make_species(), ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var oaks := instances(scatter, 0)
	var birches := instances(scatter, 1)
	var region := ScatterRegion3D.new()
	region.shape = ScatterRegion3D.SHAPE_CYLINDER
	region.exclude = true
	region.radius = 20.0
	region.height = 100.0
	region.layers = ["oak"]
	scatter.add_child(region)
	await settle(scatter)
	var filled := instances(scatter, 1)
	var was := 0
	var is_now := 0
	for id in birches:
		was += int(on_map(birches[id]).length() < 16.0)
	for id in filled:
		is_now += int(on_map(filled[id]).length() < 16.0)
	check(is_now > 1.4 * was, "%d birches in the clearing, %d before" % [is_now, was])
	var points := PackedVector2Array()
	for id in instances(scatter, 0):
		points.push_back(on_map(oaks[id]))
		check(on_map(oaks[id]).length() >= 20.0 - FLOATS, "oaks are outside of the region")
	for id in in_square(filled, 60.0):
		check(nearest(on_map(filled[id]), points) >= APART - FLOATS, "birches keep their distance")
	region.layers = ["birch"]
	await settle(scatter)
	var expected := birches.duplicate()
	for id in birches:
		if on_map(birches[id]).length() < 20.0:
			expected.erase(id)
	check_equal(instances(scatter, 1) == expected, true, "birches outside of the region stay")
	check(expected.size() < birches.size(), "the region excludes birches")
	region.free()
	await settle(scatter)
	check_equal(instances(scatter, 1) == birches, true, "the birches without a region")


## Rectangles of any size and position contain the same instances as the displayed tiles, and beyond the view distance they agree with each other.
func test_queries_of_rectangles() -> void:
	var scatter := make_scatter(make_species(), ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var birches := instances(scatter, 1)
	for rect: Rect2 in [Rect2(-50, -50, 100, 100), Rect2(-7.5, 3.25, 20, 41), Rect2(10, 10, 0.5, 0.5)]:
		var expected := 0
		for id in birches:
			expected += int(rect.has_point(on_map(birches[id])))
		var found := scatter.query_rect(rect, [scatter.layers[1]])
		check_equal(found.size(), expected, "birches in %s" % rect)
		for index in found.size():
			check(birches.has(found.ids[index]), "a birch of the displayed tiles")
	var whole := scatter.query_rect(Rect2(1000, -2000, 300, 200), [scatter.layers[1]]).ids
	var parts: Dictionary[int, bool] = {}
	for x in range(0, 300, 75):
		for y in range(0, 200, 40):
			for id in scatter.query_rect(Rect2(1000 + x, -2000 + y, 75, 40), [scatter.layers[1]]).ids:
				check(not parts.has(id), "the parts do not overlap")
				parts[id] = true
	check(whole.size() > 500 and parts.size() == whole.size(), "%d birches in parts of %d" % [parts.size(), whole.size()])
	for id in whole:
		check(parts.has(id), "the parts have the same birches")


## Source geometry for navigation contains each birch, whether tiles are loaded or not.
func test_navigation() -> void:
	var species := make_species()
	for layer in species:
		layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
		layer.instance_radius = 0.4
		layer.instance_height = 4.0
	var scatter := make_scatter(species, ScatterGroundFlat.new(), make_viewer(Vector3(1e5, 0, 0)))
	var mesh := NavigationMesh.new()
	mesh.geometry_parsed_geometry_type = NavigationMesh.PARSED_GEOMETRY_STATIC_COLLIDERS
	mesh.filter_baking_aabb = AABB(Vector3(-40, -5, -40), Vector3(80, 10, 80))
	var region := NavigationRegion3D.new()
	region.navigation_mesh = mesh
	root.add_child(region)
	scatter.reparent(region, false)
	scatter.viewers = []
	var centers: Array[PackedVector2Array] = []
	for loaded: bool in [false, true]:
		if loaded:
			scatter.viewers = [scatter.get_path_to(make_viewer())]
			await settle(scatter)
		var data := NavigationMeshSourceGeometryData3D.new()
		NavigationServer3D.parse_source_geometry_data(mesh, data, region)
		var found := PackedVector2Array()
		for obstruction: Dictionary in data.get_projected_obstructions():
			var vertices: PackedFloat32Array = obstruction["vertices"]
			var sum := Vector2.ZERO
			for at in range(0, vertices.size(), 3):
				sum += Vector2(vertices[at], vertices[at + 2])
			found.push_back(sum / (vertices.size() / 3.0))
		centers.push_back(found)
	check(centers[0].size() > 200 and centers[0].size() == centers[1].size(), "%d trunks unloaded, %d loaded" % [centers[0].size(), centers[1].size()])
	var seen := 0
	var birches := in_square(instances(scatter, 1), 39.0)
	for id in birches:
		seen += int(nearest(on_map(birches[id]), centers[0]) < 0.05)
	check(seen > 80 and seen == birches.size(), "%d trunks of %d birches" % [seen, birches.size()])


## Baked tiles of a filled layer equal the displayed ones bit for bit.
func test_bake() -> void:
	var scatter := make_scatter(make_species(), ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var bake := Bake.new()
	check_equal(bake.begin(scatter, Rect2(-32, -64, 96, 64), "res://baked/filled", "wood", [scatter.layers[1]]), OK, "begun")
	while bake.step(1.0):
		await process_frame
	check_equal(bake.problem, "", "no problem")
	var scene := (load("res://baked/filled/wood.tscn") as PackedScene).instantiate()
	check_equal(scene.get_child_count(), 3 * 2, "a node for each tile")
	for node: MultiMeshInstance3D in scene.get_children():
		var tile := Vector2i((Vector2(node.position.x, node.position.z) / 32.0).floor())
		check(node.multimesh.buffer == tile_buffers(scatter, 1, tile)[0], "the instances of tile %s" % tile)
	scene.free()


## New layers fill the gaps between earlier layers of similar radius. Layers that keep a distance from much larger ones, such as undergrowth, do not.
func test_new_layers() -> void:
	var oaks := named_layer("oak", 1, 5.0)
	var birches := named_layer("birch", 2, 4.0)
	var hazels := named_layer("hazel", 3, 3.0)
	var ferns := named_layer("fern", 4, 1.0)
	var all: Array[ScatterLayer] = [oaks, birches, hazels, ferns]
	NewLayers.keep_apart(all, all)
	var filling := all.map(func(layer: ScatterLayer) -> bool: return layer.spacing_fills)
	check_equal(filling, [false, true, true, false], "trees of similar radius fill")
	check(hazels.spacing.has("oak") and hazels.spacing.has("birch") and ferns.spacing.has("oak"), "all keep apart")
	var alders := named_layer("alder", 5, 4.5)
	alders.on_surfaces = true
	var mixed: Array[ScatterLayer] = [named_layer("oak", 1, 5.0), alders]
	NewLayers.keep_apart([alders], mixed)
	check(alders.spacing.has("oak") and not alders.spacing_fills, "a layer on surfaces does not fill")
	var scatter := make_scatter(all, ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	check_equal(scatter.get_problems(), PackedStringArray(), "problems")
	check(instances(scatter, 1).size() > 50 and instances(scatter, 2).size() > 50, "the gaps have birches and hazels")


## A ground that only the main thread may sample has the same instances as one that any thread may sample.
func test_ground_of_the_main_thread() -> void:
	var found: Array[Dictionary] = []
	for ground: ScatterGround in [Mound.new(), MainMound.new()]:
		var species := make_species()
		species[1].max_slope_degrees = 9.0
		var scatter := make_scatter(species, ground, make_viewer())
		await settle(scatter)
		found.push_back(instances(scatter, 1))
		scatter.free()
	check(found[0].size() > 100, "%d birches" % found[0].size())
	check_equal(found[1] == found[0], true, "the same birches")
