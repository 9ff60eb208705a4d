@tool
extends HBoxContainer
## The hand tool's settings for planting and moving instances: snapping, alignment with slopes, random values, and the mesh.

const Controls := preload("res://addons/thicket/editor/editor_controls.gd")
const GroundCursor := preload("res://addons/thicket/editor/ground/ground_cursor.gd")
const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

## Emitted when the settings of the next instance have changed.
signal changed

const ANY_MESH := -1

## The check items of the Planting menu.
enum Option { ALIGN, RANDOM_TURN, RANDOM_SIZE }
const OPTION_NAMES: PackedStringArray = ["Lean with the Slope", "Random Turn", "Random Size"]
const OPTION_TIPS: PackedStringArray = [
	"Align planted and moved instances with the slope of the ground.",
	"Give planted instances a random yaw within the range of the layer.",
	"Give planted instances a random scale within the range of the layer.",
]

## The mesh of the next instance, as an index in the layer's meshes.
var mesh := 0

var _snap := CheckBox.new()
var _grid: EditorSpinSlider
var _degrees: EditorSpinSlider
var _options := MenuButton.new()
var _mesh_choice := OptionButton.new()
var _layer: ScatterLayer
var _mesh_count := -1
var _yaw := 0.0
var _scale_factor := 1.0
var _random := RandomNumberGenerator.new()


func _init() -> void:
	_snap.text = "Snap"
	_snap.tooltip_text = "Snap positions to the grid and rotations to steps; hold Ctrl to invert."
	_snap.toggled.connect(func(_on: bool) -> void: changed.emit())
	add_child(_snap)
	_grid = Controls.slider("Grid", "The step of the grid in meters, along x and z. Planets have no grid.", Vector3(0.05, 64.0, 0.05), 1.0, "m", 88.0)
	add_child(_grid)
	_degrees = Controls.slider("Turn", "The rotation step in degrees (key R; Shift+R rotates back).", Vector3(1.0, 180.0, 1.0), 15.0, "°", 88.0)
	add_child(_degrees)
	_options.text = "Planting"
	_options.tooltip_text = "Random values for planted instances, and alignment with the slope."
	_options.get_popup().hide_on_checkable_item_selection = false
	for option in OPTION_NAMES.size():
		_options.get_popup().add_check_item(OPTION_NAMES[option])
		_options.get_popup().set_item_tooltip(option, OPTION_TIPS[option])
		_options.get_popup().set_item_checked(option, option != Option.ALIGN)
	_options.get_popup().index_pressed.connect(func(option: int) -> void: _set_option(option, not _has_option(option)))
	add_child(_options)
	_mesh_choice.tooltip_text = "The mesh to plant. Random picks meshes by their weights in the layer."
	_mesh_choice.item_selected.connect(func(_index: int) -> void: roll(); changed.emit())
	add_child(_mesh_choice)


## Sets whether to snap to the grid, whether to align with slopes, and whether the rotation and the size are random.
func choose(snap: bool, align: bool, random_turn: bool, random_size: bool) -> void:
	_snap.button_pressed = snap
	_set_option(Option.ALIGN, align)
	_set_option(Option.RANDOM_TURN, random_turn)
	_set_option(Option.RANDOM_SIZE, random_size)
	_yaw = 0.0
	_scale_factor = 1.0
	roll()


## Sets the snap steps in meters and degrees.
func set_steps(grid: float, degrees: float) -> void:
	_grid.value = grid
	_degrees.value = degrees


## Sets the layer to plant, and the number of its meshes.
func set_layer(layer: ScatterLayer, mesh_count: int) -> void:
	if layer == _layer and mesh_count == _mesh_count:
		return
	_layer = layer
	_mesh_count = mesh_count
	_mesh_choice.clear()
	_mesh_choice.add_item("Any Mesh", ANY_MESH + 1)
	for index in mesh_count:
		_mesh_choice.add_item("Mesh %d" % index, index + 1)
	_mesh_choice.visible = mesh_count > 1
	roll()


## Chooses the random values of the next instance.
func roll() -> void:
	if _layer == null:
		return
	if _has_option(Option.RANDOM_TURN):
		_yaw = deg_to_rad(_random.randf_range(_layer.min_yaw_degrees, _layer.max_yaw_degrees))
	if _has_option(Option.RANDOM_SIZE):
		_scale_factor = _random.randf_range(_layer.min_scale, _layer.max_scale)
	mesh = _mesh_choice.get_selected_id() - 1
	if mesh == ANY_MESH:
		var weights := _layer.mesh_weights
		weights.resize(maxi(1, _mesh_count))
		for index in range(_layer.mesh_weights.size(), weights.size()):
			weights[index] = 1.0
		mesh = maxi(0, _random.rand_weighted(weights))


func turn(angle: float) -> void:
	_yaw += angle


func scale_by(factor: float) -> void:
	_scale_factor = clampf(_scale_factor * factor, 0.01, 100.0)


## Returns the rotation step in radians.
func turn_step() -> float:
	return deg_to_rad(_degrees.value)


## Returns true if positions and rotations snap. Ctrl inverts the setting.
func snaps(with_control: bool) -> bool:
	return _snap.button_pressed != with_control


## Returns an angle in radians, rounded to whole steps if snapping is on.
func snapped_turn(angle: float, with_control: bool) -> float:
	return snappedf(angle, turn_step()) if snaps(with_control) else angle


## Returns a scale factor for a basis. If snapping is on, the resulting scale is a multiple of 0.1.
func snapped_size(basis: Basis, factor: float, with_control: bool) -> float:
	var height := basis.y.length()
	return snappedf(height * factor, 0.1) / height if snaps(with_control) and height > 0.0 else factor


## Returns the transform of an instance that is planted at the position of a cursor on the ground of a scatter.
func transform_at(cursor: GroundCursor, scatter: TerrainScatter3D, with_control: bool) -> Transform3D:
	var point := cursor.on_ground
	var normal := cursor.normal
	var up := SurfacePlace.up_at(scatter, point)
	if _uses_grid(scatter, with_control):
		var level_direction := -up if normal.dot(up) < 0.0 else up
		var level := SurfacePlace.level(scatter, _snapped_to_grid(point), level_direction)
		point = level[0] if not level.is_empty() else _snapped_to_grid(point)
		normal = level[1] if not level.is_empty() else normal
	var instance_up := normal.normalized() if _has_option(Option.ALIGN) and _is_direction(normal) else up
	var basis := SurfacePlace.upright(instance_up) * Basis(Vector3.UP, _yaw)
	point += SurfacePlace.up_at(scatter, point) * _layer.height_offset + instance_up * _layer.offset_along_normal
	return Transform3D(basis * Basis.from_scale(Vector3.ONE * _scale_factor), point)


## Returns the transform of an instance after moving it to the ground straight above or below a position. It keeps its height above the
## ground. On a planet, it rotates with the up direction.
func moved_transform(start: Transform3D, point: Vector3, scatter: TerrainScatter3D, with_control: bool) -> Transform3D:
	var up := SurfacePlace.up_at(scatter, start.origin)
	var start_level := SurfacePlace.level(scatter, start.origin, up)
	var target := _snapped_to_grid(point) if _uses_grid(scatter, with_control) else point
	var target_level := SurfacePlace.level(scatter, target, SurfacePlace.up_at(scatter, target))
	if start_level.is_empty() or target_level.is_empty():
		var is_planet := SurfacePlace.is_planet(scatter)
		return start if is_planet else Transform3D(start.basis, Vector3(target.x, start.origin.y, target.z))
	var target_up := SurfacePlace.up_at(scatter, target_level[0])
	var target_position := target_level[0] + target_up * (start.origin - start_level[0]).dot(up)
	var aligns_normals := _has_option(Option.ALIGN) and _is_direction(start_level[1]) and _is_direction(target_level[1])
	var tilt := Quaternion(start_level[1].normalized(), target_level[1].normalized()) if aligns_normals else Quaternion(up, target_up)
	return Transform3D(Basis(tilt) * start.basis if tilt != Quaternion.IDENTITY else start.basis, target_position)


## Returns true if positions snap to the grid, which a planet does not have.
func _uses_grid(scatter: TerrainScatter3D, with_control: bool) -> bool:
	return snaps(with_control) and not SurfacePlace.is_planet(scatter)


func _snapped_to_grid(point: Vector3) -> Vector3:
	return Vector3(snappedf(point.x, _grid.value), point.y, snappedf(point.z, _grid.value))


static func _is_direction(normal: Vector3) -> bool:
	return normal.is_finite() and normal != Vector3.ZERO


func _has_option(option: Option) -> bool:
	return _options.get_popup().is_item_checked(option)


func _set_option(option: Option, on: bool) -> void:
	_options.get_popup().set_item_checked(option, on)
	roll()
	changed.emit()
