extends "terrain3d_harness.gd"
## Test doubles of terrain plugins. Names, results and limits match the plugins' source files, which each class cites.


## MTerrain, from gdextension/src/mterrain.h and mgrid.h (December 2025). Its grid has one region per 16 x 16 quads. The height samples at the border
## between two regions are stored in the first of them. Outside the grid and in unloaded regions, heights are 0. Holes are NAN. It emits no signals.
class MTerrainDouble extends Node3D:
	const QUADS := 16 ## The number of quads along each axis of a region.
	const REGIONS := 3 ## The number of regions along each axis of the grid.
	const BYTE_UP := Vector3(-1.0 / 255.0, 1.0, -1.0 / 255.0) ## The normal of level ground, from the bytes 127, 255, 127.

	var offset := Vector3(-48.0, 0.0, -40.0)
	var h_scale := 2.0
	var grid_created := true
	var heights := {} ## Heights by sample. For samples without an entry, [method shape] returns the height.
	var loaded: Dictionary[Vector2i, bool] = {}
	var stray_calls := 0 ## The number of calls that would read memory outside the plugin's arrays.
	var on_worker := false

	func _init() -> void:
		for x in REGIONS:
			for y in REGIONS:
				loaded[Vector2i(x, y)] = true

	static func shape(post: Vector2i) -> float:
		return 5.0 + 0.25 * post.x + 2.0 * sin(0.2 * post.y)

	func is_grid_created() -> bool:
		return grid_created

	func get_offset() -> Vector3:
		return offset

	func get_h_scale() -> float:
		return h_scale

	func get_pixel_width() -> int:
		return QUADS * REGIONS + 1

	func get_pixel_height() -> int:
		return QUADS * REGIONS + 1

	func region_of(x: int, y: int) -> Vector2i:
		return Vector2i(x / QUADS - int(x % QUADS == 0 and x != 0), y / QUADS - int(y % QUADS == 0 and y != 0))

	func get_height_by_pixel(x: int, y: int) -> float:
		if x >= get_pixel_width() or y >= get_pixel_height() or not loaded[region_of(x, y)]:
			return 0.0
		return heights.get(Vector2i(x, y), shape(Vector2i(x, y)))

	func get_normal_by_pixel(x: int, y: int) -> Vector3:
		if x < 0 or y < 0 or x >= get_pixel_width() or y >= get_pixel_height():
			stray_calls += 1
			return Vector3.ZERO
		return BYTE_UP if loaded[region_of(x, y)] else Vector3(-1.0, 0.0, -1.0)

	func get_height(at: Vector3) -> float:
		on_worker = on_worker or OS.get_thread_caller_id() != OS.get_main_thread_id()
		if not grid_created:
			return 0.0
		var place := (at - offset) / h_scale
		if place.x < 0.0 or place.z < 0.0:
			return 0.0
		var x := int(place.x)
		var y := int(place.z)
		var top := lerpf(get_height_by_pixel(x, y), get_height_by_pixel(x + 1, y), place.x - x)
		var bottom := lerpf(get_height_by_pixel(x, y + 1), get_height_by_pixel(x + 1, y + 1), place.x - x)
		return lerpf(top, bottom, place.z - y)

	func get_normal(_at: Vector3) -> Vector3:
		stray_calls += 1
		return Vector3.UP

	## Returns the area that has ground, in x and z.
	func area() -> Rect2:
		return Rect2(offset.x, offset.z, QUADS * REGIONS * h_scale, QUADS * REGIONS * h_scale)

	func area_of(region: Vector2i) -> Rect2:
		var side := QUADS * h_scale
		return Rect2(Vector2(offset.x, offset.z) + side * region, Vector2(side, side))


## A zone of TerraBrush, from src/editor_resources/zone_resource.h. Its heightmap has the format RGF. The first channel is the height, and a
## number above 0 in the second channel is a hole.
class ZoneDouble extends Resource:
	var position := Vector2i.ZERO
	var image: Image

	func _init(at: Vector2i, side: int) -> void:
		position = at
		image = Image.create_empty(side, side, false, Image.FORMAT_RGF)

	func get_zonePosition() -> Vector2i:
		return position

	func get_heightMapImage() -> Image:
		return image


class ZonesDouble extends Resource:
	var zones: Array[ZoneDouble] = []

	func get_zones() -> Array[ZoneDouble]:
		return zones


## TerraBrush, from src/terra_brush.cpp and src/misc/zone_utils.cpp (August 2026). Zones begin zonesSize - 1 meters apart and share their
## border. Outside the zones, heights are infinite. Edits emit no signals.
class TerraBrushDouble extends Node3D:
	var zones_size := 65
	var resolution := 1
	var zones: ZonesDouble

	func get_zonesSize() -> int:
		return zones_size

	func get_resolution() -> int:
		return resolution

	func get_terrainZones() -> ZonesDouble:
		return zones

	func image_size() -> int:
		return ceili(float(zones_size) / resolution)

	static func shape(x: float, z: float) -> float:
		return 6.0 + 0.2 * x + 2.0 * sin(0.15 * z)

	## Returns the position of a zone's height sample relative to the node, in x and z.
	func place_of(zone: Vector2i, post: Vector2i) -> Vector2:
		var step := (zones_size - 1.0) / (image_size() - 1.0)
		return (zones_size - 1.0) * (Vector2(zone) - Vector2(0.5, 0.5)) + step * Vector2(post)

	func add_zone(at: Vector2i) -> ZoneDouble:
		var zone := ZoneDouble.new(at, image_size())
		for row in image_size():
			for column in image_size():
				var place := place_of(at, Vector2i(column, row))
				zone.image.set_pixel(column, row, Color(shape(place.x, place.y), 0.0, 0.0))
		if zones == null:
			zones = ZonesDouble.new()
		zones.zones.push_back(zone)
		return zone

	## Returns the height of the nearest sample, as TerraBrush does.
	func getHeightAtPosition(x: float, z: float, use_global: bool) -> float:
		var base := global_position if use_global else Vector3.ZERO
		var place := Vector2(x - base.x, z - base.z) + Vector2.ONE * floori(zones_size / 2.0)
		if zones_size % 2 == 0:
			place -= Vector2(0.5, 0.5)
		var at := Vector2i((place / (zones_size - 1.0)).floor())
		var post := Vector2i(((place / (zones_size - 1.0) - Vector2(at)) * (image_size() - 1.0)).round())
		for zone in zones.zones:
			if zone.position == at:
				return zone.image.get_pixelv(post).r + base.y
		return INF


## godot_voxel's VoxelTerrain, from terrain/fixed_lod/voxel_terrain.cpp and terrain/voxel_mesh_block.cpp (July 2026). Each meshed block of
## 16 x 16 x 16 voxels has a PhysicsServer3D body whose collider is the terrain. Blocks have no nodes.
class VoxelTerrainDouble extends Node3D:
	const SIDE := 16

	var generate_collisions := true
	var collision_layer := 1
	var blocks := {} ## The bodies and shapes of meshed blocks, by the block's position. Arrays are empty for blocks without ground.

	func get_voxel_tool() -> RefCounted:
		return null

	func get_generate_collisions() -> bool:
		return generate_collisions

	func is_area_meshed(area: AABB) -> bool:
		var first := Vector3i((area.position / SIDE).floor())
		var last := Vector3i(((area.end - Vector3.ONE * 1e-3) / SIDE).floor())
		for x in range(first.x, last.x + 1):
			for y in range(first.y, last.y + 1):
				for z in range(first.z, last.z + 1):
					if not blocks.has(Vector3i(x, y, z)):
						return false
		return true

	## Meshes a block that is solid from its bottom up to [param height] meters. If the height is 0, the block is empty.
	func mesh_block(at: Vector3i, height: float) -> void:
		unload_block(at)
		blocks[at] = []
		if height <= 0.0 or not generate_collisions:
			return
		var shape := PhysicsServer3D.box_shape_create()
		PhysicsServer3D.shape_set_data(shape, Vector3(0.5 * SIDE, 0.5 * height, 0.5 * SIDE))
		var body := PhysicsServer3D.body_create()
		PhysicsServer3D.body_set_mode(body, PhysicsServer3D.BODY_MODE_STATIC)
		PhysicsServer3D.body_add_shape(body, shape)
		PhysicsServer3D.body_set_collision_layer(body, collision_layer)
		PhysicsServer3D.body_attach_object_instance_id(body, get_instance_id())
		var middle := SIDE * Vector3(at) + Vector3(0.5 * SIDE, 0.5 * height, 0.5 * SIDE)
		PhysicsServer3D.body_set_state(body, PhysicsServer3D.BODY_STATE_TRANSFORM, global_transform.translated_local(middle))
		PhysicsServer3D.body_set_space(body, get_world_3d().space)
		blocks[at] = [body, shape]

	func unload_block(at: Vector3i) -> void:
		for rid: RID in blocks.get(at, []):
			PhysicsServer3D.free_rid(rid)
		blocks.erase(at)

	func _notification(what: int) -> void:
		if what == NOTIFICATION_PREDELETE:
			for at: Vector3i in blocks.keys():
				unload_block(at)


## The data of Terrain3D with the proposals 1004 and 1006. An unloaded region is no longer in the data.
class StreamedDataDouble extends Terrain3DDataDouble:
	func is_streaming() -> bool:
		return true

	func evict_region(location: Vector2i, _directory: String) -> void:
		regions.erase(location)
		region_map_changed.emit()
		maps_changed.emit()

	func add_region_streamed(region: Terrain3DRegionDouble) -> void:
		regions[region.location] = region
		region_map_changed.emit()
		maps_changed.emit()
		height_maps_changed.emit()


## The data of Terrain3D with the load states of proposal 1006.
class StatefulDataDouble extends StreamedDataDouble:
	var on_disk: Dictionary[Vector2i, bool] = {}

	func get_region_load_state(location: Vector2i) -> int:
		return 0 if regions.has(location) else 1 if on_disk.has(location) else 2


## The data of Terrain3D with proposal 1020.
class UnloadingDataDouble extends Terrain3DDataDouble:
	func unload_region(location: Vector2i) -> void:
		regions.erase(location)
		region_map_changed.emit()
		maps_changed.emit()


class StreamedTerrain3DDouble extends Terrain3DDouble:
	var data_directory := "res://terrain"
	var data_class: GDScript = StreamedDataDouble

	func make_data() -> Terrain3DDataDouble:
		if data == null:
			data = data_class.new()
			data.terrain = self
			data.vertex_spacing = vertex_spacing
		return data


## The data of Terrain3D with proposal 675, which marks unloaded regions as deleted.
class DeletingDataDouble extends Terrain3DDataDouble:
	func get_enable_streaming() -> bool:
		return true

	func evict_region(location: Vector2i) -> void:
		regions[location].deleted = true
		region_map_changed.emit()
		maps_changed.emit()


## godot_voxel's VoxelLodTerrain, which has LODs and bounds, from terrain/variable_lod/voxel_lod_terrain.cpp (July 2026).
class VoxelLodTerrainDouble extends VoxelTerrainDouble:
	var bounds := AABB(Vector3(0.0, 0.0, 0.0), Vector3(64.0, 32.0, 64.0))

	func get_lod_count() -> int:
		return 4

	func get_voxel_bounds() -> AABB:
		return bounds

	func is_area_meshed(area: AABB, lod := -1) -> bool:
		return lod == 0 and super(area)


func names_of(scatter: TerrainScatter3D) -> String:
	return (scatter.ground as ScatterGroundNode).recognized


## Returns the instances above or below a rectangle of x and z.
func within(scatter: TerrainScatter3D, area: Rect2) -> Dictionary:
	var found := {}
	var all := by_id(scatter)
	for id: int in all:
		var at: Vector3 = all[id]
		if area.has_point(Vector2(at.x, at.z)):
			found[id] = all[id]
	return found


func check_on(scatter: TerrainScatter3D, height_at: Callable, area: Rect2, least: int, context: String) -> void:
	var stand := all_transforms(scatter)
	var off := 0
	for one in stand:
		off += int(not area.has_point(Vector2(one.origin.x, one.origin.z)) or not (absf(height_at.call(one.origin) - one.origin.y) < 0.01))
	check(stand.size() >= least, "%s: %d instances" % [context, stand.size()])
	check_equal(off, 0, "%s: instances off the ground" % context)
