extends "picture_harness.gd"
## Tests a tile's multimeshes: meshes and visible instances by distance, quality, colors and custom data. Only a real renderer stores
## multimeshes, so run this without --headless.

const REACH := 0.8660254 ## The distance in meters from the center of a 1 m cube to a corner.


func visible_count(multimesh: RID, all: int) -> int:
	var count := RenderingServer.multimesh_get_visible_instances(multimesh)
	return all if count < 0 else count


## Returns the number of a tile's instances that the renderer draws, for all meshes together.
func drawn_of(scatter: TerrainScatter3D, tile: Vector2i) -> int:
	var sum := 0
	var ids := tile_ids(scatter, 0, tile)
	var multimeshes := tile_multimeshes(scatter, 0, tile)
	for mesh in ids.size():
		if (multimeshes[mesh] as RID).is_valid():
			sum += visible_count(multimeshes[mesh], ids[mesh].size())
	return sum


func drawn_of_all(scatter: TerrainScatter3D) -> int:
	var sum := 0
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		sum += drawn_of(scatter, tile)
	return sum


func shown_buffers(scatter: TerrainScatter3D) -> Dictionary:
	var buffers := {}
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		buffers[tile] = tile_buffers(scatter, 0, tile)
	return buffers


## Returns the box from which the node measures distances: around all instances, enlarged by the reach of their meshes in meters.
func box_of(scatter: TerrainScatter3D, tile: Vector2i, buffers: Array, stride: int, reach: float) -> AABB:
	var box := AABB()
	var empty := true
	for buffer: PackedFloat32Array in buffers:
		for at in range(0, buffer.size(), stride):
			var point := Vector3(buffer[at + 3], buffer[at + 7], buffer[at + 11])
			box = AABB(point, Vector3.ZERO) if empty else box.expand(point)
			empty = false
	box.position += scatter.get_tile(scatter.layers[0], tile).get_origin()
	return box.grow(reach)


func distance_to(box: AABB, at: Vector3) -> float:
	return at.distance_to(at.clamp(box.position, box.end))


func make_detailed_layer() -> ScatterLayer:
	var layer := make_layer(2.0)
	layer.view_distance = 150.0
	layer.meshes = with_lods([BoxMesh.new(), BoxMesh.new()], [[BoxMesh.new(), null], [BoxMesh.new(), BoxMesh.new()]], [40.0, 100.0])
	layer.thin_begin = 50.0
	layer.thin_end = 120.0
	layer.thin_density = 0.25
	layer.thin_scale_up = true
	layer.use_custom_data = true
	return layer


## Checks the LODs and counts of all tiles, except within 6 % of a distance where the LOD changes. Returns the number of tiles per LOD.
func check_detail(scatter: TerrainScatter3D, layer: ScatterLayer, buffers: Dictionary, at: Vector3) -> Array[int]:
	var meshes: Array[Array] = [
		[lod_mesh(layer, 0, 0), lod_mesh(layer, 1, 0)],
		[lod_mesh(layer, 0, 1), lod_mesh(layer, 1, 0)],
		[lod_mesh(layer, 0, 2), lod_mesh(layer, 1, 1)],
	]
	var seen: Array[int] = [0, 0, 0]
	for tile: Vector2i in buffers:
		var distance := distance_to(box_of(scatter, tile, buffers[tile], 16, REACH * 2.0), at)
		if absf(distance / 39.0 - 1.0) < 0.06 or absf(distance / 97.5 - 1.0) < 0.06:
			continue
		var level := 0 if distance < 40.0 else (1 if distance < 100.0 else 2)
		seen[level] += 1
		var density := 1.0 - 0.75 * clampf((distance - 50.0) / 70.0, 0.0, 1.0)
		var multimeshes := tile_multimeshes(scatter, 0, tile)
		for mesh in 2:
			var expected := (meshes[level][mesh] as Mesh).get_rid()
			if RenderingServer.multimesh_get_mesh(multimeshes[mesh]) != expected:
				check(false, "tile %s, %f m away, does not draw mesh %d of LOD %d" % [tile, distance, mesh, level])
			var buffer: PackedFloat32Array = buffers[tile][mesh]
			var ranks := range(14, buffer.size(), 16).map(func(index: int) -> float: return buffer[index])
			var fewest := ranks.filter(func(rank: float) -> bool: return rank < density - 0.001).size()
			var maximum := ranks.filter(func(rank: float) -> bool: return rank < density + 0.02).size()
			var drawn := visible_count(multimeshes[mesh], ranks.size())
			if drawn < fewest or drawn > maximum:
				check(false, "tile %s, %f m away, draws %d instead of %d to %d" % [tile, distance, drawn, fewest, maximum])
	return seen


func test_meshes_and_thinning_depend_on_the_distance() -> void:
	var layer := make_detailed_layer()
	var viewer := make_viewer(Vector3(3.0, 2.0, 5.0))
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	await frames(10)
	var buffers := shown_buffers(scatter)
	var uploads: int = scatter.get_stats()["uploads"]
	check_equal(uploads, 2 * buffers.size(), "uploads of all tiles")
	var near := check_detail(scatter, layer, buffers, viewer.global_position)
	check(near[0] > 3 and near[1] > 10 and near[2] > 10, "tiles of each LOD: %s" % [near])
	# Moving straight up increases all distances but keeps the same tiles.
	for height: float in [30.0, 45.0, 80.0, 115.0, 20.0, 2.0]:
		viewer.global_position.y = height
		await frames(20)
		check_detail(scatter, layer, buffers, viewer.global_position)
		check_equal(scatter.get_stats()["drawn"], drawn_of_all(scatter), "drawn at a height of %f m" % height)
	check_equal(check_detail(scatter, layer, buffers, viewer.global_position), near, "LODs after returning")
	check_equal(scatter.get_stats()["uploads"], uploads, "uploads while the viewer moves")
	check_equal(shown_buffers(scatter), buffers, "the renderer's buffers")


func test_lods_have_hysteresis() -> void:
	var layer := make_layer(2.0)
	layer.view_distance = 120.0 # LOD distances include the viewer's height up to where the fade-out begins.
	layer.meshes = with_lods(layer.meshes, [[BoxMesh.new()]], [100.0])
	var viewer := make_viewer(Vector3(16.0, 0.0, 16.0))
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	var multimesh: RID = tile_multimeshes(scatter, 0, Vector2i.ZERO)[0]
	var coarse := {}
	for height: float in [99.0, 102.0, 99.0, 97.0, 94.0, 97.0, 99.0, 102.0]:
		viewer.global_position.y = height + REACH
		await frames(4)
		var mesh := RenderingServer.multimesh_get_mesh(multimesh)
		coarse.get_or_add(height, []).push_back(mesh == lod_mesh(layer, 0, 1).get_rid())
	check_equal(coarse, {99.0: [false, true, false], 102.0: [true, true], 97.0: [true, false], 94.0: [false]}, "coarse")


func test_quality_equals_a_lower_density() -> void:
	var layer := make_layer(1.0)
	layer.meshes = [BoxMesh.new(), SphereMesh.new()]
	layer.density = 0.8
	layer.max_slope_degrees = 60.0
	var viewer := make_viewer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	var uploads: int = scatter.get_stats()["uploads"]
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	for quality: float in [0.5, 0.0, 0.25, 1.0]:
		var thinner := layer.duplicate() as ScatterLayer
		thinner.density = layer.density * quality
		var model := make_scatter([thinner], ScatterGroundFlat.new(), viewer)
		await settle(model)
		scatter.quality = quality
		await frames(20)
		for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
			var all := tile_ids(scatter, 0, tile)
			var expected := tile_ids(model, 0, tile)
			for mesh in 2:
				var ids: PackedInt64Array = all[mesh]
				var drawn := visible_count(tile_multimeshes(scatter, 0, tile)[mesh], ids.size())
				# The library and this test round the product of rank and density differently, so one instance may differ.
				var common := mini(drawn, expected[mesh].size())
				if absi(drawn - expected[mesh].size()) > 1 or ids.slice(0, common) != expected[mesh].slice(0, common):
					check(false, "tile %s draws %d at quality %f instead of %d" % [tile, drawn, quality, expected[mesh].size()])
		check_equal(scatter.get_stats()["drawn"], drawn_of_all(scatter), "drawn at quality %f" % quality)
		model.queue_free()
	check_equal(scatter.get_stats()["drawn"], scatter.get_stats()["instances"], "drawn at full quality")
	check_equal(scatter.get_stats()["uploads"], uploads, "uploads for a new quality")
	check_equal(scatter.get_stats()["tiles_made"], tiles_made, "tiles generated for a new quality")


func test_new_tiles_have_the_current_quality() -> void:
	var layer := make_layer()
	var viewer := make_viewer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	scatter.quality = 0.0
	await settle(scatter)
	check_equal(drawn_of_all(scatter), 0, "instances drawn at quality 0")
	viewer.global_position.x = 1000.0
	await settle(scatter)
	check_equal(drawn_of_all(scatter), 0, "instances drawn at a new position at quality 0")
	check(scatter.get_stats()["instances"] > 1000, "the visible tiles contain instances")


func test_colors_and_custom_data() -> void:
	var gradient := Gradient.new()
	gradient.interpolation_mode = Gradient.GRADIENT_INTERPOLATE_CONSTANT
	gradient.offsets = PackedFloat32Array([0.0, 0.25])
	gradient.colors = PackedColorArray([Color(1.0, 0.0, 0.0), Color(0.0, 0.5, 1.0, 0.25)])
	var layer := make_layer()
	layer.use_colors = true
	layer.color_value = ScatterValueSource.new()
	layer.color_value.gradient = gradient
	layer.use_custom_data = true
	layer.min_scale = 0.5
	layer.max_scale = 1.5
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var counts := {}
	var sums := Vector2.ZERO
	var total := 0
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		var buffer: PackedFloat32Array = tile_buffers(scatter, 0, tile)[0]
		check_equal(buffer.size(), 20 * tile_ids(scatter, 0, tile)[0].size(), "floats of tile %s" % tile)
		var last_rank := 0.0
		for at in range(0, buffer.size(), 20):
			var color := Color(buffer[at + 12], buffer[at + 13], buffer[at + 14], buffer[at + 15])
			counts[color] = counts.get(color, 0) + 1
			sums += Vector2(buffer[at + 16], buffer[at + 17])
			var scale := Vector3(buffer[at], buffer[at + 4], buffer[at + 8]).length()
			if buffer[at + 18] < last_rank or absf(buffer[at + 19] - scale) > 0.001:
				check(false, "rank %f after %f, scale %f" % [buffer[at + 18], last_rank, buffer[at + 19]])
			last_rank = buffer[at + 18]
			total += 1
		check(last_rank > 0.9 and last_rank <= 1.0, "the last rank of tile %s is %f" % [tile, last_rank])
	check_equal(counts.size(), 2, "colors")
	check(absf(counts.get(Color(1.0, 0.0, 0.0), 0) / float(total) - 0.25) < 0.03, "a quarter is red: %s" % counts)
	check(Color(0.0, 0.5, 1.0, 0.25) in counts, "instances have the second color with its alpha")
	check((sums / total).distance_to(Vector2(0.5, 0.5)) < 0.03, "mean of variation and phase: %s" % (sums / total))
	# This renderer stores colors and custom data in half precision. The data of a built tile, which was never uploaded, must match.
	var built := scatter.build_rect(scatter.layers[0], Rect2(0.0, 0.0, 32.0, 32.0))
	check_equal(tile_buffers(scatter, 0, Vector2i.ZERO), buffers_of(built), "the renderer's buffers, bit for bit")
	# New colors regenerate tiles but do not move instances.
	var before := transforms_of(scatter, 20)
	gradient.set_color(0, Color(0.0, 1.0, 0.0))
	await settle(scatter)
	check(Color(0.0, 1.0, 0.0) in colors_of(scatter), "instances have the gradient's new color")
	layer.use_colors = false
	layer.use_custom_data = false
	await settle(scatter)
	check_equal(transforms_of(scatter, 12), before, "transforms without colors and custom data")


func transforms_of(scatter: TerrainScatter3D, stride: int) -> PackedFloat32Array:
	var result := PackedFloat32Array()
	var buffer: PackedFloat32Array = tile_buffers(scatter, 0, Vector2i.ZERO)[0]
	for at in range(0, buffer.size(), stride):
		result.append_array(buffer.slice(at, at + 12))
	return result


func colors_of(scatter: TerrainScatter3D) -> Array[Color]:
	var result: Array[Color] = []
	var buffer: PackedFloat32Array = tile_buffers(scatter, 0, Vector2i.ZERO)[0]
	for at in range(0, buffer.size(), 20):
		result.push_back(Color(buffer[at + 12], buffer[at + 13], buffer[at + 14], buffer[at + 15]))
	return result


## A shader with the add-on's includes compiles and receives the node's data.
func test_the_shader_includes() -> void:
	var shader := Shader.new()
	shader.code = """shader_type spatial;
		render_mode unshaded;
		#include "res://addons/thicket/shaders/scatter.gdshaderinc"
		#include "res://addons/thicket/shaders/scatter_scale.gdshaderinc"
		varying vec3 received;
		void vertex() {
			VERTEX = scatter_scaled(VERTEX) * max(scatter_fade(INSTANCE_CUSTOM, 1.0, 0.01), 0.9);
			received = vec3(scatter_scale / 4.0, scatter_own_scale(INSTANCE_CUSTOM) - 2.0,
					step(scatter_variation(INSTANCE_CUSTOM) + scatter_wind_phase(INSTANCE_CUSTOM)
							+ scatter_rank(INSTANCE_CUSTOM), 9.0));
		}
		void fragment() {
			ALBEDO = received;
		}"""
	var material := ShaderMaterial.new()
	material.shader = shader
	var layer := make_layer(2.0)
	layer.material_override = material
	layer.use_custom_data = true
	layer.min_scale = 2.0
	layer.max_scale = 2.0
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), look_down())
	await settle(scatter)
	var whole: float = await share_of_blue()
	check(whole > 0.4, "blue instances cover %f" % whole)
	layer.thin_density = 0.25
	await settle(scatter)
	await frames(4)
	var thinned: float = await share_of_blue()
	check(thinned < 0.6 * whole, "a quarter of the instances covers %f, all %f" % [thinned, whole])
	layer.thin_scale_up = true
	await settle(scatter)
	await frames(4)
	var compensated: float = await share_of_blue()
	check(compensated > 1.3 * thinned, "at twice the size they cover %f, at normal size %f" % [compensated, thinned])


func share_of_blue() -> float:
	return await share_of_pixels(func(pixel: Color) -> bool: return pixel.b > 0.9 and pixel.g < 0.1)
