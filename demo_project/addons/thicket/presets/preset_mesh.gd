@tool
extends ArrayMesh
## A simple plant or stone for the presets. It is built when it is loaded, so a scene stores only its kind.
##
## Sizes are in meters, the model stands on y = 0, and the mesh has vertex colors and no textures. A kind has the
## same mesh on every machine.

const KINDS: PackedStringArray = [
	"spruce", "birch", "bush", "fern", "grass", "flower", "boulder", "rock", "pebble",
]
const BARK := Color(0.24, 0.17, 0.12)

const FOLIAGE := preload("res://addons/thicket/shaders/foliage.tres")
## The height in meters at which the sway of each plant is full; kinds that are not listed are stones.
const SWAY_HEIGHTS := {"spruce": 8.0, "birch": 7.0, "bush": 1.2, "fern": 0.6, "grass": 0.5, "flower": 0.45}

static var _materials := {}

## One of [constant KINDS]. Any other name is ignored with an error.
@export_enum("spruce", "birch", "bush", "fern", "grass", "flower", "boulder", "rock", "pebble") var kind := "":
	set(value):
		if not KINDS.has(value):
			push_error("PresetMesh.kind must be one of %s, got '%s'. The last kind is kept." % [", ".join(KINDS), value])
			return
		kind = value
		_build()

var _tool: SurfaceTool
var _random: RandomNumberGenerator


func _validate_property(property: Dictionary) -> void:
	if property.name == "_surfaces" or property.name == "_blend_shape_names":
		property.usage &= ~PROPERTY_USAGE_STORAGE


func _build() -> void:
	_random = RandomNumberGenerator.new()
	_random.seed = kind.hash()
	_tool = SurfaceTool.new()
	_tool.begin(Mesh.PRIMITIVE_TRIANGLES)
	call("_build_" + kind)
	_tool.index()
	clear_surfaces()
	_tool.set_material(_material_of(kind))
	_tool.commit(self)
	_tool = null
	_random = null


func _build_spruce() -> void:
	_cone(0.0, 2.0, 0.22, 0.14, 6, BARK, BARK)
	for tier in 5:
		var low := Color(0.14, 0.19, 0.12).lerp(Color(0.2, 0.26, 0.15), tier / 4.0)
		var foot := 1.1 + 1.5 * tier
		var reach := 1.9 - 0.35 * tier
		_cone(foot, foot + 2.7 - 0.2 * tier, reach, 0.0, 9, low, low * 1.7)
		_cone(foot + 0.6, foot, 0.0, reach, 9, low * 0.5, low * 0.8)


func _build_birch() -> void:
	_cone(0.0, 3.6, 0.16, 0.09, 6, Color(0.75, 0.74, 0.7), Color(0.6, 0.58, 0.53))
	var low := Color(0.2, 0.27, 0.1)
	var high := Color(0.42, 0.47, 0.22)
	_blob(Vector3(-0.2, 4.3, 0.1), Vector3(1.3, 1.5, 1.3), 0.2, low, high, true)
	_blob(Vector3(0.55, 5.2, -0.3), Vector3(0.9, 1.1, 0.9), 0.2, low, high, true)
	_blob(Vector3(0.0, 6.4, 0.1), Vector3(0.8, 1.1, 0.8), 0.2, low * 1.15, high, true)


func _build_bush() -> void:
	var low := Color(0.14, 0.19, 0.08)
	var high := Color(0.36, 0.41, 0.18)
	_blob(Vector3(0.0, 0.5, 0.0), Vector3(0.7, 0.65, 0.7), 0.25, low, high, true, 6)
	_blob(Vector3(0.55, 0.35, 0.3), Vector3(0.5, 0.45, 0.5), 0.25, low, high * 0.9, true)
	_blob(Vector3(-0.3, 0.3, 0.5), Vector3(0.45, 0.4, 0.45), 0.25, low, high, true)


func _build_fern() -> void:
	for leaf in 8:
		var turn := TAU * leaf / 8.0 + _random.randf_range(-0.2, 0.2)
		_blade(Vector3.ZERO, turn, _random.randf_range(0.55, 0.8), 0.1, 1.0, Color(0.14, 0.21, 0.08),
				Color(0.3, 0.4, 0.16))


func _build_grass() -> void:
	for blade in 9:
		var foot := Vector3(_random.randf_range(-0.14, 0.14), 0.0, _random.randf_range(-0.14, 0.14))
		_blade(foot, _random.randf() * TAU, _random.randf_range(0.3, 0.55), 0.02, 0.4, Color(0.17, 0.21, 0.1),
				Color(0.5, 0.52, 0.27))


func _build_flower() -> void:
	for stem in 4:
		var foot := Vector3(_random.randf_range(-0.2, 0.2), 0.0, _random.randf_range(-0.2, 0.2))
		var height := _random.randf_range(0.3, 0.5)
		_cone(0.0, height, 0.012, 0.008, 3, Color(0.14, 0.22, 0.07), Color(0.24, 0.34, 0.1), foot)
		_cone(height - 0.03, height + 0.03, 0.02, 0.09, 6, Color(0.62, 0.5, 0.06), Color(0.95, 0.9, 0.82), foot)
		_cone(height + 0.03, height + 0.04, 0.09, 0.0, 6, Color(0.95, 0.9, 0.82), Color(0.95, 0.72, 0.1), foot)


func _build_boulder() -> void:
	_blob(Vector3(0.0, 0.55, 0.0), Vector3(1.25, 0.95, 1.0), 0.2, Color(0.24, 0.23, 0.21), Color(0.5, 0.49, 0.46), true)


func _build_rock() -> void:
	_blob(Vector3(0.0, 0.16, 0.0), Vector3(0.45, 0.3, 0.36), 0.24, Color(0.25, 0.24, 0.22), Color(0.52, 0.51, 0.47), true)


func _build_pebble() -> void:
	for stone in 3:
		var turn := TAU * stone / 3.0
		var at := Vector3(cos(turn), 0.0, sin(turn)) * _random.randf_range(0.12, 0.2)
		var size := _random.randf_range(0.07, 0.13)
		_blob(at, Vector3(size, size * 0.6, size * 0.85), 0.2, Color(0.28, 0.27, 0.25), Color(0.55, 0.53, 0.5), true, 3)


## Adds a ring of quads between two heights, or of triangles if one radius is 0. The ring is visible from outside if [param to] is above [param from],
## else from below and inside.
func _cone(from: float, to: float, low_radius: float, high_radius: float, sides: int, low: Color, high: Color,
		at := Vector3.ZERO) -> void:
	var lean := (low_radius - high_radius) / (to - from)
	for side in sides:
		var around: Array[Vector3] = []
		for step in 2:
			var angle := TAU * (side + step) / sides
			around.append(Vector3(cos(angle), 0.0, sin(angle)))
		var corners: Array[Vector3] = [
			at + around[0] * low_radius + Vector3.UP * from, at + around[1] * low_radius + Vector3.UP * from,
			at + around[1] * high_radius + Vector3.UP * to, at + around[0] * high_radius + Vector3.UP * to,
		]
		for corner: int in ([0, 1, 2] if low_radius > 0.0 else []) + ([0, 2, 3] if high_radius > 0.0 else []):
			var out := around[1 if corner == 1 or corner == 2 else 0]
			var normal := (out + Vector3.UP * lean).normalized() * signf(to - from)
			_vertex(corners[corner], normal, high if corner > 1 else low)


## Adds a lumpy ellipsoid, darker at the bottom. With flat faces, it is a stone.
func _blob(center: Vector3, radii: Vector3, roughness: float, low: Color, high: Color, faceted := false,
		rings := 5) -> void:
	var sides := rings + 2
	var points: Array[PackedVector3Array] = []
	for ring in rings + 1:
		var row := PackedVector3Array()
		var down := PI * ring / rings
		for side in sides:
			var angle := TAU * (side + 0.5 * (ring % 2)) / sides
			var unit := Vector3(cos(angle) * sin(down), cos(down), sin(angle) * sin(down))
			row.append(unit * (1.0 + roughness * _random.randf_range(-1.0, 1.0) * sin(down)))
		points.append(row)
	for ring in rings:
		for side in sides:
			var next := (side + 1) % sides
			var apart := ring % 2
			# Each ring is turned by half a step, so the diagonals alternate.
			var a := points[ring][side]
			var b := points[ring][next]
			var c := points[ring + 1][side]
			var d := points[ring + 1][next]
			var faces := [[a, d, b], [a, c, d]] if apart else [[a, c, b], [b, c, d]]
			for face: Array in faces:
				_face(face, center, radii, low, high, faceted)


func _face(face: Array, center: Vector3, radii: Vector3, low: Color, high: Color, faceted: bool) -> void:
	var across: Vector3 = ((face[1] - face[0]) * radii).cross((face[2] - face[0]) * radii)
	if across.length_squared() < 1e-12:
		return
	var flat := -across.normalized()
	for unit: Vector3 in face:
		var normal := flat if faceted else (unit / radii).normalized()
		var height: float = ((face[0] + face[1] + face[2]).y / 3.0) if faceted else unit.y
		_vertex(center + unit * radii, normal, low.lerp(high, clampf(0.5 + 0.5 * height, 0.0, 1.0)))


## Adds a blade of two pieces that bends outwards. It has two sides, both lit from above.
func _blade(foot: Vector3, turn: float, length: float, width: float, bend: float, low: Color, high: Color) -> void:
	var out := Vector3(cos(turn), 0.0, sin(turn))
	var side := Vector3(-out.z, 0.0, out.x) * width
	var middle := foot + (Vector3.UP + out * 0.35 * bend).normalized() * length * 0.6
	var tip := middle + (Vector3.UP * (1.0 - 0.8 * bend) + out * bend).normalized() * length * 0.5
	var half := low.lerp(high, 0.6)
	var corners: Array[Vector3] = [foot - side * 0.5, foot + side * 0.5, middle + side, middle - side, tip]
	var colors: Array[Color] = [low, low, half, half, high]
	for corner: int in [0, 1, 2, 0, 2, 3, 3, 2, 4, 0, 2, 1, 0, 3, 2, 3, 4, 2]:
		_vertex(corners[corner], (Vector3.UP + out * 0.3).normalized(), colors[corner])


func _vertex(position: Vector3, normal: Vector3, color: Color) -> void:
	_tool.set_normal(normal)
	_tool.set_color(Color(color, 1.0))
	_tool.add_vertex(position)


static func _material_of(what: String) -> Material:
	if not _materials.has(what):
		_materials[what] = _plant_material(SWAY_HEIGHTS[what]) if what in SWAY_HEIGHTS else _stone_material()
	return _materials[what]


## The add-on's material, with a sway that fits the size of the plant.
static func _plant_material(height: float) -> ShaderMaterial:
	var material := FOLIAGE.duplicate() as ShaderMaterial
	material.set_shader_parameter(&"sway_height", height)
	material.set_shader_parameter(&"wind_sway", 0.03 + 0.015 * height)
	material.set_shader_parameter(&"wind_flutter", 0.015)
	material.set_shader_parameter(&"bend_reach", minf(0.3, 0.3 * height))
	return material


static func _stone_material() -> StandardMaterial3D:
	var material := StandardMaterial3D.new()
	material.vertex_color_use_as_albedo = true
	material.vertex_color_is_srgb = true
	material.roughness = 1.0
	material.metallic_specular = 0.2
	return material
