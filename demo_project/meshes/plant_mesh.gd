@tool
extends ArrayMesh
## A mesh that builds itself when it is loaded, from a few settings that the scene stores: a species of the demo, a
## variant, and the finest LOD.
##
## The surfaces are never saved, so a scene that uses it stays small. The same settings produce the same mesh on every
## machine.

const Builder := preload("res://meshes/mesh_builder.gd")
const Materials := preload("res://meshes/plant_materials.gd")
const SPECIES := {
	&"oak": preload("res://meshes/oak.gd"),
	&"spruce": preload("res://meshes/spruce.gd"),
	&"shrub": preload("res://meshes/shrub.gd"),
	&"fern": preload("res://meshes/fern.gd"),
	&"grass": preload("res://meshes/grass.gd"),
	&"flower": preload("res://meshes/flower.gd"),
	&"reed": preload("res://meshes/reed.gd"),
	&"stone": preload("res://meshes/stone.gd"),
	&"stump": preload("res://meshes/stump.gd"),
}

## The builder to use, one of the keys of [constant SPECIES].
@export_enum("oak", "spruce", "shrub", "fern", "grass", "flower", "reed", "stone", "stump") var species := "oak":
	set(value):
		if not SPECIES.has(StringName(value)):
			push_error("species must be one of %s, got '%s'" % [", ".join(SPECIES.keys()), value])
			return
		species = value
		_request_build()

## The number of the individual plant, 0 or more.
@export_range(0, 15) var variant := 0:
	set(value):
		variant = clampi(value, 0, 15)
		_request_build()

## The finest LOD that the mesh has. 0 is the species' finest LOD; larger numbers create coarser meshes for [member ScatterModel.lods].
@export_range(0, 4) var finest_level := 0:
	set(value):
		finest_level = clampi(value, 0, 4)
		_request_build()

var _requested := false


func _init() -> void:
	_request_build()


func _validate_property(property: Dictionary) -> void:
	if property.name == "_surfaces" or property.name == "_blend_shape_names":
		property.usage &= ~PROPERTY_USAGE_STORAGE


func _request_build() -> void:
	if not _requested:
		_requested = true
		_build.call_deferred()


func _build() -> void:
	_requested = false
	SPECIES[StringName(species)].build(variant).commit(self, finest_level, Materials.of(StringName(species)))
