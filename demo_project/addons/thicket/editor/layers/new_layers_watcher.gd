@tool
extends RefCounted
## Watches added layers until their instances are placed. Then reports new layers that have no instances or little room,
## and older layers that have lost instances to the new ones.

const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

## A new layer has little room if at least the fraction [constant CROWDED] of its points is too close to other layers.
## The fraction is measured at [constant POSITIONS] positions, within [constant RADII] times the layer's radius around
## the point in the center of the view.
const CROWDED := 0.5
const POSITIONS := 60
const RADII := 15.0
## The longest time for one layer, in milliseconds. An explanation on surfaces of dense meshes may take half a second.
const MOST_MSEC := 300
## An older layer is reported if it had at least [constant FEW] instances and less than the fraction [constant KEPT] of them is left.
const KEPT := 0.7
const FEW := 20

var _scatter: TerrainScatter3D
var _fresh: Array[ScatterLayer] = [] ## The new layers that have not been checked yet.
var _reports_crowding := true
var _missing: Array[ScatterLayer] = [] ## The checked new layers without instances.
var _sentences := PackedStringArray()
var _before: Dictionary[ScatterLayer, int] = {} ## The numbers of visible instances of older layers.


## Records the numbers of instances of a scatter's layers. Call this before layers are added.
func note(scatter: TerrainScatter3D) -> void:
	_scatter = scatter
	_before.clear()
	for layer in scatter.layers:
		if layer != null:
			_before[layer] = scatter.get_shown_count(layer)


## Watches the layers that were added since the last call to [method note]. The layers of a preset are crowded on
## purpose, so if [param is_preset] is true, little room is reported only if the scatter had layers before.
func watch(is_preset := false) -> void:
	_reports_crowding = not is_preset or not _before.is_empty()
	_missing.clear()
	_sentences.clear()
	_fresh = _scatter.layers.filter(func(layer: ScatterLayer) -> bool: return layer != null and not _before.has(layer))


## Returns true until all new layers have been checked.
func is_watching() -> bool:
	return not _fresh.is_empty()


## Checks one new layer if all tiles are ready, and shows the results after the last one. Call this several times per second.
func refresh() -> void:
	if _fresh.is_empty():
		return
	if not is_instance_valid(_scatter) or not _scatter.is_inside_tree():
		_fresh.clear()
		return
	if not _scatter.is_settled():
		return
	if _scatter.ground == null: # The node itself warns about a missing ground.
		_fresh.clear()
		return
	# Only one layer is checked in each call, because the explanations of many layers take longer than a frame.
	var layer: ScatterLayer = _fresh.pop_front()
	if layer in _scatter.layers:
		if _scatter.get_shown_count(layer) == 0:
			_missing.append(layer)
		elif _reports_crowding:
			_sentences.append_array(_crowding(layer))
	if _fresh.is_empty():
		_report_all()


func _report_all() -> void:
	var missing := _missing.filter(func(layer: ScatterLayer) -> bool: return layer in _scatter.layers)
	if not missing.is_empty():
		_show_toast(_why(missing))
	var sentences := _sentences + _losses(_scatter.layers)
	if not sentences.is_empty(): # All messages share one toast, because several toasts would cover the panel.
		_show_toast(" ".join(sentences), "For more instances, lower the distances in Spacing or the densities of the other layers.")


## For each layer, returns a message that explains why it has no instance at the center of the view.
func _why(missing: Array[ScatterLayer]) -> String:
	var sentences := PackedStringArray()
	for explanation in _scatter.explain_position(_view_center(), missing):
		sentences.append("%s: %s" % [explanation.layer_name, explanation.reason])
	return "No instances are visible here. " + " ".join(sentences)


## Returns an array with one message if at least the fraction [constant CROWDED] of a layer's points is too close to other layers. Otherwise, returns
## an empty array.
func _crowding(layer: ScatterLayer) -> PackedStringArray:
	if layer.spacing.is_empty():
		return []
	var center := _view_center()
	var crowded := 0
	var counted := 0
	var frame := Transform3D(SurfacePlace.upright(SurfacePlace.up_at(_scatter, center)), center)
	var deadline := Time.get_ticks_msec() + MOST_MSEC
	for index in POSITIONS:
		if Time.get_ticks_msec() > deadline:
			break
		# A golden-angle spiral is evenly spread, and the same each time.
		var away := Vector2.from_angle(index * 2.39996) * sqrt((index + 0.5) / POSITIONS) * RADII * layer.radius
		var at := frame * Vector3(away.x, 0.0, away.y)
		var surface := SurfacePlace.level(_scatter, at, frame.basis.y)
		var found := _scatter.explain_position(surface[0] if not surface.is_empty() else at, [layer])
		if found.is_empty():
			continue
		crowded += int(found[0].refused_by == "spacing")
		counted += int(found[0].refused_by == "spacing" or found[0].standing)
	if counted == 0 or crowded < CROWDED * counted:
		return []
	return ["%s: %d %% of its points are too close to other layers." % [layer.resource_name, roundi(100.0 * crowded / counted)]]


## Returns a message for each older layer that has lost many instances.
func _losses(layers: Array[ScatterLayer]) -> PackedStringArray:
	var parts := PackedStringArray()
	for layer in _before:
		if layer in layers and _before[layer] >= FEW and _scatter.get_shown_count(layer) < KEPT * _before[layer]:
			parts.append("%s: %d of %d instances are left among the new layers." % [layer.resource_name, _scatter.get_shown_count(layer), _before[layer]])
	return parts


## Returns the position on the ground at the center of the view.
func _view_center() -> Vector3:
	var camera := EditorInterface.get_editor_viewport_3d(0).get_camera_3d()
	return camera.global_position - camera.global_basis.z * SurfacePlace.distance(_scatter, camera.global_position, -camera.global_basis.z)


static func _show_toast(sentence: String, fix := "") -> void:
	EditorInterface.get_editor_toaster().push_toast(sentence, EditorToaster.SEVERITY_WARNING, "%s\n%s" % [sentence, fix] if fix else "")
