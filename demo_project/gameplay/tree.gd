extends Node3D
## A tree as a scene. Near the player the scatter shows it in the place of the tree's mesh, from which it cannot be told;
## felled, it topples over about the cut above its stump, lies for a while, and dissolves.

const FELLED := preload("res://shaders/felled.gdshader")
const Stump := preload("res://meshes/stump.gd")
const GRAVITY := 9.81
## Radians from the vertical at which the fall begins.
const FIRST_LEAN := 0.04
## The share of its speed with which the crown springs back.
const BOUNCE := 0.22
## Radians by which the crown's branches keep the trunk off the ground.
const CROWN := 0.14
## Seconds that it lies before it dissolves, and that this takes.
const REST := 5.0
const DISSOLVING := 2.5

## Radians from the vertical.
var angle := 0.0
## True once it has come to rest.
var lies := false

var _speed := 0.0
var _axis := Vector3.ZERO
var _last_angle := 0.0
var _height := 0.0
var _hinge := Vector3.ZERO
var _standing := Transform3D.IDENTITY
var _lying := 0.0
var _material: ShaderMaterial

@onready var _body: MeshInstance3D = $Body


func _ready() -> void:
	set_physics_process(false)


## Makes it look as the instance it stands for.
func show_as(mesh: Mesh) -> void:
	_body.mesh = mesh


## Fells it towards a direction in the plane, onto this ground.
func fall(direction: Vector3, ground: ScatterGround) -> void:
	_standing = global_transform
	_hinge = _standing * (Vector3.UP * Stump.HEIGHT)
	_height = _body.get_aabb().end.y * _standing.basis.get_scale().y
	_axis = Vector3.UP.cross(direction).normalized()
	var crown := _hinge + direction * _height * 0.7
	var rise := ground.get_height(crown) - _hinge.y
	_last_angle = PI * 0.5 - (atan2(rise, _height * 0.7) if is_finite(rise) else 0.0) - CROWN
	angle = FIRST_LEAN
	_wear(_body.mesh.surface_get_material(0) as ShaderMaterial)
	set_physics_process(true)


## The material of a felled tree, with all else as it was.
func _wear(standing: ShaderMaterial) -> void:
	_material = standing.duplicate()
	_material.shader = FELLED
	_material.set_shader_parameter(&"rooted", _standing.origin)
	_material.set_shader_parameter(&"cut_height", Stump.HEIGHT)
	_body.material_override = _material


func _physics_process(delta: float) -> void:
	if lies:
		_lying += delta
		_material.set_shader_parameter(&"dissolved", (_lying - REST) / DISSOLVING)
		if _lying > REST + DISSOLVING:
			queue_free()
		return
	# A rod that turns about its end.
	_speed += 1.5 * GRAVITY / _height * sin(angle) * delta
	angle += _speed * delta
	if angle > _last_angle:
		angle = _last_angle
		lies = _speed < 0.3
		_speed *= -BOUNCE
	var turn := Transform3D(Basis(_axis, angle), Vector3.ZERO)
	global_transform = Transform3D(Basis.IDENTITY, _hinge) * turn * Transform3D(Basis.IDENTITY, -_hinge) * _standing
