extends RefCounted
## The materials of the demo's plants, one for each species, shared by all its meshes.

const Atlas := preload("res://meshes/leaf_atlas.gd")
const PLANT := preload("res://shaders/plant.gdshader")
const STONE := preload("res://shaders/stone.gdshader")

## What differs from the shader's defaults: sway in meters, and how much light leaves let through.
const SETTINGS := {
	&"oak": {"sway": 0.16, "translucency": 0.5, "tint_range": 0.42},
	&"spruce": {"sway": 0.14, "translucency": 0.22, "tint_range": 0.26},
	&"shrub": {"sway": 0.05, "translucency": 0.5, "tint_range": 0.4},
	&"fern": {"sway": 0.05, "translucency": 0.6, "tint_range": 0.25},
	&"grass": {"sway": 0.09, "translucency": 0.6, "tint_range": 0.3},
	&"flower": {"sway": 0.07, "translucency": 0.5, "tint_range": 0.12},
	&"reed": {"sway": 0.14, "translucency": 0.5, "tint_range": 0.25},
	&"stone": {},
	&"stump": {"tint_range": 0.2},
}

static var _made := {}


## The material of a species, made on the first call.
static func of(species: StringName) -> ShaderMaterial:
	if not _made.has(species):
		var material := ShaderMaterial.new()
		material.shader = STONE if species == &"stone" else PLANT
		if species != &"stone":
			material.set_shader_parameter("atlas", Atlas.texture())
		var settings: Dictionary = SETTINGS[species]
		for key: String in settings:
			material.set_shader_parameter(key, settings[key])
		_made[species] = material
	return _made[species]
