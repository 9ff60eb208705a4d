extends CharacterBody3D
## The player. Walks on the ground of a world, is blocked by its trunks and stones, and finds the tree in the center of
## the view.

## The walking speed in meters per second, and the factor by which Shift makes walking faster.
const WALK_SPEED := 3.0
const FAST_FACTOR := 2.5
const RADIANS_PER_PIXEL := 0.0025
## The distance in meters within which trees are found.
const MAX_DISTANCE := 30.0

## The world to walk in.
@export var world: TerrainScatter3D

## The tree in the center of the view, from [method TerrainScatter3D.query_ray], or null if there is none.
var looked_at: ScatterInstance
## True if the mouse turns the view.
var captured := false

@onready var eyes: Camera3D = $Eyes


func _ready() -> void:
	_stand_on_ground()


func _unhandled_input(event: InputEvent) -> void:
	var motion := event as InputEventMouseMotion
	if motion != null and captured:
		rotation.y -= motion.relative.x * RADIANS_PER_PIXEL
		eyes.rotation.x = clampf(eyes.rotation.x - motion.relative.y * RADIANS_PER_PIXEL, -1.5, 1.5)
	var button := event as InputEventMouseButton
	if button != null and button.pressed and button.button_index == MOUSE_BUTTON_LEFT:
		capture(true)


## Captures the mouse to turn the view, or releases it.
func capture(is_captured: bool) -> void:
	captured = is_captured
	Input.mouse_mode = Input.MOUSE_MODE_CAPTURED if is_captured else Input.MOUSE_MODE_VISIBLE


func _physics_process(_delta: float) -> void:
	var direction := Vector3(_axis(KEY_A, KEY_D) + _axis(KEY_LEFT, KEY_RIGHT), 0.0,
			_axis(KEY_W, KEY_S) + _axis(KEY_UP, KEY_DOWN))
	var speed_factor := FAST_FACTOR if Input.is_physical_key_pressed(KEY_SHIFT) else 1.0
	velocity = Basis(Vector3.UP, rotation.y) * direction.limit_length(1.0) * WALK_SPEED * speed_factor
	if velocity != Vector3.ZERO:
		move_and_slide()
		_stand_on_ground()
	var from := eyes.global_position
	looked_at = world.query_ray(from, from - eyes.global_basis.z * MAX_DISTANCE, world.get(&"TREES"))


## Puts the player back on the ground, because obstacles may have pushed it up or down.
func _stand_on_ground() -> void:
	var ground_height := world.ground.get_height(position)
	if is_finite(ground_height):
		position.y = ground_height


static func _axis(negative: Key, positive: Key) -> float:
	return float(Input.is_physical_key_pressed(positive)) - float(Input.is_physical_key_pressed(negative))
