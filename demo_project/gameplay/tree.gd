extends Node3D
## A tree as a scene. Near the player, the scatter shows it in place of the tree's mesh, and both look the same. A felled
## tree topples over about the cut above its stump, lies for a while, and dissolves.

const FELLED := preload("res://shaders/felled.gdshader")
const Stump := preload("res://meshes/stump.gd")
const GRAVITY := 9.81
## Radians from the vertical at which the fall begins.
const FIRST_LEAN := 0.04
## The share of its speed with which the crown bounces back.
const BOUNCE := 0.22
## The angle in radians by which the crown's branches keep the trunk off the ground.
const CROWN := 0.14
## Seconds that it lies before it dissolves, and seconds that dissolving takes.
const REST := 5.0
const DISSOLVING := 2.5

## The angle from the vertical in radians.
var angle := 0.0
## True once it is at rest.
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


## Makes it look like the instance that it replaces.
func show_as(mesh: Mesh) -> void:
	_body.mesh = mesh


## Makes it fall in a horizontal direction, onto this ground.
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


## Sets the material of a felled tree, with the parameters of the tree's own.
func _wear(standing: ShaderMaterial) -> void:
	_material = standing.duplicate()
	_material.shader = FELLED
	# The scatter sets the time on the renderer. The wind stands still in the falling tree.
	_material.set_shader_parameter(&"wind_time", RenderingServer.material_get_param(standing.get_rid(), &"wind_time"))
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
	# The physics of a rod that rotates about its end.
	_speed += 1.5 * GRAVITY / _height * sin(angle) * delta
	angle += _speed * delta
	if angle > _last_angle:
		angle = _last_angle
		lies = _speed < 0.3
		_speed *= -BOUNCE
	var turn := Transform3D(Basis(_axis, angle), Vector3.ZERO)
	global_transform = Transform3D(Basis.IDENTITY, _hinge) * turn * Transform3D(Basis.IDENTITY, -_hinge) * _standing
