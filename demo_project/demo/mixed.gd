extends "res://demo/stage.gd"
## Shows species that give way to each other within one layer: oaks below, spruces above, and birches in groups. The key M switches to the same trees
## with plain weights.

## The stops, with the fields that [code]flight.gd[/code] describes. [code]by_height[/code] is false for plain weights.
const STOPS: Array[Dictionary] = [
	{"name": "even", "eye": Vector3(-30.0, 90.0, 75.0), "heading": 20.0, "pitch": -22.0, "by_height": false},
	{"name": "mixed", "eye": Vector3(-30.0, 90.0, 75.0), "heading": 20.0, "pitch": -22.0, "by_height": true},
	{"name": "below", "eye": Vector3(0.0, 1.8, 60.0), "heading": 20.0, "pitch": 4.0, "by_height": true},
]

var _expressions: PackedStringArray


func _ready() -> void:
	_expressions = layers()[0].get(&"mesh_density_expressions")
	super()


func stops() -> Array[Dictionary]:
	return STOPS


func own_key(keycode: Key) -> void:
	if keycode == KEY_M:
		var expressions: PackedStringArray = layers()[0].get(&"mesh_density_expressions")
		_set_by_height(expressions.is_empty())


func place(stop: Dictionary) -> void:
	super(stop)
	_set_by_height(stop.by_height)


func _set_by_height(by_height: bool) -> void:
	layers()[0].set(&"mesh_density_expressions", _expressions if by_height else PackedStringArray())
