extends RefCounted
## A piece of red sandstone, about 1 m high. It has a quarter of the triangles of [code]sandstone.gd[/code], so that many pieces can be drawn.

const Builder := preload("res://meshes/mesh_builder.gd")
const Stone := preload("res://meshes/stone.gd")
const Sandstone := preload("res://meshes/sandstone.gd")
## Half the width, height and depth. Tall ones would look like eggs.
const SHAPES: Array[Vector3] = [Vector3(1.15, 0.55, 0.8), Vector3(0.85, 0.7, 1.05), Vector3(1.3, 0.38, 0.95)]


## Builds the rock. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	return Stone.build_of(2800 + variant, SHAPES[variant % SHAPES.size()], Sandstone.LOW, Sandstone.HIGH, 2)
