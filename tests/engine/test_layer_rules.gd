extends "rules_harness.gd"
## Tests a layer's rules: each removes instances according to its density and has no other effect.

## Ground with two textures that blend along x.
class Textured extends Node3D:
	func get_height(_at: Vector3) -> float:
		return 3.0

	func get_texture_id(at: Vector3) -> Vector3:
		return Vector3(2, 5, clampf(0.5 + at.x / 60.0, 0.0, 1.0))


func image_texture(width: int, height: int, pixel: Callable) -> ImageTexture:
	var image := Image.create_empty(width, height, false, Image.FORMAT_RGBA8)
	for x in width:
		for y in height:
			image.set_pixel(x, y, pixel.call(x, y))
	return ImageTexture.create_from_image(image)


func test_densities() -> void:
	var layer := make_layer()
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var terrain := scatter.ground
	await check_rule(scatter, "density", 0.5, func(_at: Vector3) -> float: return 0.5)
	await check_rule(scatter, "min_height", 100.0, func(at: Vector3) -> float: return float(at.y >= 100.0))
	var over_height := make_line(Vector2(60, 0), Vector2(150, 1))
	await check_rule(scatter, "density_over_height", over_height, func(at: Vector3) -> float:
		return clampf((at.y - 60.0) / 90.0, 0.0, 1.0))
	var over_slope := make_line(Vector2(40, 1), Vector2(50, 0))
	await check_rule(scatter, "density_over_slope", over_slope, func(at: Vector3) -> float:
		var slope := rad_to_deg(acos(terrain.get_normal(at).y))
		return 0.5 if absf(slope - 40.0) < 0.1 or absf(slope - 50.0) < 0.1 else clampf((50.0 - slope) / 10.0, 0.0, 1.0))


func test_noise() -> void:
	var layer := make_layer()
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var noise := FastNoiseLite.new()
	noise.frequency = 0.05
	await check_rule(scatter, "noise", noise, func(at: Vector3) -> float: return 0.5 + 0.5 * noise.get_noise_2d(at.x, at.z))
	layer.noise = noise
	layer.density = 1.0
	var steep := make_line(Vector2(-0.1, 0), Vector2(0.1, 1))
	layer.noise_curve = steep
	await settle(scatter)
	var cut := instances(scatter)
	layer.noise = null
	layer.noise_curve = null
	await settle(scatter)
	check_filtered(instances(scatter), cut, func(at: Vector3) -> float:
		var value := noise.get_noise_2d(at.x, at.z)
		return 0.5 if absf(absf(value) - 0.1) < 1e-3 else steep.sample(clampf(value, -0.1, 0.1)), "noise_curve")


## Workers use a copy of the noise, so no thread sees a partial change. A change while they work regenerates the tiles.
func test_noise_that_changes_during_the_work() -> void:
	var layer := make_layer()
	layer.noise = FastNoiseLite.new()
	var scatter := scatter_on_hillside(layer)
	for step in 20:
		layer.noise.frequency = 0.01 * (step + 1)
		await frames(1)
	await settle(scatter)
	var seen := instances(scatter)
	var other := make_layer()
	other.noise = FastNoiseLite.new()
	other.noise.frequency = 0.2
	var again := scatter_on_hillside(other)
	await settle(again)
	check(instances(again) == seen, "the %d instances match the last frequency" % seen.size())


func test_painted_mask() -> void:
	var layer := make_layer()
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var mask := ScatterMask.new()
	mask.background = 0.25
	mask.paint(Vector2(-20, 30), 40.0, 1.0, 0.3)
	mask.paint(Vector2(40, 10), 20.0, 1.0, 0.5, ScatterMask.MODE_ERASE)
	await check_rule(scatter, "mask", mask, func(at: Vector3) -> float: return mask.sample(Vector2(at.x, at.z)))


## A dab changes only the instances under it and regenerates only the tiles that it touches. Restoring the pixels undoes the dab.
func test_dabs() -> void:
	var layer := make_layer()
	var mask := ScatterMask.new()
	mask.background = 0.25
	var scatter := scatter_on_hillside(layer)
	layer.mask = mask
	await settle(scatter)
	var before := instances(scatter)
	var pixels := mask.get_pixel_rect(Rect2(-12, -12, 24, 24))
	var saved_pixels := mask.get_pixels(pixels)
	var painted: Array[Rect2] = []
	var visible_tiles: Dictionary = await shown_by(scatter, func() -> void: painted.push_back(mask.paint(Vector2.ZERO, 12.0)))
	var rect := painted[0]
	for key: Array in visible_tiles:
		var tile := Rect2(Vector2(key[1]) * layer.tile_size, Vector2.ONE * layer.tile_size)
		check(tile.intersects(rect, true), "tile %s does not touch %s" % [key[1], rect])
	check_equal(visible_tiles.values(), [1, 1, 1, 1], "four tiles are regenerated once each")
	var after := instances(scatter)
	var outside := 0
	for id: int in before:
		var placed: Transform3D = before[id][0]
		if not rect.has_point(Vector2(placed.origin.x, placed.origin.z)):
			outside += 1
			if not (after.has(id) and after[id] == before[id]):
				check(false, "changed outside of the dab: %s" % placed.origin)
	check(outside > 1000 and after.size() > before.size(), "%d instances, then %d, of which %d are outside of the dab" % [before.size(), after.size(), outside])
	check(after.has_all(before.keys()), "a dab that adds density removes nothing")
	mask.set_pixels(pixels, saved_pixels)
	await settle(scatter)
	check(instances(scatter) == before, "restoring the pixels restores the instances")


func test_mask_texture_channels() -> void:
	var layer := make_layer()
	layer.mask_texture_edge = ScatterLayer.MASK_EDGE_CLAMP
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var whole := instances(scatter)
	layer.mask_texture = image_texture(3, 2, func(_x: int, _y: int) -> Color: return Color8(51, 102, 153, 204))
	for channel in 5:
		layer.mask_texture_channel = channel as ScatterLayer.MaskChannel
		await settle(scatter)
		var share: float = [0.2, 0.4, 0.6, 0.8, (0.2126 * 51 + 0.7152 * 102 + 0.0722 * 153) / 255.0][channel]
		check_filtered(whole, instances(scatter), func(_at: Vector3) -> float: return share, "channel %d" % channel)
	var image := Image.create_empty(2, 2, false, Image.FORMAT_R8)
	image.fill(Color(0.6, 0.0, 0.0))
	layer.mask_texture = ImageTexture.create_from_image(image)
	await settle(scatter)
	check_filtered(whole, instances(scatter), func(_at: Vector3) -> float: return 0.6, "luminance with only a red channel")


func test_mask_texture_rect_and_edges() -> void:
	var layer := make_layer()
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var whole := instances(scatter)
	layer.mask_texture = image_texture(2, 1, func(x: int, _y: int) -> Color: return Color(x, 0, 0))
	layer.mask_texture_rect = Rect2(-40, -10, 60, 70)
	for edge in 4:
		layer.mask_texture_edge = edge as ScatterLayer.MaskEdge
		await settle(scatter)
		check_filtered(whole, instances(scatter), func(at: Vector3) -> float:
			var x := (at.x + 40.0) / 60.0
			var inside := x >= 0.0 and x < 1.0 and at.z >= -10.0 and at.z < 60.0
			if absf(x) < 1e-5 or absf(x - 1.0) < 1e-5 or absf(at.z + 10.0) < 1e-4 or absf(at.z - 60.0) < 1e-4:
				return 0.5
			if edge == ScatterLayer.MASK_EDGE_REPEAT:
				return 1.0 - absf(fposmod(2.0 * x - 0.5, 2.0) - 1.0)
			if not inside and edge != ScatterLayer.MASK_EDGE_CLAMP:
				return float(edge == ScatterLayer.MASK_EDGE_EVERYTHING)
			return clampf(2.0 * x - 0.5, 0.0, 1.0), "edge %d" % edge)
	layer.mask_texture_rect = Rect2(-4000, -4000, 2, 2)
	layer.mask_texture_edge = ScatterLayer.MASK_EDGE_EVERYTHING
	await settle(scatter)
	check(instances(scatter) == whole, "an image that is far away has no effect")


func test_textures_whose_images_are_set_later() -> void:
	var layer := make_layer()
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var whole := instances(scatter)
	layer.mask_texture_rect = Rect2(-200, -200, 400, 400)
	layer.mask_texture = ImageTexture.new()
	await settle(scatter)
	check_equal(instances(scatter).size(), 0, "no instances without an image")
	var half := Image.create_empty(4, 4, false, Image.FORMAT_L8)
	half.fill(Color(0.4, 0.4, 0.4))
	(layer.mask_texture as ImageTexture).set_image(half)
	await settle(scatter)
	check_filtered(whole, instances(scatter), func(_at: Vector3) -> float: return 0.4, "an image that was set later")
	var texture := NoiseTexture2D.new()
	texture.width = 32
	texture.height = 32
	texture.noise = FastNoiseLite.new()
	layer.mask_texture = texture
	await until(func() -> bool: return texture.get_image() != null, "the engine has generated the noise")
	await settle(scatter)
	var stand := instances(scatter)
	check(stand.size() > 500 and stand.size() < whole.size() and whole.has_all(stand.keys()), "%d instances remain with a noise texture" % stand.size())


func test_textures_that_are_too_large() -> void:
	var layer := make_layer()
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var before := instances(scatter)
	layer.mask_texture = ImageTexture.create_from_image(Image.create_empty(16385, 1, false, Image.FORMAT_L8))
	await settle(scatter)
	check_error(["layers[0]: ScatterLayer.mask_texture must be between", "16385"], "too many pixels")
	check(instances(scatter) == before, "the instances do not change")
	check("mask_texture" in "\n".join(scatter.get_problems()), "the texture is reported as a problem")
	layer.mask_texture = ImageTexture.create_from_image(Image.create_empty(16384, 1, false, Image.FORMAT_L8))
	await settle(scatter)
	check_equal(instances(scatter).size(), 0, "a black image with the maximum number of pixels excludes all instances")


func test_density_expression() -> void:
	var layer := make_layer()
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	await check_rule(scatter, "density_expression", "smoothstep(-20, 20, x)", func(at: Vector3) -> float: return smoothstep(-20, 20, at.x))
	await check_rule(scatter, "density_expression", "(z < 0) * 0.5 + (z >= 0) * clamp(height / 40, 0, 1)", func(at: Vector3) -> float:
		return 0.5 if at.z < 0 else clampf(at.y / 40.0, 0.0, 1.0))
	layer.density_expression = "noise(12) < 0.3"
	await settle(scatter)
	var third := instances(scatter).size()
	layer.density_expression = "  "
	await settle(scatter)
	check_equal(layer.density_expression, "", "a blank text is empty")
	check(absf(third - 0.3 * instances(scatter).size()) < 0.06 * instances(scatter).size(), "noise is uniform: %d of %d" % [third, instances(scatter).size()])
	scatter.free()


## Ground textures affect the density on worker threads and on the main thread.
func test_ground_textures() -> void:
	var node := Textured.new()
	root.add_child(node)
	var part := func(at: Vector3) -> float: return clampf(0.5 + at.x / 60.0, 0.0, 1.0)
	for thread_safe: bool in [true, false]:
		var terrain := ScatterGroundNode.new()
		terrain.thread_safe = thread_safe
		var layer := make_layer()
		var scatter := scatter_on_hillside(layer)
		layer.view_distance = 40.0
		terrain.node = scatter.get_path_to(node)
		scatter.ground = terrain
		await settle(scatter)
		await check_rule(scatter, "ground_textures", PackedInt32Array([5]), part)
		await check_rule(scatter, "ground_textures", PackedInt32Array([9, 2]), func(at: Vector3) -> float: return 1.0 - part.call(at))
		var whole := instances(scatter)
		layer.ground_textures = [2, 5]
		await settle(scatter)
		check(instances(scatter).size() > whole.size() - 5, "both textures cover the ground, up to rounding")
		layer.ground_textures = [3]
		await settle(scatter)
		check_equal(instances(scatter).size(), 0, "instances on a texture that does not occur")
		scatter.ground = hillside()
		await settle(scatter)
		check(instances(scatter).size() > 1000, "a ground without textures permits everything")
		scatter.free()


func test_clumps() -> void:
	var layer := make_layer()
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var whole := instances(scatter)
	layer.clump_size = 12.0
	layer.clump_softness = 0.0
	var last := {}
	for coverage: float in [0.25, 0.5, 0.75]:
		layer.clump_coverage = coverage
		await settle(scatter)
		var stand := instances(scatter)
		check(absf(stand.size() / float(whole.size()) - coverage) < 0.12, "%d of %d instances remain for a coverage of %s" % [stand.size(), whole.size(), coverage])
		check(whole.has_all(stand.keys()) and stand.has_all(last.keys()), "larger clumps contain the smaller ones")
		last = stand
	layer.clump_size = 0.0
	await settle(scatter)
	check(instances(scatter) == whole, "without clumps, all instances return")


func test_edge_feather() -> void:
	var layer := make_layer()
	layer.min_height = 100.0 # The ground has this height at x = 0.
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var sharp := instances(scatter)
	layer.edge_feather = 20.0
	await settle(scatter)
	var soft := instances(scatter)
	check(sharp.has_all(soft.keys()), "an edge feather adds no instances")
	var stand := {"near": 0, "far": 0}
	var stood := {"near": 0, "far": 0}
	for id: int in sharp:
		var x: float = sharp[id][0].origin.x
		var where := "near" if x < 5.0 else "far" if x > 21.0 else ""
		if where:
			stood[where] += 1
			stand[where] += int(soft.has(id) and soft[id] == sharp[id])
	check(stand["near"] < 0.4 * stood["near"] and stood["near"] > 50, "few instances are near the edge: %s of %s" % [stand, stood])
	check_equal(stand["far"], stood["far"], "instances far from the edge")


func test_rules_multiply() -> void:
	var layer := make_layer()
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var whole := instances(scatter)
	var noise := FastNoiseLite.new()
	var mask := ScatterMask.new()
	mask.background = 0.8
	mask.paint(Vector2(0, 20), 30.0, 1.0, 0.5, ScatterMask.MODE_ERASE)
	layer.density = 0.9
	layer.noise = noise
	layer.mask = mask
	layer.density_over_height = make_line(Vector2(0, 0.5), Vector2(400, 1))
	await settle(scatter)
	check_filtered(whole, instances(scatter), func(at: Vector3) -> float:
		return 0.9 * (0.5 + 0.5 * noise.get_noise_2d(at.x, at.z)) * mask.sample(Vector2(at.x, at.z)) * (0.5 + at.y / 800.0), "all")


## Dragging a curve's point regenerates each tile at most once per frame, and only if it has an effect.
func test_edits_in_place_regenerate_once() -> void:
	var layer := make_layer()
	var curve := make_line(Vector2(0, 1), Vector2(400, 0))
	layer.density_over_height = curve
	layer.mask = ScatterMask.new()
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var tiles := scatter.get_shown_tiles(scatter.layers[0]).size()
	var visible_tiles: Dictionary = await shown_by(scatter, func() -> void:
		for step in 10:
			curve.set_point_value(1, 0.05 * step))
	check_equal(visible_tiles.size(), tiles, "all tiles are regenerated")
	check_equal(visible_tiles.values().max(), 1, "each tile is regenerated once")
	for same: Callable in [curve.emit_changed, func() -> void: curve.bake_resolution = 50, layer.emit_changed, layer.mask.emit_changed]:
		visible_tiles = await shown_by(scatter, same)
		check_equal(visible_tiles.size(), 0, "tiles regenerated by a change without an effect")
