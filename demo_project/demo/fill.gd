extends "res://demo/stage.gd"
## Shows one slope twice: birches that keep a distance from spruces, first thinned by it, then filling the gaps that it leaves. The key M switches.

## The stops, with the fields that [code]flight.gd[/code] describes. [code]fills[/code] is true if the birches fill the gaps.
const STOPS: Array[Dictionary] = [
	{"name": "thinned", "eye": Vector3(-30.0, 42.0, 75.0), "heading": 20.0, "pitch": -27.0, "fills": false},
	{"name": "filled", "eye": Vector3(-30.0, 42.0, 75.0), "heading": 20.0, "pitch": -27.0, "fills": true},
	{"name": "below", "eye": Vector3(0.0, 1.8, 60.0), "heading": 20.0, "pitch": 4.0, "fills": true},
]


func stops() -> Array[Dictionary]:
	return STOPS


func own_key(keycode: Key) -> void:
	if keycode == KEY_M:
		var birches: Resource = layers()[1]
		birches.set(&"spacing_fills", not birches.get(&"spacing_fills"))


func place(stop: Dictionary) -> void:
	super(stop)
	layers()[1].set(&"spacing_fills", stop.fills)
