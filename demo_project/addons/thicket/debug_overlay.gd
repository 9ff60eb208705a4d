class_name ScatterDebugOverlay
extends CanvasLayer
## Shows statistics of the scatters in a running game: numbers of instances, milliseconds, draw calls and pending tiles. Also explains why plants do
## or do not grow at the center of the screen.
##
## Add it to a scene and press [member toggle_key] in the game. The overlay is hidden at first and has no cost while it
## is hidden. It also works in release builds. To hide it from players, leave it out of these builds or set [member
## toggle_key] to [constant KEY_NONE]. Without the native library, the overlay only reports that it is missing.

const LibraryGate := preload("res://addons/thicket/library_gate.gd")
const GroundRay := preload("res://addons/thicket/ground_ray.gd")
const NumberText := preload("res://addons/thicket/number_text.gd")
const WhyRows := preload("res://addons/thicket/why_rows.gd")

## The time between two updates, in seconds.
const INTERVAL := 0.25
const MARGIN := 14.0
const BACKGROUND := Color(0.0, 0.0, 0.0, 0.72)
const TEXT := Color(0.92, 0.92, 0.92)
## The maximum distance from the camera at which a position is explained, in meters.
const REACH := 1000.0

## The key that shows and hides the overlay.
@export var toggle_key: Key = KEY_F3
## If true, the overlay explains the position at the center of the screen.
@export var explain := true

## The lines of text as of the last update.
var lines := PackedStringArray()

var _canvas := Control.new()
var _explanation := WhyRows.new()
var _elapsed := INF # The time since the last update, in seconds.


func _init() -> void:
	layer = 100
	visible = false


func _ready() -> void:
	_canvas.set_anchors_preset(Control.PRESET_FULL_RECT)
	_canvas.mouse_filter = Control.MOUSE_FILTER_IGNORE
	_canvas.draw.connect(_draw_all)
	add_child(_canvas)
	visibility_changed.connect(_on_visibility_changed)
	_on_visibility_changed()


func _input(event: InputEvent) -> void:
	var key := event as InputEventKey
	if key and key.pressed and not key.echo and toggle_key != KEY_NONE and key.keycode == toggle_key:
		visible = not visible


func _process(delta: float) -> void:
	_elapsed += delta
	if _elapsed >= INTERVAL:
		_elapsed = 0.0
		update()


## Updates all values, even if the overlay is hidden.
func update() -> void:
	lines.clear()
	_explanation.rows.clear()
	lines.append("%d fps, %d draw calls of all nodes" % [
		Engine.get_frames_per_second(), RenderingServer.get_rendering_info(RenderingServer.RENDERING_INFO_TOTAL_DRAW_CALLS_IN_FRAME)])
	if not LibraryGate.is_open():
		lines.append(LibraryGate.problem())
	var scatters := get_tree().root.find_children("*", LibraryGate.SCATTER, true, false)
	for scatter in scatters:
		_add_scatter(scatter as Node3D)
	if explain:
		_explain(scatters)
	_canvas.queue_redraw()


func _add_scatter(scatter: Node3D) -> void:
	var stats: Dictionary = scatter.call(&"get_stats")
	var camera := get_viewport().get_camera_3d()
	var draw_stats: Dictionary = scatter.call(&"get_draw_stats", camera)
	var in_work: int = stats.waiting + stats.pending + stats.uploading
	lines.append("")
	lines.append("%s: %.2f ms on the main thread%s" % [scatter.name, stats.frame_usec / 1000.0, "" if scatter.is_visible_in_tree() else ", hidden"])
	lines.append("  %s instances in %d tiles; %d tiles pending" % [NumberText.grouped(stats.instances), stats.tiles, in_work])
	lines.append("  in view: %s instances, %s triangles, %d draw calls" % [NumberText.grouped(draw_stats.instances), NumberText.grouped(draw_stats.triangles), draw_stats.draw_calls])
	lines.append("  %d bodies, %d scenes, %.1f MiB" % [stats.bodies, stats.scenes, stats.instance_bytes / 1048576.0])
	for scatter_layer in LibraryGate.layers_of(scatter):
		if scatter_layer:
			lines.append("    %s  %s" % [NumberText.grouped(scatter.call(&"get_shown_count", scatter_layer)).lpad(9), scatter_layer.resource_name])


## Explains the first position on the ground along the view direction and names the first instance in front of it.
func _explain(scatters: Array[Node]) -> void:
	var camera := get_viewport().get_camera_3d()
	if camera == null:
		return
	var from := camera.global_position
	var direction := -camera.global_basis.z
	var nearest := REACH
	for scatter in scatters:
		var on_ground := GroundRay.first(scatter as Node3D, from, direction)
		if on_ground.is_empty() or on_ground[0].distance_to(from) >= nearest:
			continue
		var hit := on_ground[0]
		nearest = hit.distance_to(from)
		_explanation.fill(scatter.call(&"explain_position", hit), null)
		var instance: Variant = scatter.call(&"query_ray", from, hit)
		if instance != null:
			_explanation.rows.push_front([WhyRows.TEXT_COLOR, "%s, ID %d, at %.1f m" % [instance.layer.resource_name, instance.id, instance.distance]])


func _on_visibility_changed() -> void:
	set_process(visible)
	_elapsed = INF


func _draw_all() -> void:
	var font := ThemeDB.fallback_font
	var size := ThemeDB.fallback_font_size
	var text := "\n".join(lines)
	var extent := font.get_multiline_string_size(text, HORIZONTAL_ALIGNMENT_LEFT, -1, size)
	_canvas.draw_rect(Rect2(Vector2(MARGIN, MARGIN), extent + Vector2(20.0, 16.0)), BACKGROUND)
	var text_position := Vector2(MARGIN + 10.0, MARGIN + 8.0 + font.get_ascent(size))
	_canvas.draw_multiline_string(font, text_position, text, HORIZONTAL_ALIGNMENT_LEFT, -1, size, -1, TEXT)
	if not _explanation.rows.is_empty():
		var middle := _canvas.size * 0.5
		for axis: Vector2 in [Vector2(8.0, 0.0), Vector2(0.0, 8.0)]:
			_canvas.draw_line(middle - axis, middle + axis, TEXT, 1.0)
		_explanation.draw(_canvas, middle, false)
