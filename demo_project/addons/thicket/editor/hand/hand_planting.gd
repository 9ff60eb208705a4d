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
enum Way { ALIGN, RANDOM_TURN, RANDOM_SIZE }
const WAY_NAMES: PackedStringArray = ["Lean with the Slope", "Random Turn", "Random Size"]
const WAY_TIPS: PackedStringArray = [
	"Align planted and moved instances with the slope of the ground.",
	"Give planted instances a random yaw within the range of the layer.",
	"Give planted instances a random scale within the range of the layer.",
]

## The mesh of the next instance, as an index in the layer's meshes.
var mesh := 0

var _snap := CheckBox.new()
var _grid: EditorSpinSlider
var _degrees: EditorSpinSlider
var _ways := MenuButton.new()
var _choice := OptionButton.new()
var _layer: ScatterLayer
var _mesh_count := -1
var _yaw := 0.0
var _size := 1.0
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
	_ways.text = "Planting"
	_ways.tooltip_text = "Random values for planted instances, and alignment with the slope."
	_ways.get_popup().hide_on_checkable_item_selection = false
	for way in WAY_NAMES.size():
		_ways.get_popup().add_check_item(WAY_NAMES[way])
		_ways.get_popup().set_item_tooltip(way, WAY_TIPS[way])
		_ways.get_popup().set_item_checked(way, way != Way.ALIGN)
	_ways.get_popup().index_pressed.connect(func(way: int) -> void: _choose_way(way, not _is_way(way)))
	add_child(_ways)
	_choice.tooltip_text = "The mesh to plant. Random picks meshes by their weights in the layer."
	_choice.item_selected.connect(func(_index: int) -> void: roll(); changed.emit())
	add_child(_choice)


## Sets whether to snap to the grid, whether to align with slopes, and whether the rotation and the size are random.
func choose(snap: bool, align: bool, random_turn: bool, random_size: bool) -> void:
	_snap.button_pressed = snap
	_choose_way(Way.ALIGN, align)
	_choose_way(Way.RANDOM_TURN, random_turn)
	_choose_way(Way.RANDOM_SIZE, random_size)
	_yaw = 0.0
	_size = 1.0
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
	_choice.clear()
	_choice.add_item("Any Mesh", ANY_MESH + 1)
	for index in mesh_count:
		_choice.add_item("Mesh %d" % index, index + 1)
	_choice.visible = mesh_count > 1
	roll()


## Chooses the random values of the next instance.
func roll() -> void:
	if _layer == null:
		return
	if _is_way(Way.RANDOM_TURN):
		_yaw = deg_to_rad(_random.randf_range(_layer.min_yaw_degrees, _layer.max_yaw_degrees))
	if _is_way(Way.RANDOM_SIZE):
		_size = _random.randf_range(_layer.min_scale, _layer.max_scale)
	mesh = _choice.get_selected_id() - 1
	if mesh == ANY_MESH:
		var weights := _layer.mesh_weights
		weights.resize(maxi(1, _mesh_count))
		for index in range(_layer.mesh_weights.size(), weights.size()):
			weights[index] = 1.0
		mesh = maxi(0, _random.rand_weighted(weights))


func turn(angle: float) -> void:
	_yaw += angle


func scale_by(factor: float) -> void:
	_size = clampf(_size * factor, 0.01, 100.0)


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
	var size := basis.y.length()
	return snappedf(size * factor, 0.1) / size if snaps(with_control) and size > 0.0 else factor


## Returns the transform of an instance that is planted at the position of a cursor on the ground of a scatter.
func transform_at(cursor: GroundCursor, scatter: TerrainScatter3D, with_control: bool) -> Transform3D:
	var at := cursor.on_ground
	var normal := cursor.normal
	var above := SurfacePlace.up_at(scatter, at)
	if _uses_grid(scatter, with_control):
		var along := -above if normal.dot(above) < 0.0 else above
		var found := SurfacePlace.level(scatter, _on_grid(at), along)
		at = found[0] if not found.is_empty() else _on_grid(at)
		normal = found[1] if not found.is_empty() else normal
	var up := normal.normalized() if _is_way(Way.ALIGN) and _is_direction(normal) else above
	var basis := SurfacePlace.upright(up) * Basis(Vector3.UP, _yaw)
	at += SurfacePlace.up_at(scatter, at) * _layer.height_offset + up * _layer.offset_along_normal
	return Transform3D(basis * Basis.from_scale(Vector3.ONE * _size), at)


## Returns the transform of an instance that is moved to the ground straight above or below a position. The instance keeps its height above the
## ground. On a planet, it rotates with the up direction.
func moved(from: Transform3D, point: Vector3, scatter: TerrainScatter3D, with_control: bool) -> Transform3D:
	var up := SurfacePlace.up_at(scatter, from.origin)
	var below := SurfacePlace.level(scatter, from.origin, up)
	var target := _on_grid(point) if _uses_grid(scatter, with_control) else point
	var found := SurfacePlace.level(scatter, target, SurfacePlace.up_at(scatter, target))
	if below.is_empty() or found.is_empty():
		var is_planet := SurfacePlace.is_planet(scatter)
		return from if is_planet else Transform3D(from.basis, Vector3(target.x, from.origin.y, target.z))
	var up_there := SurfacePlace.up_at(scatter, found[0])
	var to := found[0] + up_there * (from.origin - below[0]).dot(up)
	var aligns := _is_way(Way.ALIGN) and _is_direction(below[1]) and _is_direction(found[1])
	var turn := Quaternion(below[1].normalized(), found[1].normalized()) if aligns else Quaternion(up, up_there)
	return Transform3D(Basis(turn) * from.basis if turn != Quaternion.IDENTITY else from.basis, to)


## Returns true if positions snap to the grid, which a planet does not have.
func _uses_grid(scatter: TerrainScatter3D, with_control: bool) -> bool:
	return snaps(with_control) and not SurfacePlace.is_planet(scatter)


func _on_grid(point: Vector3) -> Vector3:
	return Vector3(snappedf(point.x, _grid.value), point.y, snappedf(point.z, _grid.value))


static func _is_direction(normal: Vector3) -> bool:
	return normal.is_finite() and normal != Vector3.ZERO


func _is_way(way: Way) -> bool:
	return _ways.get_popup().is_item_checked(way)


func _choose_way(way: Way, on: bool) -> void:
	_ways.get_popup().set_item_checked(way, on)
	roll()
	changed.emit()
