@tool
extends ArrayMesh
## A mesh for scenes that were saved with version 0.2, whose presets contained meshes with this script. It copies the finest LOD of the model that
## replaces it. New scenes refer directly to the models in [code]plants[/code].

## The most similar model for each former kind.
const MODELS := {
	"spruce": "spruce_1", "birch": "birch_1", "bush": "shrub_1", "fern": "fern_1", "grass": "grass_1", "flower": "flower_1",
	"boulder": "stone_1", "rock": "rock_1", "pebble": "pebbles_1",
}

## One of the keys of [constant MODELS]. Any other name is ignored with an error.
@export var kind := "":
	set(value):
		if not MODELS.has(value):
			push_error("PresetMesh.kind must be one of %s, got '%s'. The last kind is kept." % [", ".join(MODELS.keys()), value])
			return
		kind = value
		_copy()


func _validate_property(property: Dictionary) -> void:
	if property.name == "_surfaces" or property.name == "_blend_shape_names":
		property.usage &= ~PROPERTY_USAGE_STORAGE


func _copy() -> void:
	var model: Resource = load("res://addons/thicket/presets/plants/%s.res" % MODELS[kind])
	var lod: Resource = model.get(&"lods")[0]
	var mesh: ArrayMesh = lod.get(&"mesh")
	clear_surfaces()
	# Copies the stored data of the mesh. Reading it back from the renderer would make a loading thread wait.
	set(&"_surfaces", mesh.get(&"_surfaces"))
