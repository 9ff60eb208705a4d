extends Camera3D
## A camera that flies freely or walks on the ground. F switches between the two.

## The walking speed in meters per second, and the factor by which Shift makes walking and flying faster.
const WALK_SPEED := 2.5
const FAST_FACTOR := 4.0
## The height of the camera above the ground while walking, in meters.
const EYE_HEIGHT := 1.75
const RADIANS_PER_PIXEL := 0.0025

## The flying speed in meters per second.
@export_range(1.0, 1000.0, 1.0, "suffix:m/s") var fly_speed := 100.0

## The ground to walk on; it must have [code]height(x, z)[/code].
var elevation: RefCounted
## True while walking.
var walking := false:
	set(value):
		walking = value
		_follow_ground()


func _unhandled_input(event: InputEvent) -> void:
	var motion := event as InputEventMouseMotion
	if motion != null and Input.mouse_mode == Input.MOUSE_MODE_CAPTURED:
		rotation.y -= motion.relative.x * RADIANS_PER_PIXEL
		rotation.x = clampf(rotation.x - motion.relative.y * RADIANS_PER_PIXEL, -1.5, 1.5)
	var button := event as InputEventMouseButton
	if button != null and button.pressed and button.button_index == MOUSE_BUTTON_LEFT:
		Input.mouse_mode = Input.MOUSE_MODE_CAPTURED


func _process(delta: float) -> void:
	var direction := Vector3(
		_axis(KEY_A, KEY_D) + _axis(KEY_LEFT, KEY_RIGHT), _axis(KEY_Q, KEY_E), _axis(KEY_W, KEY_S) + _axis(KEY_UP,
				KEY_DOWN))
	if direction == Vector3.ZERO:
		return
	var speed_factor := FAST_FACTOR if Input.is_physical_key_pressed(KEY_SHIFT) else 1.0
	if walking:
		var step := Basis(Vector3.UP, rotation.y) * Vector3(direction.x, 0.0, direction.z).limit_length(1.0)
		position += step * WALK_SPEED * speed_factor * delta
	else:
		position += (basis * Vector3(direction.x, 0.0,
				direction.z).limit_length(1.0) + Vector3.UP * direction.y) * fly_speed * speed_factor * delta
	_follow_ground()


## Keeps the camera at eye height while walking, and above the ground while flying.
func _follow_ground() -> void:
	if elevation == null:
		return
	var ground_height: float = elevation.height(position.x, position.z)
	if is_nan(ground_height):
		return
	position.y = ground_height + EYE_HEIGHT if walking else maxf(position.y, ground_height + 0.5)


static func _axis(negative: Key, positive: Key) -> float:
	return float(Input.is_physical_key_pressed(positive)) - float(Input.is_physical_key_pressed(negative))
