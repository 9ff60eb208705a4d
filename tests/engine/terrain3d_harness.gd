extends "terrain_harness.gd"
## A test double of Terrain3D with its regions, its data and its signals, modeled on its source (versions 1.0 and 1.1,
## src/terrain_3d_data.cpp and src/terrain_3d_region.cpp).

enum { HEIGHT, CONTROL, COLOR, ALL_MAPS }

const HOLE := 1 << 2
const AUTO := 1


static func control_of(base: int, overlay: int, blend: int, flags := 0) -> int:
	return base << 27 | overlay << 22 | blend << 14 | flags


## Returns the float with these 32 bits.
static func as_float(bits: int) -> float:
	var bytes := PackedByteArray()
	bytes.resize(4)
	bytes.encode_u32(0, bits)
	return bytes.decode_float(0)


static func as_bits(number: float) -> int:
	var bytes := PackedByteArray()
	bytes.resize(4)
	bytes.encode_float(0, number)
	return bytes.decode_u32(0)


class Terrain3DRegionDouble extends Resource:
	var location := Vector2i.ZERO
	var maps: Array[Image] = []
	var deleted := false
	var edited := false

	func _init(at := Vector2i.ZERO, side := 64) -> void:
		location = at
		for map in 2:
			maps.push_back(Image.create_empty(side, side, false, Image.FORMAT_RF))

	func get_location() -> Vector2i:
		return location

	func get_height_map() -> Image:
		return maps[HEIGHT]

	func get_control_map() -> Image:
		return maps[CONTROL]

	func is_deleted() -> bool:
		return deleted


class Terrain3DDataDouble extends Object:
	signal maps_changed
	signal region_map_changed
	signal height_maps_changed
	signal control_maps_changed
	signal color_maps_changed
	signal maps_edited(edited_area: AABB)

	var terrain: Node3D
	var regions: Dictionary[Vector2i, Terrain3DRegionDouble] = {}
	var region_size := 64
	var vertex_spacing := 1.0
	var point_calls := 0 ## The number of queries for single positions.

	func get_regions_active(_copy := false, _deep := false) -> Array[Terrain3DRegionDouble]:
		var active: Array[Terrain3DRegionDouble] = []
		for at in regions:
			if not regions[at].deleted:
				active.push_back(regions[at])
		return active

	## Returns a region, even if it is marked as deleted, or null if it does not exist.
	func get_region(location: Vector2i) -> Terrain3DRegionDouble:
		return regions.get(location)

	func add_region(region: Terrain3DRegionDouble, update := true) -> void:
		region.deleted = false
		regions[region.location] = region
		if update:
			update_maps(ALL_MAPS, true, true)

	func remove_region(region: Terrain3DRegionDouble, update := true) -> void:
		region.deleted = true
		if update:
			update_maps(ALL_MAPS, true, true)

	func update_maps(map := ALL_MAPS, all_regions := true, region_map := false) -> void:
		if not all_regions:
			for region in get_regions_active():
				if region.edited:
					if map != CONTROL:
						height_maps_changed.emit()
					if map != HEIGHT:
						control_maps_changed.emit()
			return
		if region_map or map == ALL_MAPS:
			region_map_changed.emit()
		if map != CONTROL:
			height_maps_changed.emit()
		if map != HEIGHT:
			control_maps_changed.emit()
		maps_changed.emit()

	func region_at(at: Vector3) -> Terrain3DRegionDouble:
		var location := Vector2i((Vector2(at.x, at.z) / vertex_spacing / region_size).floor())
		var region: Terrain3DRegionDouble = regions.get(location)
		return null if region == null or region.deleted else region

	func pixel_at(region: Terrain3DRegionDouble, at: Vector3) -> Vector2i:
		var pixel := Vector2i((Vector2(at.x, at.z) / vertex_spacing - Vector2(region.location * region_size)).floor())
		return pixel.clamp(Vector2i.ZERO, Vector2i.ONE * (region_size - 1))

	func get_pixel(map: int, at: Vector3) -> float:
		var region := region_at(at)
		return NAN if region == null else region.maps[map].get_pixelv(pixel_at(region, at)).r

	func set_pixel(map: int, at: Vector3, value: float) -> void:
		var region := region_at(at)
		region.maps[map].set_pixelv(pixel_at(region, at), Color(value, 0.0, 0.0))

	func set_height(at: Vector3, height: float) -> void:
		set_pixel(HEIGHT, at, height)

	func set_control(at: Vector3, bits: int) -> void:
		var region := region_at(at)
		var map := region.maps[CONTROL]
		var pixel := pixel_at(region, at)
		var bytes := map.get_data()
		bytes.encode_u32(4 * (pixel.y * region_size + pixel.x), bits)
		map.set_data(region_size, region_size, false, Image.FORMAT_RF, bytes)

	func get_control(at: Vector3) -> int:
		var region := region_at(at)
		if region == null:
			return 0xffffffff
		var pixel := pixel_at(region, at)
		return region.maps[CONTROL].get_data().decode_u32(4 * (pixel.y * region_size + pixel.x))

	func get_height(at: Vector3) -> float:
		point_calls += 1
		return height_at(at)

	func height_at(at: Vector3) -> float:
		if get_control(at) & HOLE:
			return NAN
		var first := (Vector2(at.x, at.z) / vertex_spacing).floor()
		var part := Vector2(at.x, at.z) / vertex_spacing - first
		var posts: Array[float] = []
		for corner in 4: # The small offset keeps rounding from selecting the previous sample.
			var post := (first + Vector2(corner % 2, floori(corner / 2.0)) + Vector2.ONE * 1e-3) * vertex_spacing
			posts.push_back(get_pixel(HEIGHT, Vector3(post.x, 0.0, post.y)))
		return lerpf(lerpf(posts[0], posts[1], part.x), lerpf(posts[2], posts[3], part.x), part.y)

	func get_normal(at: Vector3) -> Vector3:
		point_calls += 1
		var here := height_at(at)
		var x := here - height_at(at + Vector3(vertex_spacing, 0.0, 0.0))
		var z := here - height_at(at + Vector3(0.0, 0.0, vertex_spacing))
		return Vector3(x, vertex_spacing, z).normalized()

	func get_texture_id(at: Vector3) -> Vector3:
		point_calls += 1
		var control := get_control(at)
		if control & HOLE:
			return Vector3(NAN, NAN, NAN)
		var material: Terrain3DMaterialDouble = terrain.get_material()
		if material.auto and control & AUTO:
			var steep := material.parameters["auto_slope"] * 2.0 * (get_normal(at).y - 1.0) + 1.0
			var blend := clampf(steep - material.parameters["auto_height_reduction"] * 0.01 * height_at(at), 0.0, 1.0)
			return Vector3(material.parameters["auto_base_texture"], material.parameters["auto_overlay_texture"], blend)
		return Vector3(control >> 27 & 31, control >> 22 & 31, (control >> 14 & 255) / 255.0)

	## Returns whether one of the four samples around a position is a hole. Terrain3D's mesh and collider have no ground there.
	func is_open(at: Vector3) -> bool:
		for corner in 4:
			if get_control(at + Vector3(corner % 2, 0.0, floori(corner / 2.0)) * vertex_spacing) & HOLE:
				return true
		return false


class Terrain3DMaterialDouble extends Resource:
	var auto := true
	var parameters: Dictionary[String, float] = {
		"auto_slope": 1.0, "auto_height_reduction": 0.1, "auto_base_texture": 0, "auto_overlay_texture": 1,
	}

	var with_renderer := true ## If false, the material has no shader parameters to query, as in a headless engine.

	## The saved parameters, with StringName keys.
	var _shader_parameters: Dictionary:
		get:
			var saved := {}
			for named in parameters:
				saved[StringName(named)] = parameters[named]
			return saved

	func get_auto_shader_enabled() -> bool:
		return auto

	func get_shader_param(named: StringName) -> Variant:
		return parameters[String(named)] if with_renderer else null


class Terrain3DDouble extends Node3D:
	signal material_changed

	var data: Terrain3DDataDouble
	var material := Terrain3DMaterialDouble.new()
	var vertex_spacing := 1.0:
		set(value):
			vertex_spacing = value
			if data != null:
				data.vertex_spacing = value
	var region_size := 64
	var late := false ## If true, only `make_data` creates the data.

	## Creates the data when the node enters the tree, as Terrain3D does.
	func _enter_tree() -> void:
		if not late:
			make_data()

	func make_data() -> Terrain3DDataDouble:
		if data == null:
			data = Terrain3DDataDouble.new()
			data.terrain = self
			data.vertex_spacing = vertex_spacing
		return data

	func get_material() -> Terrain3DMaterialDouble:
		return material

	func _notification(what: int) -> void:
		if what == NOTIFICATION_PREDELETE and data != null:
			data.free()


## Exposes a Terrain3DDouble's ground as a node of an unknown plugin would, for queries point by point.
class QueriedNode extends Node3D:
	var of: Terrain3DDouble

	func get_height(at: Vector3) -> float:
		return NAN if of.data.is_open(at) else of.data.get_height(at)

	func get_normal(at: Vector3) -> Vector3:
		return of.data.get_normal(at)

	func get_texture_id(at: Vector3) -> Vector3:
		return of.data.get_texture_id(at)


static func hill(post: Vector2i) -> float:
	return 3.0 * sin(0.11 * post.x) + 0.2 * post.y + 1.5 * cos(0.23 * post.y + 0.07 * post.x)


static func fill_region(region: Terrain3DRegionDouble, height := hill) -> void:
	var side := region.maps[HEIGHT].get_width()
	for row in side:
		for column in side:
			region.maps[HEIGHT].set_pixel(column, row, Color(height.call(region.location * side + Vector2i(column, row)), 0, 0))


## Returns a double with four regions around the origin. The node is not in the tree yet.
static func make_terrain3d(spacing := 1.0) -> Terrain3DDouble:
	var node := Terrain3DDouble.new()
	node.vertex_spacing = spacing
	var data := node.make_data()
	for at: Vector2i in [Vector2i(-1, -1), Vector2i(0, -1), Vector2i(-1, 0), Vector2i(0, 0)]:
		var region := Terrain3DRegionDouble.new(at)
		fill_region(region)
		data.add_region(region, false)
	return node


## Returns the number of instances that are not on the double's current ground.
func off_the_ground(scatter: TerrainScatter3D, node: Terrain3DDouble) -> int:
	var wrong := 0
	for one in all_transforms(scatter):
		var height := node.data.height_at(one.origin)
		wrong += int(is_nan(height) or node.data.is_open(one.origin) or absf(height - one.origin.y) > 0.01)
	return wrong


func check_ground(scatter: TerrainScatter3D, node: Terrain3DDouble, context: String) -> void:
	check(scatter.get_stats()["instances"] > 500, "%s: %d instances" % [context, scatter.get_stats()["instances"]])
	check_equal(off_the_ground(scatter, node), 0, context + ": instances off the ground")
