extends MeshInstance3D
## Draws the borders of a scatter's visible tiles as bright bands on the ground, with a different color for each
## tile size.

const COLORS: Array[Color] = [
	Color(1.0, 0.72, 0.2), Color(0.35, 0.85, 1.0), Color(1.0, 0.45, 0.75), Color(0.75, 1.0, 0.4), Color(0.95, 0.95,
			0.95)]
## The height of a band above the ground, and the length of the pieces that follow the ground, in meters.
const LIFT := 0.6
const PIECE := 16.0

## The [code]TerrainScatter3D[/code] whose tiles are drawn.
var scatter: Node3D
## The ground, an object with a method [code]height(x, z)[/code].
var elevation: RefCounted

var _is_stale := true


func _ready() -> void:
	var bands := StandardMaterial3D.new()
	bands.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	bands.vertex_color_use_as_albedo = true
	bands.cull_mode = BaseMaterial3D.CULL_DISABLED
	bands.disable_fog = true
	material_override = bands
	cast_shadow = SHADOW_CASTING_SETTING_OFF
	mesh = ImmediateMesh.new()


## Sets the scatter and the ground. The borders are redrawn whenever the scatter's tiles change.
func follow(new_scatter: Node3D, ground: RefCounted) -> void:
	scatter = new_scatter
	elevation = ground
	scatter.connect(&"tile_shown", _on_tiles_changed)
	scatter.connect(&"tile_hidden", _on_tiles_changed)


func _on_tiles_changed(_layer: Resource, _tile: Vector2i) -> void:
	_is_stale = true


func _process(_delta: float) -> void:
	if visible and _is_stale and scatter != null:
		_is_stale = false
		_draw_all()


func _draw_all() -> void:
	var bands := mesh as ImmediateMesh
	bands.clear_surfaces()
	var layers: Array = scatter.get(&"layers")
	var has_begun := false
	var sizes: Array[float] = []
	for index in layers.size():
		if layers[index] == null or sizes.has(layers[index].get(&"tile_size")):
			continue
		var size: float = layers[index].get(&"tile_size")
		sizes.append(size)
		for tile: Vector2i in scatter.call(&"get_shown_tiles", layers[index]):
			if not has_begun:
				bands.surface_begin(Mesh.PRIMITIVE_TRIANGLES)
				has_begun = true
			bands.surface_set_color(COLORS[(sizes.size() - 1) % COLORS.size()])
			var from := Vector2(tile) * size
			_band(from, from + Vector2(size, 0.0), size)
			_band(from, from + Vector2(0.0, size), size)
	if has_begun:
		bands.surface_end()


## Adds a flat band along a border, on the ground. Larger tiles have wider bands.
func _band(from: Vector2, to: Vector2, size: float) -> void:
	var bands := mesh as ImmediateMesh
	var width := clampf(size * 0.008, 0.12, 1.2)
	var side := (to - from).normalized().orthogonal() * width
	var pieces := maxi(1, ceili(size / PIECE))
	for i in pieces:
		var a := from.lerp(to, float(i) / pieces)
		var b := from.lerp(to, float(i + 1) / pieces)
		var corners := [_on_ground(a - side), _on_ground(b - side), _on_ground(b + side), _on_ground(a + side)]
		if corners.any(func(corner: Vector3) -> bool: return is_nan(corner.y)):
			continue
		for k: int in [0, 1, 2, 0, 2, 3]:
			bands.surface_add_vertex(corners[k])


func _on_ground(point: Vector2) -> Vector3:
	return Vector3(point.x, float(elevation.height(point.x, point.y)) + LIFT, point.y)
