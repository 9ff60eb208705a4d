@tool
extends RefCounted
## Watches added layers until their instances are placed. Then reports new layers that have no instances or little room,
## and older layers that have lost instances to the new ones.

const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

## A new layer has little room if at least the fraction [constant CROWDED_FRACTION] of its points is too close to other layers.
## The fraction is measured at [constant POSITIONS] positions, within [constant SAMPLE_RADII] times the layer's radius around
## the point in the center of the view.
const CROWDED_FRACTION := 0.5
const POSITIONS := 60
const SAMPLE_RADII := 15.0
## The longest time for one layer, in milliseconds. An explanation on surfaces of dense meshes may take half a second.
const MAX_MSEC := 300
## An older layer is reported if it had at least [constant MIN_COUNT] instances and less than the fraction [constant KEPT_FRACTION] of them is left.
const KEPT_FRACTION := 0.7
const MIN_COUNT := 20

var _scatter: TerrainScatter3D
var _unchecked: Array[ScatterLayer] = [] ## The new layers that have not been checked yet.
var _reports_crowding := true
var _empty_layers: Array[ScatterLayer] = [] ## The checked new layers without instances.
var _messages := PackedStringArray()
var _old_counts: Dictionary[ScatterLayer, int] = {} ## The numbers of visible instances of older layers.


## Records the numbers of instances of a scatter's layers. Call this before layers are added.
func record_counts(scatter: TerrainScatter3D) -> void:
	_scatter = scatter
	_old_counts.clear()
	for layer in scatter.layers:
		if layer != null:
			_old_counts[layer] = scatter.get_shown_count(layer)


## Watches the layers that were added since the last call to [method record_counts]. The layers of a preset are crowded on
## purpose, so if [param is_preset] is true, little room is reported only if the scatter had layers before.
func watch(is_preset := false) -> void:
	_reports_crowding = not is_preset or not _old_counts.is_empty()
	_empty_layers.clear()
	_messages.clear()
	_unchecked = _scatter.layers.filter(func(layer: ScatterLayer) -> bool: return layer != null and not _old_counts.has(layer))


## Returns true until all new layers have been checked.
func is_watching() -> bool:
	return not _unchecked.is_empty()


## Checks one new layer if all tiles are ready, and shows the results after the last one. Call this several times per second.
func refresh() -> void:
	if _unchecked.is_empty():
		return
	if not is_instance_valid(_scatter) or not _scatter.is_inside_tree():
		_unchecked.clear()
		return
	if not _scatter.is_settled():
		return
	if _scatter.ground == null: # The node itself warns about a missing ground.
		_unchecked.clear()
		return
	# Only one layer is checked in each call, because the explanations of many layers take longer than a frame.
	var layer: ScatterLayer = _unchecked.pop_front()
	if layer in _scatter.layers:
		if _scatter.get_shown_count(layer) == 0:
			_empty_layers.append(layer)
		elif _reports_crowding:
			_messages.append_array(_crowding_messages(layer))
	if _unchecked.is_empty():
		_report_all()


func _report_all() -> void:
	var empty_layers := _empty_layers.filter(func(layer: ScatterLayer) -> bool: return layer in _scatter.layers)
	if not empty_layers.is_empty():
		_show_toast(_absence_message(empty_layers))
	var messages := _messages + _loss_messages(_scatter.layers)
	if not messages.is_empty(): # All messages share one toast, because several toasts would cover the panel.
		_show_toast(" ".join(messages), "For more instances, lower the distances in Spacing or the densities of the other layers.")


## For each layer, returns a message that explains why it has no instance at the center of the view.
func _absence_message(empty_layers: Array[ScatterLayer]) -> String:
	var messages := PackedStringArray()
	for explanation in _scatter.explain_position(_view_center(), empty_layers):
		messages.append("%s: %s" % [explanation.layer_name, explanation.reason])
	return "No instances are visible here. " + " ".join(messages)


## Returns an array with one message if at least the fraction [constant CROWDED_FRACTION] of a layer's points is too close to other layers. Otherwise,
## returns an empty array.
func _crowding_messages(layer: ScatterLayer) -> PackedStringArray:
	if layer.spacing.is_empty():
		return []
	var center := _view_center()
	var crowded_count := 0
	var total := 0
	var frame := Transform3D(SurfacePlace.upright(SurfacePlace.up_at(_scatter, center)), center)
	var deadline := Time.get_ticks_msec() + MAX_MSEC
	for index in POSITIONS:
		if Time.get_ticks_msec() > deadline:
			break
		# A golden-angle spiral is evenly spread, and the same each time.
		var offset := Vector2.from_angle(index * 2.39996) * sqrt((index + 0.5) / POSITIONS) * SAMPLE_RADII * layer.radius
		var point := frame * Vector3(offset.x, 0.0, offset.y)
		var surface := SurfacePlace.level(_scatter, point, frame.basis.y)
		var explanations := _scatter.explain_position(surface[0] if not surface.is_empty() else point, [layer])
		if explanations.is_empty():
			continue
		crowded_count += int(explanations[0].refused_by == "spacing")
		total += int(explanations[0].refused_by == "spacing" or explanations[0].standing)
	if total == 0 or crowded_count < CROWDED_FRACTION * total:
		return []
	return ["%s: %d %% of its points are too close to other layers." % [layer.resource_name, roundi(100.0 * crowded_count / total)]]


## Returns a message for each older layer that has lost many instances.
func _loss_messages(layers: Array[ScatterLayer]) -> PackedStringArray:
	var messages := PackedStringArray()
	for layer in _old_counts:
		if layer in layers and _old_counts[layer] >= MIN_COUNT and _scatter.get_shown_count(layer) < KEPT_FRACTION * _old_counts[layer]:
			messages.append("%s: %d of %d instances are left among the new layers." % [layer.resource_name, _scatter.get_shown_count(layer), _old_counts[layer]])
	return messages


## Returns the position on the ground at the center of the view.
func _view_center() -> Vector3:
	var camera := EditorInterface.get_editor_viewport_3d(0).get_camera_3d()
	return camera.global_position - camera.global_basis.z * SurfacePlace.distance(_scatter, camera.global_position, -camera.global_basis.z)


static func _show_toast(message: String, fix := "") -> void:
	EditorInterface.get_editor_toaster().push_toast(message, EditorToaster.SEVERITY_WARNING, "%s\n%s" % [message, fix] if fix else "")
