extends "terrain_harness.gd"
## A test double of HTerrain with its maps, their position, and its edit signals, modeled on its source (1.8 and later,
## hterrain.gd and hterrain_data.gd).

const CHANNEL_HEIGHT := 0
const CHANNEL_SPLAT := 2
const CHANNEL_COLOR := 3
const CHANNEL_SPLAT_INDEX := 6
const CHANNEL_SPLAT_WEIGHT := 7


## Data without a signal for edits, because the signal's signature depends on HTerrain's version. Subclasses add the signal.
class HTerrainDataDouble extends Resource:
	signal resolution_changed
	signal map_added(type: int, index: int)
	signal map_removed(type: int, index: int)
	signal map_changed(type: int, index: int)

	var maps: Dictionary[int, Array] = {}
	var textures: Dictionary[int, Array] = {} ## The maps that a game has loaded, as textures without an image.
	var resolution := 65
	var point_calls := 0 ## The number of queries for single positions.
	var read: Dictionary[int, int] = {} ## How often each map was read.

	func _init(format := Image.FORMAT_RF) -> void:
		maps[CHANNEL_HEIGHT] = [Image.create_empty(resolution, resolution, false, format)]

	func get_resolution() -> int:
		return resolution

	func get_map_count(map_type: int) -> int:
		return maps[map_type].size() if maps.has(map_type) else 0

	func get_image(map_type: int, index := 0) -> Image:
		read[map_type] = read.get(map_type, 0) + 1
		return maps[map_type][index]

	func get_texture(map_type: int, index := 0, _writable := false) -> Texture2D:
		var image := get_image(map_type, index)
		return ImageTexture.create_from_image(image) if image != null else textures[map_type][index]

	## Turns all maps except the heights into textures, as a game loads them from PNG files.
	func become_loaded() -> void:
		for map_type in maps:
			if map_type != CHANNEL_HEIGHT:
				textures[map_type] = maps[map_type].map(imported)
				maps[map_type] = maps[map_type].map(func(_image: Image) -> Image: return null)

	## Returns the texture that the editor would import from an image: loaded from a file, uncompressed, without mipmaps.
	static func imported(image: Image) -> CompressedTexture2D:
		const SPOT := "user://thicket_map.ctex"
		var file := FileAccess.open(SPOT, FileAccess.WRITE)
		file.store_buffer("GST2".to_ascii_buffer())
		for number: int in [1, image.get_width(), image.get_height(), 0, 0, 0, 0, 0]: # Version, width, height, flags and reserved fields.
			file.store_32(number)
		file.store_32(0) # Data format: uncompressed.
		file.store_16(image.get_width())
		file.store_16(image.get_height())
		file.store_32(0) # Mipmap count.
		file.store_32(image.get_format())
		file.store_buffer(image.get_data())
		file.close()
		var texture := CompressedTexture2D.new()
		texture.load(SPOT)
		DirAccess.remove_absolute(ProjectSettings.globalize_path(SPOT))
		return texture

	func add_map(map_type: int, format: Image.Format, color: Color) -> Image:
		var image := Image.create_empty(resolution, resolution, false, format)
		image.fill(color)
		if not maps.has(map_type):
			maps[map_type] = []
		maps[map_type].push_back(image)
		map_added.emit(map_type, maps[map_type].size() - 1)
		return image

	func post_at(column: int, row: int) -> float:
		var image := get_image(CHANNEL_HEIGHT)
		var color := image.get_pixel(clampi(column, 0, resolution - 1), clampi(row, 0, resolution - 1))
		if image.get_format() == Image.FORMAT_RGB8:
			return (color.r8 + color.g8 * 256 + color.b8 * 65536) / 1024.0 - 8192.0
		return color.r

	func set_post(column: int, row: int, height: float) -> void:
		var image := get_image(CHANNEL_HEIGHT)
		var steps := int((height + 8192.0) * 1024.0)
		var color := Color(height, 0.0, 0.0)
		if image.get_format() == Image.FORMAT_RGB8:
			color = Color8(steps % 256, floori(steps / 256.0) % 256, floori(steps / 65536.0))
		image.set_pixel(column, row, color)

	func get_interpolated_height_at(at: Vector3) -> float:
		point_calls += 1
		return height_at(at)

	func height_at(at: Vector3) -> float:
		var column := floori(at.x)
		var row := floori(at.z)
		var near := lerpf(post_at(column, row), post_at(column + 1, row), at.x - column)
		return lerpf(near, lerpf(post_at(column, row + 1), post_at(column + 1, row + 1), at.x - column), at.z - row)

	static func hill(column: int, row: int) -> float:
		return 4.0 * sin(0.13 * column) + 0.15 * row + 2.0 * cos(0.2 * row + 0.05 * column)

	func fill(height := hill) -> void:
		for row in resolution:
			for column in resolution:
				set_post(column, row, height.call(column, row))

	func notify_region_change(_rect: Rect2i, _map_type: int, _index := 0) -> void:
		assert(false)


## Data that reports edits like HTerrain 1.8.
class HTerrain18Data extends HTerrainDataDouble:
	signal region_changed(x: int, y: int, w: int, h: int, channel: int)

	func notify_region_change(rect: Rect2i, map_type: int, _index := 0) -> void:
		region_changed.emit(rect.position.x, rect.position.y, rect.size.x, rect.size.y, map_type)
		changed.emit()


## Data that reports edits like HTerrain since July 2026.
class HTerrainMasterData extends HTerrainDataDouble:
	signal region_changed(rect: Rect2i, channel: int, index: int)

	func notify_region_change(rect: Rect2i, map_type: int, index := 0) -> void:
		region_changed.emit(rect, map_type, index)
		changed.emit()


class HTerrainDouble extends Node3D:
	signal transform_changed(global_transform: Transform3D)

	var map_scale := Vector3.ONE:
		set(value):
			map_scale = value
			emit_transform()
	var centered := true:
		set(value):
			centered = value
			emit_transform()
	var shader_type := "Classic4"
	var _data: HTerrainDataDouble

	func _init() -> void:
		set_notify_transform(true)

	func _notification(what: int) -> void:
		if what == NOTIFICATION_TRANSFORM_CHANGED:
			emit_transform()

	func emit_transform() -> void:
		if is_inside_tree():
			transform_changed.emit(get_internal_transform())

	func get_data() -> HTerrainDataDouble:
		return _data

	## Sets the data without emitting a signal.
	func set_data(data: HTerrainDataDouble) -> void:
		_data = data

	func get_shader_type() -> String:
		return shader_type

	func is_using_indexed_splatmap() -> bool:
		return false

	func get_internal_transform() -> Transform3D:
		var made := Transform3D(global_basis * Basis().scaled(map_scale), global_position)
		if centered and _data != null:
			var half := 0.5 * (_data.get_resolution() - 1.0)
			made.origin += made.basis * Vector3(-half, 0.0, -half)
		return made

	## Returns the height of the ground at a world position, or NAN outside the map.
	func ground_at(at: Vector3) -> float:
		var to_world := get_internal_transform()
		var on_map := to_world.affine_inverse() * at
		var last := _data.resolution - 1.0
		if on_map.x < 0.0 or on_map.z < 0.0 or on_map.x > last or on_map.z > last:
			return NAN
		return (to_world * Vector3(on_map.x, _data.height_at(on_map), on_map.z)).y


static func make_hterrain(data: HTerrainDataDouble = null) -> HTerrainDouble:
	if data == null:
		data = HTerrainMasterData.new()
	data.fill()
	var node := HTerrainDouble.new()
	node.set_data(data)
	node.map_scale = Vector3(2.0, 1.5, 2.0)
	return node


## Returns the number of instances that are not on the double's current ground. Positions that rounding has moved off the map are first
## moved slightly inward.
func off_the_ground(scatter: TerrainScatter3D, node: HTerrainDouble) -> int:
	var wrong := 0
	for one in all_transforms(scatter):
		var height := node.ground_at(one.origin)
		if is_nan(height):
			height = node.ground_at(node.global_position.lerp(one.origin, 0.999))
		wrong += int(is_nan(height) or absf(height - one.origin.y) > 0.02)
	return wrong


func check_ground(scatter: TerrainScatter3D, node: HTerrainDouble, context: String) -> void:
	check(scatter.get_stats()["instances"] > 500, "%s: %d instances" % [context, scatter.get_stats()["instances"]])
	check_equal(off_the_ground(scatter, node), 0, context + ": instances off the ground")
