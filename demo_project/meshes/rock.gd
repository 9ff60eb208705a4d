extends RefCounted
## A rock, about 1 m high. It has a quarter of the triangles of [code]stone.gd[/code], so that many rocks can be drawn.

const Builder := preload("res://meshes/mesh_builder.gd")
const Stone := preload("res://meshes/stone.gd")


## Builds the rock. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	return Stone.build_of(1700 + variant, Stone.SHAPES[variant % Stone.SHAPES.size()], Stone.LOW, Stone.HIGH, 2)
