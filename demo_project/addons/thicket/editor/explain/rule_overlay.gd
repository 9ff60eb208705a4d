@tool
extends "res://addons/thicket/editor/ground/ground_overlay.gd"
## Shows the density or the rank of a layer, or the slope, as colors on the ground with a legend.

enum Kind { NOTHING, DENSITY, SLOPE, RANK }

const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")
const NAMES: PackedStringArray = ["Nothing", "Density", "Slope", "Rank"]
const TIPS: PackedStringArray = [
	"No colors on the ground.",
	"The density of the selected layer according to all of its rules: red for none, green for full.",
	"The slope of the ground.",
	"The order in which the selected layer is thinned: dark instances are removed last. Each position has the rank of the nearest point of the layer's set.",
]
## The time for drawing in each frame, in microseconds.
const BUDGET := 4000
const NONE := Color(0.0, 0.0, 0.0, 0.0)

var _scales: Array[Gradient] = [
	Gradient.new(),
	_scale([0.0, 0.004, 0.5, 1.0], [Color(0.9, 0.1, 0.1, 0.45), Color(1.0, 0.6, 0.1, 0.45), Color(0.95, 0.95, 0.2, 0.4), Color(0.2, 0.85, 0.25, 0.4)]),
	_scale([0.0, 0.33, 0.66, 1.0], [Color(0.15, 0.4, 1.0, 0.35), Color(0.3, 0.9, 0.4, 0.4), Color(1.0, 0.75, 0.1, 0.45), Color(0.9, 0.1, 0.3, 0.5)]),
	_scale([0.0, 0.5, 1.0], [Color(0.1, 0.05, 0.35, 0.6), Color(0.1, 0.6, 0.65, 0.5), Color(1.0, 0.95, 0.5, 0.4)]),
]
var _kind := Kind.NOTHING
var _name := ""


## Draws values of the layer at an index, around a position on the ground. The view is [param distance] meters from that
## position. Has no effect if the arguments are the same as last time. [param version] must change when the settings
## change.
func show(scatter: TerrainScatter3D, kind: Kind, layer: int, center: Vector3, distance: float, version: int) -> void:
	var layers := ScatterLayers.of(scatter)
	var scatter_layer: ScatterLayer = layers[layer] if layer >= 0 and layer < layers.size() else null
	if kind == Kind.NOTHING or (scatter_layer == null and kind != Kind.SLOPE):
		return hide()
	_kind = kind
	_name = "" if scatter_layer == null else str(scatter_layer.resource_name) if scatter_layer.resource_name else "Layer %d" % layer
	# Points are about a radius apart, so with larger quads their ranks would look like noise.
	var max_quad: float = scatter_layer.radius * 0.5 if kind == Kind.RANK else INF
	cover(scatter, center, distance, [kind, layer, version], _sample_colors.bind(scatter, kind, scatter_layer), max_quad, covers_planet(scatter, kind, scatter_layer))


## Returns true if the ground is a planet and the values can be shown on all of its sides.
static func covers_planet(scatter: TerrainScatter3D, kind: Kind, layer: ScatterLayer) -> bool:
	return SurfacePlace.is_planet(scatter) and (kind == Kind.SLOPE or kind == Kind.DENSITY and layer != null and layer.on_surfaces)


func hide() -> void:
	_kind = Kind.NOTHING
	super()


## Draws the legend in a corner of a view.
func draw_legend(overlay: Control) -> void:
	if _kind == Kind.NOTHING:
		return
	var font := ThemeDB.fallback_font
	var size := ThemeDB.fallback_font_size
	var bar := Rect2(Vector2(24.0, overlay.size.y - 56.0), Vector2(220.0, 12.0))
	overlay.draw_rect(bar.grow_individual(12.0, size + 14.0, 12.0, size + 12.0), Color(0.0, 0.0, 0.0, 0.75))
	const STEPS := 44
	for step in STEPS:
		var color := _scales[_kind].sample(step / (STEPS - 1.0))
		var step_rect := Rect2(bar.position + Vector2(bar.size.x * step / STEPS, 0.0), Vector2(bar.size.x / STEPS + 0.5, bar.size.y))
		overlay.draw_rect(step_rect, Color(color, 1.0))
	var title := NAMES[_kind] if _kind == Kind.SLOPE else "%s of %s" % [NAMES[_kind], _name]
	overlay.draw_string(font, bar.position - Vector2(0.0, 8.0), title, HORIZONTAL_ALIGNMENT_LEFT, bar.size.x, size)
	var ends: Array = {
		Kind.DENSITY: ["0: nothing", "1: all"], Kind.SLOPE: ["0°: flat", "90°"], Kind.RANK: ["0: removed last", "1: removed first"],
	}[_kind]
	var label_position := bar.position + Vector2(0.0, bar.size.y + size)
	overlay.draw_string(font, label_position, ends[0], HORIZONTAL_ALIGNMENT_LEFT, bar.size.x, size - 2)
	overlay.draw_string(font, label_position, ends[1], HORIZONTAL_ALIGNMENT_RIGHT, bar.size.x, size - 2)


func _sample_colors(rect: Rect2, size: Vector2i, positions: PackedVector3Array, scatter: TerrainScatter3D, kind: Kind, layer: ScatterLayer) -> PackedColorArray:
	var values: PackedFloat32Array
	match kind:
		Kind.DENSITY: values = scatter._densities_at(layer, positions) if covers_planet(scatter, kind, layer) else scatter.get_density_map(layer, rect, size)
		Kind.SLOPE: values = scatter._slopes_at(positions) if covers_planet(scatter, kind, layer) else scatter.get_slope_map(rect, size)
		Kind.RANK: values = scatter.get_rank_map(layer, rect, size)
	var colors := PackedColorArray()
	for value in values:
		colors.append(NONE if is_nan(value) else _scales[kind].sample(value / 90.0 if kind == Kind.SLOPE else value))
	return colors


static func _scale(offsets: PackedFloat32Array, colors: PackedColorArray) -> Gradient:
	var gradient := Gradient.new()
	gradient.offsets = offsets
	gradient.colors = colors
	return gradient
