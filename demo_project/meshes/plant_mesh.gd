@tool
extends ArrayMesh
## A mesh that builds itself when it is loaded. The scene stores only its settings: a species, a variant, and the finest LOD.
##
## The surfaces are never saved, so a scene that uses such a mesh stays small. The same settings produce the same mesh on every machine.

const Species := preload("res://meshes/species.gd")
const Materials := preload("res://meshes/plant_materials.gd")

## One of the keys of [constant Species.SCRIPTS].
@export var species := "oak":
	set(value):
		if not Species.SCRIPTS.has(StringName(value)):
			push_error("species must be one of %s, got '%s'" % [", ".join(Species.SCRIPTS.keys()), value])
			return
		species = value
		_request_build()

## The number of the individual plant, 0 or more.
@export_range(0, 15) var variant := 0:
	set(value):
		variant = clampi(value, 0, 15)
		_request_build()

## The finest LOD of the mesh. 0 is the species' finest LOD. Larger numbers create coarser meshes for [member ScatterModel.lods].
@export_range(0, 4) var finest_level := 0:
	set(value):
		finest_level = clampi(value, 0, 4)
		_request_build()

var _is_build_requested := false


func _init() -> void:
	_request_build()


func _validate_property(property: Dictionary) -> void:
	if property.name == "_surfaces" or property.name == "_blend_shape_names":
		property.usage &= ~PROPERTY_USAGE_STORAGE


func _request_build() -> void:
	if not _is_build_requested:
		_is_build_requested = true
		_build.call_deferred()


func _build() -> void:
	_is_build_requested = false
	Species.build(StringName(species), variant).commit(self, finest_level, Materials.of(StringName(species)))
