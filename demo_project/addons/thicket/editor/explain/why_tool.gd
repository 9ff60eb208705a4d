@tool
extends "res://addons/thicket/editor/ground/ground_tool.gd"
## Explains why instances are or are not placed at a position. Each layer's result is shown next to the mouse. A click
## pins it. The tool can also color the ground by density, slope or rank.

const RuleOverlay := preload("res://addons/thicket/editor/explain/rule_overlay.gd")
const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")
const WhyRows := preload("res://addons/thicket/why_rows.gd")

## The minimum time in milliseconds between two explanations while the mouse moves.
const PAUSE := 80
## The distance in pixels from the pin within which a click removes it.
const NEAR := 24.0

var panel := WhyRows.new()
var overlay := RuleOverlay.new()
## The world position of the pin, in meters; [constant Vector3.INF] while the panel follows the mouse.
var pinned := Vector3.INF

var _colors := OptionButton.new()
var _color_problem := "" ## The reason why there are no colors; empty if they are shown or not requested.
var _explained_msec := 0
var _explained_position := Vector3.INF
var _version := 0 ## Increases with each change to the settings.
var _state: Array = []
var _camera: Camera3D


func _init() -> void:
	_setup("Why?", &"Help", "Why?: point at the ground to see why each layer does or does not grow there. Click to pin the text.")
	_colors.tooltip_text = "Colors to show on the ground."
	for kind in RuleOverlay.NAMES.size():
		_colors.add_item(RuleOverlay.NAMES[kind])
		_colors.get_popup().set_item_tooltip(kind, RuleOverlay.TIPS[kind])
	_colors.item_selected.connect(func(_index: int) -> void: refresh(); redraw_requested.emit())
	add_child(_colors)


## Selects the colors on the ground.
func choose_colors(kind: RuleOverlay.Kind) -> void:
	_colors.select(kind)
	refresh()
	redraw_requested.emit()


func input(camera: Camera3D, event: InputEvent) -> int:
	_camera = camera
	return super(camera, event)


func _on_motion(_motion: InputEventMouseMotion) -> int:
	if not pinned.is_finite():
		_explain(_cursor.on_ground, false)
	return NOT_MINE


func _on_button(click: InputEventMouseButton) -> void:
	if not click.pressed:
		return
	var is_on_pin := pinned.is_finite() and _overlay_position(pinned).distance_to(_overlay_position(_cursor.on_ground)) < NEAR
	pinned = Vector3.INF if is_on_pin else _cursor.on_ground
	_explain(_cursor.on_ground, true)


func draw_over(view_overlay: Control) -> void:
	overlay.draw_legend(view_overlay)
	super(view_overlay)


func _draw_view(view_overlay: Control) -> void:
	if not _color_problem.is_empty():
		_cursor.draw_hint(view_overlay, _color_problem)
	if panel.rows.is_empty():
		return
	var point := pinned if pinned.is_finite() else _cursor.on_ground
	if not point.is_finite():
		panel.draw(view_overlay, _cursor.mouse(), false)
		return
	if _camera.is_position_behind(point):
		return
	view_overlay.draw_circle(_cursor.to_overlay(point), 4.0, Color.BLACK)
	view_overlay.draw_circle(_cursor.to_overlay(point), 3.0, Color.WHITE)
	panel.draw(view_overlay, _cursor.to_overlay(point), pinned.is_finite())


func refresh() -> void:
	if not is_on() or not is_instance_valid(scatter) or not scatter.is_inside_tree():
		overlay.hide()
		return
	_update_after_changes()
	var camera := EditorInterface.get_editor_viewport_3d(0).get_camera_3d()
	_color_problem = ""
	if _colors.selected == RuleOverlay.Kind.NOTHING or ground() == null:
		overlay.hide()
		return
	var distance := SurfacePlace.distance(scatter, camera.global_position, -camera.global_basis.z)
	var center := camera.global_position - camera.global_basis.z * distance
	if not RuleOverlay.covers_planet(scatter, _colors.selected as RuleOverlay.Kind, layer):
		_color_problem = SurfacePlace.map_problem(scatter, center, "These colors are computed along the y axis and are shown", "Turn the view there.")
	if _color_problem.is_empty():
		overlay.show(scatter, _colors.selected as RuleOverlay.Kind, layer_index, center, distance, _version)
	else:
		overlay.hide()


func finish() -> void:
	pinned = Vector3.INF
	panel.rows.clear()
	_explained_position = Vector3.INF
	_cursor.clear()


func _process(_delta: float) -> void:
	overlay.work(RuleOverlay.BUDGET)
	if is_on() and not pinned.is_finite() and _cursor.on_ground != _explained_position:
		_explain(_cursor.on_ground, false) # The mouse has stopped, so the last position is still to be explained.


func _on_toggled() -> void:
	super()
	finish()
	refresh()


func _overlay_position(position: Vector3) -> Vector2:
	return _cursor.to_overlay(position) if position.is_finite() and not _camera.is_position_behind(position) else Vector2.INF


## Updates the explanation and the colors once the scatter has settled after a change to its settings.
func _update_after_changes() -> void:
	var state: Array = [scatter, ground(), layer_index, scatter.is_settled(), scatter.get_stats().tiles_made]
	if state == _state:
		return
	_state = state
	if state[3]:
		_version += 1
		_explain(pinned if pinned.is_finite() else _cursor.on_ground, true)


func _explain(point: Vector3, is_immediate: bool) -> void:
	if not is_immediate and (Time.get_ticks_msec() - _explained_msec < PAUSE or point == _explained_position):
		return
	_explained_msec = Time.get_ticks_msec()
	_explained_position = point
	if ground() == null:
		panel.show_message(_ground_problem("explain"))
	elif ScatterLayers.of(scatter).is_empty():
		panel.show_message("There is nothing to explain: add a layer to %s in the Scatter panel." % scatter.name)
	elif not point.is_finite():
		panel.rows.clear()
	else:
		panel.fill(scatter.explain_position(point), layer, point)
	redraw_requested.emit()
