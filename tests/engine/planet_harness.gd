extends "collision_harness.gd"
## Shared parts of the tests of planets: ground, layers and regions.

const SPACING := 2.0


## Adds a sphere of ground. The distance of its flat facets from the sphere is less than a hundredth of the radius.
func put_planet(planet_radius: float, center := Vector3.ZERO, segments := 256) -> MeshInstance3D:
	var mesh := SphereMesh.new()
	mesh.radius = planet_radius
	mesh.height = 2.0 * planet_radius
	mesh.radial_segments = segments
	@warning_ignore("integer_division")
	mesh.rings = segments / 2
	var instance := MeshInstance3D.new()
	instance.mesh = mesh
	instance.position = center
	instance.add_to_group(&"ground")
	root.add_child(instance)
	return instance


func make_ground(planet_radius: float, center := Vector3.ZERO) -> ScatterGroundMeshes:
	var ground := ScatterGroundMeshes.new()
	ground.group = &"ground"
	ground.planet_radius = planet_radius
	ground.planet_center = center
	return ground


func make_grower(spacing := SPACING) -> ScatterLayer:
	var layer := make_layer(spacing)
	layer.on_surfaces = true
	layer.tile_size = 64.0
	layer.view_distance = 100.0
	return layer


func direction(latitude: float) -> Vector3:
	return Vector3(cos(deg_to_rad(latitude)), sin(deg_to_rad(latitude)), 0.0).rotated(Vector3.UP, 0.3)


func clean() -> void:
	for node in get_nodes_in_group(&"ground"):
		node.free()
	await super()


## Returns the transforms within `reach` meters of a position.
func near(standing: Dictionary[int, Transform3D], at: Vector3, reach: float) -> Dictionary[int, Transform3D]:
	var result: Dictionary[int, Transform3D] = {}
	for id in standing:
		if standing[id].origin.distance_to(at) < reach:
			result[id] = standing[id]
	return result


func make_region(shape: ScatterRegion3D.Shape, up: Vector3, altitude := 0.0) -> ScatterRegion3D:
	var region := ScatterRegion3D.new()
	region.shape = shape
	var side := up.cross(Vector3(0.3, 0.2, 0.9)).normalized()
	region.transform = Transform3D(Basis(side, up, side.cross(up)), up * (100.0 + altitude))
	return region
