extends "res://demo/stage.gd"
## Shows biomes and water. A coarse image of the valley defines a meadow and a forest with irregular borders. When the lake rises, plants of dry land
## disappear, and reeds move with the shore.

## The stops, with the fields that [code]flight.gd[/code] describes. [code]water[/code] is the level of the lake, in meters.
const STOPS: Array[Dictionary] = [
	{"name": "biomes", "eye": Vector3(-20.0, 64.0, 215.0), "heading": 352.0, "pitch": -17.0},
	{"name": "border", "eye": Vector3(-2.0, 2.4, 120.0), "heading": 320.0, "pitch": -4.0},
	{"name": "waterline", "eye": Vector3(4.0, 5.5, 24.0), "heading": 318.0, "pitch": -12.0, "water": 0.0},
	{"name": "high_water", "eye": Vector3(4.0, 5.5, 24.0), "heading": 318.0, "pitch": -12.0, "water": HIGH_WATER},
]
## How far the lake rises, in meters.
const HIGH_WATER := 1.2

@onready var _lake: Node3D = $Lake


func _ready() -> void:
	$Ground.soil = _soil($Ground.soil)
	super()


func stops() -> Array[Dictionary]:
	return STOPS


func layers() -> Array:
	var result: Array = super().duplicate()
	for biome: Resource in scatter.get(&"biomes").biomes:
		result.append_array(biome.layers)
	return result


func own_key(keycode: Key) -> void:
	if keycode == KEY_M:
		raise_water(HIGH_WATER - _lake.global_position.y)


func place(stop: Dictionary) -> void:
	super(stop)
	if stop.has("water"):
		raise_water(stop.water)


## Sets the height of the lake's surface in meters, for drawing and for the rules.
func raise_water(level: float) -> void:
	_lake.global_position.y = level
	$Ground.material.set_shader_parameter(&"water_level", level)
	scatter.set(&"water_level", level)


## Returns the soils of the valley, with forest floor where the biome map has forest. Trees and forest floor then end at the same border.
func _soil(valley: Image) -> Image:
	var map: Resource = $Scatter.biomes
	var rect: Rect2 = $Ground.rect
	var soil: Image = valley.duplicate()
	for y in soil.get_height():
		for x in soil.get_width():
			var world_xz := rect.position + rect.size * Vector2(x, y) / Vector2(soil.get_size() - Vector2i.ONE)
			var weights := soil.get_pixel(x, y)
			var plant_weight := weights.r + weights.g
			var forest_weight: float = map.get_weights_at(world_xz)[1]
			soil.set_pixel(x, y, Color(plant_weight * (1.0 - forest_weight), plant_weight * forest_weight, weights.b, weights.a))
	return soil
