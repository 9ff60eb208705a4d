extends "harness.gd"
## Tests many changes, one per frame, as when a designer drags a slider.

const TILE := 16.0
const NEAR := 32.0

var seen := {}
var most_pending := 0


## Returns the node's limit for pending tiles: 64 per worker, with one core reserved for the main thread.
func limit() -> int:
	return 64 * (clampi(OS.get_processor_count(), 2, 9) - 1)


func near(tile: Vector2i) -> bool:
	var rect := Rect2(Vector2(tile) * TILE, Vector2.ONE * TILE)
	return Vector2.ZERO.distance_to(Vector2.ZERO.clamp(rect.position, rect.end)) <= NEAR


func make_wide_scatter(layer: ScatterLayer) -> TerrainScatter3D:
	layer.tile_size = TILE
	layer.view_distance = 200.0
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	scatter.tile_shown.connect(func(_layer: ScatterLayer, tile: Vector2i) -> void: seen[tile] = seen.get(tile, 0) + 1)
	return scatter


## Calls `change` once per frame for at least `steps` frames, and until `condition` returns true, and records the largest number of
## pending tiles.
func drag(scatter: TerrainScatter3D, change: Callable, steps: int, condition := Callable()) -> void:
	seen.clear()
	most_pending = 0
	var deadline := Time.get_ticks_msec() + IDLE_TIMEOUT_MSEC
	var step := 0
	while step < steps or (condition.is_valid() and not condition.call() and Time.get_ticks_msec() < deadline):
		change.call(step)
		await process_frame
		most_pending = maxi(most_pending, scatter.get_stats()["pending"])
		step += 1


func test_tiles_are_updated_while_a_slider_is_dragged_without_a_queue() -> void:
	var layer := make_layer(1.0)
	var scatter := make_wide_scatter(layer)
	await settle(scatter)
	var tiles: int = scatter.get_stats()["tiles"]
	check(tiles > limit(), "more tiles than the limit: %d" % tiles)
	Engine.max_fps = 60
	var near_tiles: Array[Vector2i] = scatter.get_shown_tiles(scatter.layers[0]).filter(near)
	var regenerated := func() -> bool: return near_tiles.all(func(tile: Vector2i) -> bool: return seen.get(tile, 0) >= 3)
	await drag(scatter, func(step: int) -> void: layer.density = 0.5 + 0.0001 * (step % 5000), 90, regenerated)
	check(most_pending <= limit(), "%d pending tiles, limit %d" % [most_pending, limit()])
	check(regenerated.call(), "every near tile was regenerated three times during the drag")
	# After the drag, only the pending tiles are generated, and then each tile once.
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	await settle(scatter)
	Engine.max_fps = 0
	var late: int = scatter.get_stats()["tiles_made"] - tiles_made
	check(late <= tiles + limit(), "tiles generated after the drag: %d of %d" % [late, tiles])
	check_equal(scatter.get_stats()["tiles"], tiles, "visible tiles")

	var fresh_layer := layer.duplicate() as ScatterLayer
	var new_scatter := make_scatter([fresh_layer], ScatterGroundFlat.new(), make_viewer())
	await settle(new_scatter)
	check_equal(digests(scatter, 0), digests(new_scatter, 0), "the last value wins")


func make_scene() -> PackedScene:
	var root_of_it := Node3D.new()
	var scene := PackedScene.new()
	scene.pack(root_of_it)
	root_of_it.free()
	return scene


## Changes the properties in the group Gameplay, except affect_navigation_mesh.
func edit_gameplay(layer: ScatterLayer, step: int) -> void:
	layer.instance_radius = 0.1 + step
	layer.instance_height = 0.1 + step
	layer.regrowth_time = step
	layer.collision_shape = (step % 5) as ScatterLayer.CollisionShape
	layer.collision_distance = 10.0 + step
	layer.collision_layer = step
	layer.collision_mask = step
	layer.physics_material = PhysicsMaterial.new()
	layer.scene = null if step % 2 else make_scene()
	# This distance is so small that no scene appears. An instance that a scene replaces would cause an upload.
	layer.scene_distance = 0.01 * step


func test_drawing_properties_regenerate_nothing() -> void:
	var layer := make_layer(1.0)
	layer.meshes = with_lods(layer.meshes, [[SphereMesh.new()]], [10.0])
	var scatter := make_wide_scatter(layer)
	await settle(scatter)
	var before := scatter.get_stats()
	var far: ScatterLod = (layer.meshes[0] as ScatterModel).lods[1]
	await drag(scatter, func(step: int) -> void: layer.thin_end = 100.0 + step, 20)
	await drag(scatter, func(step: int) -> void: far.distance = 10.0 + step, 20)
	await drag(scatter, func(step: int) -> void: edit_gameplay(layer, step), 20)
	await drag(scatter, func(step: int) -> void: scatter.quality = 0.02 * step, 20)
	await settle(scatter)
	for figure: String in ["tiles_made", "uploads", "instances"]:
		check_equal(scatter.get_stats()[figure], before[figure], figure + " after changes that only affect drawing")
	check(scatter.get_stats()["drawn"] < before["drawn"], "fewer instances are drawn at a lower quality")


func test_tiles_of_replaced_layers_are_dropped() -> void:
	var layer := make_layer(1.0)
	var other := make_layer(1.5)
	other.meshes = [SphereMesh.new(), BoxMesh.new()]
	layer.layer_id = 1
	other.layer_id = 2
	var scatter := make_wide_scatter(layer)
	other.tile_size = TILE
	other.view_distance = 200.0
	await settle(scatter)
	# The two layers replace each other while tiles are pending.
	for step in 7:
		layer.density = 0.9 - 0.05 * step
		await process_frame
		scatter.layers = [other if step % 2 == 0 else layer]
		await process_frame
	await settle(scatter)
	var new_scatter := make_scatter([other], ScatterGroundFlat.new(), make_viewer())
	await settle(new_scatter)
	check_equal(digests(scatter, 0), digests(new_scatter, 0), "the tiles match the last layer")
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		check_equal(tile_ids(scatter, 0, tile).size(), 2, "meshes of tile %s" % tile)
