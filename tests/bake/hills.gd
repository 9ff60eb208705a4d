@tool
extends ScatterGround
## A ground of rolling hills within 200 m of the origin. The content of the file user://ground makes large requests fail or slow. With "bad", requests
## fail if a position is east of x = 48, like a terrain with a local fault. With "slow", they take 15 ms longer.

const REACH := 200.0


func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
	var heights := PackedFloat32Array()
	var manner := FileAccess.get_file_as_string("user://ground") if positions.size() > 20 and FileAccess.file_exists("user://ground") else ""
	if manner == "slow":
		OS.delay_msec(15)
	for at in positions:
		if manner == "bad" and at.x > 48.0:
			return PackedFloat32Array()
		heights.push_back(6.0 * sin(0.05 * at.x) + 4.0 * cos(0.07 * at.y) if at.length() < REACH else NAN)
	return heights


func _is_thread_safe() -> bool:
	return true
