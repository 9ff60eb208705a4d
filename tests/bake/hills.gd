@tool
extends ScatterTerrain
## Rolling ground 200 m around the origin. Where the file user://bad_ground is, it fails east of x = 48, as a terrain does that has a
## fault somewhere: tiles there cannot be made.

const REACH := 200.0


func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
	var heights := PackedFloat32Array()
	var faulty := positions.size() > 20 and FileAccess.file_exists("user://bad_ground")
	for at in positions:
		if faulty and at.x > 48.0:
			return PackedFloat32Array()
		heights.push_back(6.0 * sin(0.05 * at.x) + 4.0 * cos(0.07 * at.y) if at.length() < REACH else NAN)
	return heights


func _is_thread_safe() -> bool:
	return true
