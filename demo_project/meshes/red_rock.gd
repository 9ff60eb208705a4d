extends RefCounted
## A piece of red sandstone of about 1 m, to be drawn small: among many others, with a quarter of the block's triangles.

const Builder := preload("res://meshes/mesh_builder.gd")
const Stone := preload("res://meshes/stone.gd")
const Sandstone := preload("res://meshes/sandstone.gd")


## Builds the rock with the number [param variant].
static func build(variant: int) -> Builder:
	return Stone.build_of(2800 + variant, Sandstone.SHAPES[variant % Sandstone.SHAPES.size()], Sandstone.LOW, Sandstone.HIGH, 2)
