extends RefCounted
## A block of red sandstone, about 1 m high.

const Builder := preload("res://meshes/mesh_builder.gd")
const Stone := preload("res://meshes/stone.gd")
const LOW := Color(0.27, 0.16, 0.11, 0.7)
const HIGH := Color(0.5, 0.335, 0.23, 1.0)
const SHAPES: Array[Vector3] = [Vector3(1.1, 0.7, 0.9), Vector3(0.8, 1.15, 0.75), Vector3(1.3, 0.45, 1.0)]


## Builds the block. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	return Stone.build_of(2700 + variant, SHAPES[variant % SHAPES.size()], LOW, HIGH, 3)
