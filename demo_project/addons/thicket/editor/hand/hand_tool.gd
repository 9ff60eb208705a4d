@tool
extends "res://addons/thicket/editor/ground/ground_tool.gd"
## The hand tool: plants, moves, rotates, scales and deletes single instances of the chosen layer.

const HandEdits := preload("res://addons/thicket/editor/hand/hand_edits.gd")
const HandFrame := preload("res://addons/thicket/editor/hand/hand_frame.gd")
const HandPlanting := preload("res://addons/thicket/editor/hand/hand_planting.gd")
const InstanceGhost := preload("res://addons/thicket/editor/hand/instance_ghost.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

const SIZE_STEP := 1.1
const MIN_SIZE := 0.01
## The distance in pixels that the mouse must move before a click becomes a drag.
const DRAG_THRESHOLD := 4.0
## The largest distance at which instances can be picked, and the farthest that one drag can move an instance,
## in meters.
const MAX_DISTANCE := 1000.0
const HINT_PLANTING := "Click plants   R turns   [ ] scale   Ctrl snaps"
const HINT_HOVERED := "Click selects   Shift+click plants here"
const HINT_SELECTED := "Drag moves   R turns   [ ] scale   Ctrl snaps   Del deletes   Esc deselects"

var edits := HandEdits.new()
## The settings of the next instance.
var planting := HandPlanting.new()
## The id of the selected instance, or 0 if there is none.
var selected := 0

var _ghost := InstanceGhost.new()
var _frame := HandFrame.new()
var _hovered := 0
var _meshes: Array[Mesh] = []

# The state of the mouse button from a press on the selected instance until its release.
var _is_pressed := false
var _is_dragging := false
var _handle := HandFrame.Handle.NONE
var _press_position := Vector2.ZERO
var _grab_point := Vector3.ZERO
var _start_frame := HandFrame.new()


func _init() -> void:
	_setup("Hand", &"ToolMove", "Hand: plant, move, rotate, scale and delete single instances, with the left mouse button.")
	add_child(planting)
	planting.changed.connect(redraw_requested.emit)


func _on_motion(motion: InputEventMouseMotion) -> int:
	if _is_pressed:
		_drag(motion)
		return MINE
	_hover(motion)
	return NOT_MINE


func _on_button(click: InputEventMouseButton) -> void:
	if not click.pressed:
		_release()
	else:
		problem = _press(click)
	_hover(click)


func _draw_view(overlay: Control) -> void:
	if _hovered != 0 and _hovered != selected and not _is_pressed:
		var frame := _frame_of(_hovered)
		if frame != null:
			frame.draw_box(overlay, _cursor, HandFrame.HOVERED, 1.0)
	if selected != 0:
		_frame.draw_box(overlay, _cursor, HandFrame.SELECTED, 2.0)
		_frame.draw_handles(overlay, _cursor)
	_cursor.draw_hint(overlay, HINT_SELECTED if selected != 0 else HINT_HOVERED if _hovered != 0 else HINT_PLANTING)


## Updates the meshes of the chosen layer and the selected instance, both of which may have been changed elsewhere
## or by undo.
func refresh() -> void:
	if not is_on() or layer == null or ground() == null:
		_ghost.hide()
		return
	var instances := scatter.build_rect(layer, Rect2(0.0, 0.0, 0.01, 0.01))
	_meshes.clear()
	for mesh in instances.get_mesh_count():
		_meshes.append(instances.get_mesh(mesh))
	planting.set_layer(layer, _meshes.size())
	if selected != 0 and not _is_pressed:
		var last_transform := _frame.transform
		_select(selected)
		if selected == 0 or last_transform != _frame.transform:
			redraw_requested.emit()


func finish() -> void:
	_release()
	_select(0)
	_hovered = 0
	_ghost.hide()


func _on_toggled() -> void:
	super()
	refresh()


func _on_key(key: InputEventKey) -> int:
	if not key.pressed or key.ctrl_pressed or key.alt_pressed or key.meta_pressed or Input.is_mouse_button_pressed(MOUSE_BUTTON_RIGHT):
		return NOT_MINE
	match key.keycode:
		# The tool handles both keys even without a selection, because the editor would deselect or delete the scatter.
		KEY_ESCAPE:
			_cancel()
		KEY_DELETE:
			_delete()
		KEY_R:
			_turn(-planting.turn_step() if key.shift_pressed else planting.turn_step())
		KEY_BRACKETLEFT:
			_scale(1.0 / SIZE_STEP)
		KEY_BRACKETRIGHT:
			_scale(SIZE_STEP)
		_:
			return NOT_MINE
	_take_key()
	_show_ghost()
	return MINE


## Returns the reason why instances cannot be changed, as a sentence, or an empty string.
func _edit_problem() -> String:
	if ground() == null:
		return _ground_problem("plant on")
	if layer == null:
		return "There is nothing to plant: add a layer to %s in the Scatter panel." % scatter.name
	return ""


func _press(mouse: InputEventMouseButton) -> String:
	_is_pressed = false
	var edit_problem := _edit_problem()
	if not edit_problem.is_empty():
		return edit_problem
	_handle = _frame.handle_at(_cursor, _cursor.mouse()) if selected != 0 else HandFrame.Handle.NONE
	if _handle == HandFrame.Handle.NONE:
		var picked_id := 0 if mouse.shift_pressed else _pick()
		if picked_id == 0:
			return _plant(mouse.ctrl_pressed)
		_select(picked_id)
	_is_pressed = true
	_is_dragging = false
	_press_position = _cursor.mouse()
	_start_frame.transform = _frame.transform
	_start_frame.box = _frame.box
	_grab_point = _on_plane(_start_frame.transform.origin, SurfacePlace.up_at(scatter, _start_frame.transform.origin), _cursor.on_ground)
	return ""


func _plant(with_control: bool) -> String:
	if not _cursor.on_ground.is_finite():
		return NO_GROUND_BELOW
	if not edits.begin(scatter, SceneFiles.edited_scene_path()):
		return edits.problem
	var id := edits.add(layer, planting.transform_at(_cursor, scatter, with_control), planting.mesh)
	edits.commit("Plant %s" % layer.resource_name)
	if id == 0:
		return "No instance of %s was planted. See the Output panel for details." % layer.resource_name
	planting.roll()
	_select(id)
	return ""


func _drag(mouse: InputEventMouse) -> void:
	if not _is_dragging:
		if _cursor.mouse().distance_to(_press_position) < DRAG_THRESHOLD:
			return
		if not edits.begin(scatter, SceneFiles.edited_scene_path()):
			problem = edits.problem
			_is_pressed = false
			return
		_is_dragging = true
	var new_transform := _start_frame.transform
	match _handle:
		HandFrame.Handle.TURN:
			var axis := _start_frame.up()
			var handle_direction := _on_plane(new_transform.origin, axis, _start_frame.handle_position(_handle)) - new_transform.origin
			var angle := (_start_frame.handle_position(_handle) - new_transform.origin).signed_angle_to(handle_direction, axis)
			new_transform.basis = Basis(axis, planting.snapped_turn(angle, mouse.ctrl_pressed)) * new_transform.basis
		HandFrame.Handle.SCALE:
			var center := _cursor.to_overlay(new_transform.origin)
			var factor := center.distance_to(_cursor.mouse()) / maxf(1.0, center.distance_to(_press_position))
			new_transform.basis *= _scale_basis(planting.snapped_size(new_transform.basis, factor, mouse.ctrl_pressed), new_transform.basis)
		_:
			if not _grab_point.is_finite():
				return
			var up := SurfacePlace.up_at(scatter, _grab_point)
			var offset := (_on_plane(_grab_point, up, _grab_point) - _grab_point).limit_length(MAX_DISTANCE)
			new_transform = planting.moved_transform(new_transform, new_transform.origin + offset, scatter, mouse.ctrl_pressed)
	_set_transform(new_transform)


## Changes the transform of the selected instance, within the open step.
func _set_transform(transform: Transform3D) -> void:
	var id := edits.set_transform(selected, transform)
	if id != 0:
		selected = id
		_frame.transform = transform
	else:
		problem = "The instance was not changed. See the Output panel for details."


func _release() -> void:
	if _is_pressed and _is_dragging:
		edits.commit("%s %s" % [["Move", "Turn", "Scale"][_handle], layer.resource_name if layer != null else "Instance"])
	_is_pressed = false
	_is_dragging = false


func _cancel() -> void:
	if _is_pressed and _is_dragging:
		edits.abort()
	_is_pressed = false
	_is_dragging = false
	_select(0)


func _delete() -> void:
	if selected == 0 or _is_pressed:
		return
	problem = ""
	if not edits.begin(scatter, SceneFiles.edited_scene_path()):
		problem = edits.problem
		return
	edits.remove(selected)
	edits.commit("Delete %s" % layer.resource_name)
	_select(0)
	_hovered = 0


## Rotates the selected instance by an angle in radians. If no instance is selected, rotates the next one to plant.
func _turn(angle: float) -> void:
	if selected == 0:
		planting.turn(angle)
	elif not _is_pressed:
		_set_basis("Turn", Basis(_frame.up(), angle) * _frame.transform.basis)


func _scale(factor: float) -> void:
	if selected == 0:
		planting.scale_by(factor)
	elif not _is_pressed:
		_set_basis("Scale", _frame.transform.basis * _scale_basis(factor, _frame.transform.basis))


func _set_basis(name: String, basis: Basis) -> void:
	problem = ""
	if not edits.begin(scatter, SceneFiles.edited_scene_path()):
		problem = edits.problem
		return
	_set_transform(Transform3D(basis, _frame.transform.origin))
	edits.commit("%s %s" % [name, layer.resource_name])


func _hover(mouse: InputEventMouse) -> void:
	_hovered = 0
	if not _is_pressed and _edit_problem().is_empty() and not mouse.shift_pressed:
		_hovered = _pick()
	_show_ghost()


func _show_ghost() -> void:
	var can_plant := _hovered == 0 and not _is_pressed and _edit_problem().is_empty() and _cursor.on_ground.is_finite()
	if can_plant and planting.mesh < _meshes.size():
		var with_control := Input.is_key_pressed(KEY_CTRL)
		_ghost.show(scatter, _meshes[planting.mesh], planting.transform_at(_cursor, scatter, with_control))
	else:
		_ghost.hide()


## Returns the id of the chosen layer's instance under the mouse, or 0 if there is none.
func _pick() -> int:
	var max_distance := MAX_DISTANCE
	if _cursor.on_ground.is_finite():
		max_distance = minf(max_distance, _cursor.from.distance_to(_cursor.on_ground) + 2.0 * layer.instance_radius)
	var hit := scatter.query_ray(_cursor.from, _cursor.from + _cursor.direction * max_distance, layer)
	return hit.id if hit != null else 0


## Selects an instance if it exists. An id of 0 clears the selection.
func _select(id: int) -> void:
	var frame := _frame_of(id) if id != 0 else null
	selected = id if frame != null else 0
	if frame != null:
		_frame = frame


## Returns the frame of an instance, or null if it does not exist or belongs to a different layer than the chosen one.
func _frame_of(id: int) -> HandFrame:
	if not is_instance_valid(scatter) or ground() == null:
		return null
	var instance := scatter.get_instance(id)
	if instance == null or instance.layer != layer:
		return null
	var frame := HandFrame.new()
	frame.transform = instance.transform
	var mesh := instance.mesh
	if not _meshes.is_empty() and _meshes[mini(mesh, _meshes.size() - 1)] != null:
		frame.box = _meshes[mesh if mesh < _meshes.size() else 0].get_aabb()
	else:
		var radius := layer.instance_radius
		frame.box = AABB(Vector3(-radius, 0.0, -radius), Vector3(2.0 * radius, layer.instance_height, 2.0 * radius))
	return frame


## Returns the position on a plane below the mouse, or [param fallback] if the mouse ray does not hit the plane. The
## plane passes through [param origin].
func _on_plane(origin: Vector3, normal: Vector3, fallback: Vector3) -> Vector3:
	var hit: Variant = Plane(normal, origin).intersects_ray(_cursor.from, _cursor.direction)
	return hit if hit is Vector3 else fallback


## Returns a uniform scale as a basis. The factor is limited so that the resulting size is at least [constant MIN_SIZE].
static func _scale_basis(factor: float, basis: Basis) -> Basis:
	var height := basis.y.length()
	return Basis.from_scale(Vector3.ONE * (maxf(factor, MIN_SIZE / height) if height > 0.0 else 1.0))
