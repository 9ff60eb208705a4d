extends RefCounted
## The scripts of all plants and stones, by name. Each has a function [code]build(variant)[/code], which returns a builder with all LODs.

const Builder := preload("res://meshes/mesh_builder.gd")
const SCRIPTS := {
	&"oak": preload("res://meshes/oak.gd"),
	&"birch": preload("res://meshes/birch.gd"),
	&"spruce": preload("res://meshes/spruce.gd"),
	&"pine": preload("res://meshes/pine.gd"),
	&"shrub": preload("res://meshes/shrub.gd"),
	&"heather": preload("res://meshes/heather.gd"),
	&"dry_shrub": preload("res://meshes/dry_shrub.gd"),
	&"fern": preload("res://meshes/fern.gd"),
	&"grass": preload("res://meshes/grass.gd"),
	&"flower": preload("res://meshes/flower.gd"),
	&"reed": preload("res://meshes/reed.gd"),
	&"cactus": preload("res://meshes/cactus.gd"),
	&"agave": preload("res://meshes/agave.gd"),
	&"stone": preload("res://meshes/stone.gd"),
	&"sandstone": preload("res://meshes/sandstone.gd"),
	&"rock": preload("res://meshes/rock.gd"),
	&"red_rock": preload("res://meshes/red_rock.gd"),
	&"pebbles": preload("res://meshes/pebbles.gd"),
	&"stump": preload("res://meshes/stump.gd"),
	&"log": preload("res://meshes/log.gd"),
	&"moss": preload("res://meshes/moss.gd"),
	&"ivy": preload("res://meshes/ivy.gd"),
	&"mushroom": preload("res://meshes/mushroom.gd"),
	&"stalactite": preload("res://meshes/stalactite.gd"),
}


## Builds a variant of a species, which must be a key of [constant SCRIPTS].
static func build(species: StringName, variant: int) -> Builder:
	return SCRIPTS[species].build(variant)
