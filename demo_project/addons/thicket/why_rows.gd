@tool
extends RefCounted
## Creates the text of the Why tool and of the debug overlay. For each layer, a line explains why the layer has or lacks an instance at a position.
## Games without the native library may contain this script, so it uses none of the library's classes as a type.

const MOST_LINES := 12
const WIDTH := 560.0
## A layer that grows only on the top of the ground is not explained below this depth, in meters.
const DEPTH := 0.1
const PRESENT_COLOR := Color(0.55, 1.0, 0.5)
const ABSENT_COLOR := Color(1.0, 0.6, 0.5)
const TEXT_COLOR := Color(0.92, 0.92, 0.92)
const DETAIL_COLOR := Color(0.92, 0.92, 0.92, 0.65)

## The rows, each an array of a color and a string.
var rows: Array[Array] = []


## Fills [member rows] from the result of [method TerrainScatter3D.explain_position]. Lists all rules and meshes of the layer [param selected_layer], or none
## if it is null. If the position [param position] is below the top of the ground, layers that grow only on the top are not explained there.
func fill(explanations: Array, selected_layer: Resource, position := Vector3.INF) -> void:
	rows.clear()
	# The selected layer comes first, so that it is never omitted.
	var ordered := explanations.filter(func(explanation: RefCounted) -> bool: return explanation.get(&"layer") == selected_layer)
	ordered.append_array(explanations.filter(func(explanation: RefCounted) -> bool: return explanation.get(&"layer") != selected_layer))
	for index in ordered.size():
		if rows.size() >= MOST_LINES:
			rows.append([DETAIL_COLOR, "… and %d more layers" % (ordered.size() - index)])
			break
		var explanation: Variant = ordered[index]
		var is_present: bool = str(explanation.refused_by).is_empty()
		var name: String = explanation.layer_name if explanation.layer_name else "Layer %d" % explanations.find(explanation)
		var depth: float = explanation.position.y - position.y
		if position.is_finite() and depth > DEPTH and explanation.layer != null and not explanation.layer.on_surfaces:
			rows.append([ABSENT_COLOR, "✗ %s: Grows only on the top of the ground, %.1f m above. Turn on on_surfaces to let it grow here." % [name, depth]])
			continue
		rows.append([PRESENT_COLOR if is_present else ABSENT_COLOR, "%s %s: %s" % ["✓" if is_present else "✗", name, explanation.reason]])
		if selected_layer != null and explanation.layer == selected_layer:
			for rule: int in explanation.get_rule_count():
				rows.append([DETAIL_COLOR, "    %s" % explanation.get_rule_sentence(rule)])
			for mesh: int in explanation.get_mesh_count():
				rows.append([DETAIL_COLOR, "    %s" % explanation.get_mesh_sentence(mesh)])


## Replaces all rows with one message.
func show_message(message: String) -> void:
	rows = [[TEXT_COLOR, message]]


## Draws the rows next to the position [param anchor] on an overlay.
func draw(overlay: Control, anchor: Vector2, pinned: bool) -> void:
	var font := ThemeDB.fallback_font
	var size := ThemeDB.fallback_font_size
	var displayed_rows := rows.duplicate()
	if pinned:
		displayed_rows.append([DETAIL_COLOR, "Pinned: click another position to move the pin, or click here to unpin."])
	var extent := Vector2.ZERO
	var heights := PackedFloat32Array()
	for row in displayed_rows:
		var text := font.get_multiline_string_size(row[1], HORIZONTAL_ALIGNMENT_LEFT, WIDTH, size)
		heights.append(text.y)
		extent = Vector2(maxf(extent.x, text.x), extent.y + text.y + 2.0)
	var text_position := (anchor + Vector2(20.0, 16.0)).min(overlay.size - extent - Vector2(16.0, 12.0)).max(Vector2(12.0, 12.0))
	overlay.draw_rect(Rect2(text_position - Vector2(8.0, 6.0), extent + Vector2(16.0, 10.0)), Color(0.0, 0.0, 0.0, 0.78))
	for index in displayed_rows.size():
		var baseline := text_position + Vector2(0.0, font.get_ascent(size))
		overlay.draw_multiline_string(font, baseline, displayed_rows[index][1], HORIZONTAL_ALIGNMENT_LEFT, WIDTH, size, -1, displayed_rows[index][0])
		text_position.y += heights[index] + 2.0
