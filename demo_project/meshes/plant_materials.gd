extends RefCounted
## The materials of the demo's plants, with the add-on's foliage shader: one for each species, shared by all its
## meshes.

const Atlas := preload("res://meshes/leaf_atlas.gd")
const FOLIAGE := preload("res://addons/thicket/shaders/foliage.gdshader")
const STONE := preload("res://shaders/stone.gdshader")

## The parameters that differ from the shader's defaults. Trees do not bend around characters.
const SETTINGS := {
	&"oak": {"sway_height": 14.0, "wind_sway": 0.12, "wind_flutter": 0.03, "bend_reach": 0.0, "backlight": 0.35},
	&"spruce": {"sway_height": 21.0, "wind_sway": 0.2, "wind_flutter": 0.02, "bend_reach": 0.0, "backlight": 0.2},
	&"shrub": {"sway_height": 1.7, "wind_sway": 0.05, "wind_flutter": 0.012, "bend_reach": 0.25, "backlight": 0.4},
	&"fern": {"sway_height": 0.5, "wind_sway": 0.03, "wind_flutter": 0.01, "backlight": 0.5},
	&"grass": {"sway_height": 0.6, "wind_sway": 0.07, "wind_flutter": 0.01, "backlight": 0.6},
	&"flower": {"sway_height": 0.5, "wind_sway": 0.05, "wind_flutter": 0.01, "backlight": 0.5},
	&"reed": {"sway_height": 2.0, "wind_sway": 0.12, "wind_flutter": 0.015, "backlight": 0.5},
	&"stump": {"wind_sway": 0.0, "wind_flutter": 0.0, "bend_reach": 0.0, "backlight": 0.0},
}

static var _made := {}


## The material of a species, created on the first call.
static func of(species: StringName) -> ShaderMaterial:
	if not _made.has(species):
		var material := ShaderMaterial.new()
		material.shader = STONE if species == &"stone" else FOLIAGE
		if species != &"stone":
			material.set_shader_parameter("albedo_texture", Atlas.texture())
		var settings: Dictionary = SETTINGS.get(species, {})
		for key: String in settings:
			material.set_shader_parameter(key, settings[key])
		_made[species] = material
	return _made[species]
