extends RefCounted
## A low cushion of heather, 0.4 m high, partly in bloom.

const Builder := preload("res://meshes/mesh_builder.gd")
const Shrub := preload("res://meshes/shrub.gd")


## Builds the cushion. The number [param variant] determines its individual shape. Even variants are in bloom.
static func build(variant: int) -> Builder:
	var high := Color(0.5, 0.33, 0.43) if variant % 2 == 0 else Color(0.34, 0.36, 0.17)
	return Shrub.build_of(2300 + variant, Color(0.16, 0.19, 0.09), high, Vector2(0.42, 0.28), variant)
