@tool
extends ScatterModel
## A plant or stone with a separate mesh for each LOD. It builds itself when it is loaded, so a scene only stores its species and variant.

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

var _is_build_requested := false


func _init() -> void:
	_request_build()


func _validate_property(property: Dictionary) -> void:
	if property.name == "lods":
		property.usage &= ~PROPERTY_USAGE_STORAGE


func _request_build() -> void:
	if not _is_build_requested:
		_is_build_requested = true
		_build.call_deferred()


func _build() -> void:
	_is_build_requested = false
	var builder := Species.build(StringName(species), variant)
	var new_lods: Array[ScatterLod] = []
	for level in builder.level_count():
		var lod := ScatterLod.new()
		lod.mesh = builder.mesh_of(level, Materials.of(StringName(species)))
		lod.distance = builder.distance(level)
		new_lods.append(lod)
	lods = new_lods
