extends Node3D
## A tree as a scene, which replaces the tree's mesh near the player and looks the same. A felled tree topples over at the cut above its stump, lies
## for a while, and dissolves.

const FELLED := preload("res://shaders/felled.gdshader")
const Stump := preload("res://meshes/stump.gd")
const GRAVITY := 9.81
## The angle from the vertical at which the fall begins, in radians.
const FIRST_LEAN := 0.04
## The fraction of its speed that remains when the crown bounces off the ground.
const BOUNCE := 0.22
## The angle in radians between the ground and the lying trunk, whose end rests on the crown's branches.
const CROWN_ANGLE := 0.14
## The time that the tree lies before it dissolves, and the duration of dissolving, in seconds.
const REST_SECONDS := 5.0
const DISSOLVE_SECONDS := 2.5

## The angle from the vertical in radians.
var angle := 0.0
## True once the tree is at rest.
var lies := false

var _speed := 0.0
var _axis := Vector3.ZERO
var _last_angle := 0.0
var _height := 0.0
var _hinge := Vector3.ZERO
var _standing_transform := Transform3D.IDENTITY
var _lying_seconds := 0.0
var _material: ShaderMaterial

@onready var _body: MeshInstance3D = $Body


func _ready() -> void:
	set_physics_process(false)


## Shows the mesh of the instance that the scene replaces.
func show_as(mesh: Mesh) -> void:
	_body.mesh = mesh


## Makes the tree fall onto a ground in a horizontal direction, a vector with a length of 1.
func fall(direction: Vector3, ground: ScatterGround) -> void:
	_standing_transform = global_transform
	_hinge = _standing_transform * (Vector3.UP * Stump.HEIGHT)
	_height = _body.get_aabb().end.y * _standing_transform.basis.get_scale().y
	_axis = Vector3.UP.cross(direction).normalized()
	var crown := _hinge + direction * _height * 0.7
	var rise := ground.get_height(crown) - _hinge.y
	_last_angle = PI * 0.5 - (atan2(rise, _height * 0.7) if is_finite(rise) else 0.0) - CROWN_ANGLE
	angle = FIRST_LEAN
	_wear(_body.mesh.surface_get_material(0) as ShaderMaterial)
	set_physics_process(true)


## Sets the material of a felled tree, with the parameters of the standing tree's material.
func _wear(standing_material: ShaderMaterial) -> void:
	_material = standing_material.duplicate()
	_material.shader = FELLED
	# Reads the wind time from the RenderingServer, where the scatter sets it. The value does not change after that, so
	# the wind stops in the falling tree.
	_material.set_shader_parameter(&"wind_time", RenderingServer.material_get_param(standing_material.get_rid(), &"wind_time"))
	_material.set_shader_parameter(&"rooted", _standing_transform.origin)
	_material.set_shader_parameter(&"cut_height", Stump.HEIGHT)
	_body.material_override = _material


func _physics_process(delta: float) -> void:
	if lies:
		_lying_seconds += delta
		_material.set_shader_parameter(&"dissolved", (_lying_seconds - REST_SECONDS) / DISSOLVE_SECONDS)
		if _lying_seconds > REST_SECONDS + DISSOLVE_SECONDS:
			queue_free()
		return
	# The equation of motion of a rod that rotates about its end.
	_speed += 1.5 * GRAVITY / _height * sin(angle) * delta
	angle += _speed * delta
	if angle > _last_angle:
		angle = _last_angle
		lies = _speed < 0.3
		_speed *= -BOUNCE
	var rotation_about_hinge := Transform3D(Basis(_axis, angle), Vector3.ZERO)
	global_transform = Transform3D(Basis.IDENTITY, _hinge) * rotation_about_hinge * Transform3D(Basis.IDENTITY, -_hinge) * _standing_transform
