extends RefCounted
## The materials of the plants and stones, which the add-on contains; [code]save_models.gd[/code] writes them.

const FOLDER := "res://addons/thicket/presets/plants/materials/"
## The material of a species whose own name it does not have.
const SHARED := {
	&"stone": "mossy_stone", &"rock": "bare_stone", &"sandstone": "bare_stone", &"red_rock": "bare_stone", &"pebbles": "bare_stone", &"stump": "wood", &"log": "wood",
	&"cactus": "succulent", &"agave": "succulent",
}


## The material of a species.
static func of(species: StringName) -> ShaderMaterial:
	return load(FOLDER + SHARED.get(species, species) + ".tres")
