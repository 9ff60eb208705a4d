extends "res://demo/stage.gd"
## Shows a ground in GDScript: an island from a formula. The scatter and the drawn terrain use the same script for their heights.

const STOPS: Array[Dictionary] = [
	{"name": "island", "eye": Vector3(-62.0, 66.0, 208.0), "heading": 16.0, "pitch": -17.0},
	{"name": "coast", "eye": Vector3(-135.0, 4.0, 105.0), "heading": 25.0, "pitch": 8.0},
	{"name": "sinkhole", "eye": Vector3(52.0, 8.0, 44.0), "heading": 333.0, "pitch": -20.0},
]


func stops() -> Array[Dictionary]:
	return STOPS
