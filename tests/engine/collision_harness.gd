extends "harness.gd"
## What the tests of bodies share: a scatter whose instances have bodies, and ways to find them.

const DISTANCE := 20.0

## Beyond this share of the distance no body stands, whatever was near before.
const LEAVE := 1.16

## Bodies are up to 1 % larger or smaller than their instance.
const SIZE_ERROR := 0.011

var viewer: Node3D


func make_solid_layer(shape := ScatterLayer.COLLISION_CYLINDER) -> ScatterLayer:
	var layer := make_layer(4.0)
	layer.collision_shape = shape
	layer.collision_distance = DISTANCE
	layer.instance_radius = 0.6
	layer.instance_height = 3.0
	return layer


func make_solid(layers: Array[ScatterLayer], at := Vector3.ZERO) -> TerrainScatter3D:
	viewer = make_viewer(at)
	return make_scatter(layers, ScatterGroundFlat.new(), viewer)


func space() -> PhysicsDirectSpaceState3D:
	return root.world_3d.direct_space_state


## The hit of a ray, empty for none.
func cast(from: Vector3, to: Vector3, mask := 0xffffffff) -> Dictionary:
	return space().intersect_ray(PhysicsRayQueryParameters3D.create(from, to, mask))


## The RIDs of all bodies around a place, by the ids of their instances.
func bodies(scatter: TerrainScatter3D, at := Vector3.ZERO, reach := 200.0) -> Dictionary[int, RID]:
	var sphere := SphereShape3D.new()
	sphere.radius = reach
	var query := PhysicsShapeQueryParameters3D.new()
	query.shape = sphere
	query.transform.origin = at
	var result: Dictionary[int, RID] = {}
	for hit in space().intersect_shape(query, 100000):
		var id := scatter.get_body_instance(hit["rid"])
		check(hit["collider"] == scatter, "bodies belong to the scatter")
		check(id != 0 and not result.has(id), "a body for each instance")
		result[id] = hit["rid"]
	return result


## Checks that exactly those have bodies that are near one of `centers`, among instances by their ids; what is between coming and going
## may have one. Bodies beyond `reach` of the origin are not looked at.
func check_bodies(scatter: TerrainScatter3D, standing: Dictionary[int, Transform3D], centers: PackedVector3Array,
		what: String, distance := DISTANCE) -> void:
	var found := bodies(scatter)
	var near := 0
	for id in standing:
		var away := INF
		for center in centers:
			away = minf(away, center.distance_to(standing[id].origin))
		if away <= distance:
			near += 1
			if not found.has(id):
				check(false, "%s: no body %.2f m away" % [what, away])
		elif away > LEAVE * distance and found.has(id):
			check(false, "%s: a body %.2f m away" % [what, away])
	for id in found:
		if not standing.has(id):
			check(false, "%s: a body where nothing stands" % what)
	check(near > 5, "%s: %d instances near" % [what, near])
	check(scatter.get_stats()["bodies"] >= found.size(), "%s: bodies in the stats" % what)


## An instance near a place, and whose body it is.
func nearest(scatter: TerrainScatter3D, at := Vector3.ZERO) -> ScatterInstance:
	return scatter.query_nearest(at, 100.0)


func middle(instance: ScatterInstance, height := 1.5) -> Vector3:
	return instance.transform * Vector3(0, height, 0)


## A ray through the middle of an instance: the id of what it hits, 0 for nothing.
func hit_id(scatter: TerrainScatter3D, at: Transform3D) -> int:
	var across := at.basis.x.normalized() * 1.5 * at.basis.get_scale().x
	var middle_of := at * Vector3(0, 1.5, 0)
	var hit := cast(middle_of + across, middle_of)
	return scatter.get_body_instance(hit["rid"]) if hit else 0
