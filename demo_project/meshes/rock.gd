extends RefCounted
## A rock of about 1 m, to be drawn small: among many others, with a quarter of the stone's triangles.

const Builder := preload("res://meshes/mesh_builder.gd")
const Stone := preload("res://meshes/stone.gd")


## Builds the rock with the number [param variant].
static func build(variant: int) -> Builder:
	return Stone.build_of(1700 + variant, Stone.SHAPES[variant % Stone.SHAPES.size()], Stone.LOW, Stone.HIGH, 2)
