extends RefCounted
## Returns the materials of the plants and stones, which the add-on contains and [code]save_models.gd[/code] writes.

const FOLDER := "res://addons/thicket/presets/plants/materials/"
## The material name of each species whose material does not have the name of the species.
const SHARED := {
	&"stone": "mossy_stone", &"rock": "bare_stone", &"sandstone": "bare_stone", &"red_rock": "bare_stone", &"pebbles": "bare_stone", &"stump": "wood", &"log": "wood",
	&"cactus": "succulent", &"agave": "succulent", &"moss": "succulent", &"mushroom": "succulent", &"ivy": "shrub", &"stalactite": "bare_stone",
}


## Returns the material of a species.
static func of(species: StringName) -> ShaderMaterial:
	return load(FOLDER + SHARED.get(species, species) + ".tres")
