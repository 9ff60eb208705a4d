extends "harness.gd"
## Base class for the streaming tests. Provides grounds implemented in GDScript, and the transforms of all visible instances.

## Rolling hills that only the main thread samples.
class Hills extends ScatterGround:
	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(height(at))
		return heights

	static func height(at: Vector2) -> float:
		return 10.0 * sin(at.x * 0.05) + 5.0 * cos(at.y * 0.08)


## Rolling hills that worker threads sample.
class ThreadedHills extends Hills:
	func _is_thread_safe() -> bool:
		return true


## Rolling hills with a hole, and with constant normals tilted by 45 degrees.
class LeaningHills extends Hills:
	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := super(positions)
		for index in positions.size():
			if positions[index].length() < 10.0:
				heights[index] = NAN
		return heights

	func _get_normals(positions: PackedVector2Array) -> PackedVector3Array:
		var normals := PackedVector3Array()
		normals.resize(positions.size())
		normals.fill(Vector3(3.0, 3.0, 0.0))
		return normals


## A slope of 45 degrees that ends at x = 0.
class Cliff extends ScatterGround:
	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(at.x if at.x < 0.0 else NAN)
		return heights


func all_transforms(scatter: TerrainScatter3D, layer: int) -> Array[Transform3D]:
	var result: Array[Transform3D] = []
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
		result.append_array(transforms(scatter, layer, tile))
	return result
