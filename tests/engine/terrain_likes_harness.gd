extends "terrain_harness.gd"
## Nodes with the methods of Terrain3D or HTerrain but without their images, as unknown versions might be. The library queries them point by
## point. One more node only has heights.

## Behaves like Terrain3D's data, with heights, normals, a round hole, a different texture blend in each half, and edit signals.
class Terrain3DLikeData extends Object:
	signal maps_edited(area: AABB)
	signal maps_changed
	var lift := 0.0

	func is_hole(at: Vector3) -> bool:
		return Vector2(at.x, at.z).length() < 12.0 or absf(at.x) > 100.0

	func get_height(at: Vector3) -> float:
		return NAN if is_hole(at) else lift + 0.2 * at.x + 3.0 * sin(at.z * 0.1)

	func get_normal(at: Vector3) -> Vector3:
		return Vector3(NAN, NAN, NAN) if is_hole(at) else Vector3(-0.2, 1.0, -0.3 * cos(at.z * 0.1)).normalized()

	func get_texture_id(at: Vector3) -> Vector3:
		return Vector3(NAN, NAN, NAN) if is_hole(at) else Vector3(0.0, 3.0, 0.25 if at.x < 0.0 else 1.0)


class Terrain3DLike extends Node3D:
	var data := Terrain3DLikeData.new()

	func _notification(what: int) -> void:
		if what == NOTIFICATION_EXIT_TREE:
			data.free()


## Behaves like a Terrain3D node whose samples are 4 m apart.
class SparseTerrain3DLike extends Terrain3DLike:
	var vertex_spacing := 4.0


## Behaves like HTerrain's data: heights on a pixel grid. Queries use pixel coordinates, clamped at the border.
class HTerrainLikeData extends Resource:
	signal region_changed(x: int, y: int, w: int, h: int, channel: int)
	const SIZE := 65
	const CHANNEL_SPLAT := 2
	const CHANNEL_COLOR := 3
	var lift := 0.0
	var maps := {}

	func get_map_count(map_type: int) -> int:
		return maps[map_type].size() if maps.has(map_type) else 0

	func get_image(map_type: int, index := 0) -> Image:
		return maps[map_type][index]

	func get_resolution() -> int:
		return SIZE

	func get_interpolated_height_at(at: Vector3) -> float:
		return lift + 0.5 * clampf(at.x, 0.0, SIZE - 1.0)


## Data that reports edits like HTerrain since July 2026.
class LaterHTerrainLikeData extends Resource:
	signal region_changed(rect: Rect2i, channel: int, index: int)
	var lift := 7.0

	func get_map_count(_map_type: int) -> int:
		return 0

	func get_resolution() -> int:
		return HTerrainLikeData.SIZE

	func get_interpolated_height_at(at: Vector3) -> float:
		return lift + 0.5 * clampf(at.x, 0.0, HTerrainLikeData.SIZE - 1.0)


class HTerrainLike extends Node3D:
	signal transform_changed(to: Transform3D)
	var map_scale := Vector3(2.0, 3.0, 2.0)
	var _data: Resource = HTerrainLikeData.new()

	func get_data() -> Resource:
		return _data

	func get_internal_transform() -> Transform3D:
		var half := Vector3(0.5 * (HTerrainLikeData.SIZE - 1.0), 0.0, 0.5 * (HTerrainLikeData.SIZE - 1.0))
		var made := Transform3D(global_transform.basis * Basis().scaled(map_scale), global_position)
		made.origin += made.basis * -half
		return made


## A node with heights only. Records whether a thread other than the main thread called it.
class Slope extends Node3D:
	var rise := 1.0
	var called_on_worker := false

	func get_height(at: Vector3) -> float:
		if OS.get_thread_caller_id() != OS.get_main_thread_id():
			called_on_worker = true
		return rise * at.x
