extends "harness.gd"
## Base class for the collision tests: a scatter whose instances have bodies, and methods that find these bodies.

const DISTANCE := 20.0

## Bodies beyond this multiple of the collision distance are removed.
const LEAVE := 1.16

## Tolerance for a body's size, which differs from its instance's size by at most 1 %.
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


## Casts a ray. Returns the hit as `intersect_ray` does, or an empty dictionary if it hits nothing.
func cast(from: Vector3, to: Vector3, mask := 0xffffffff) -> Dictionary:
	return space().intersect_ray(PhysicsRayQueryParameters3D.create(from, to, mask))


## Returns {instance ID: body} for all bodies within `reach` meters of a position.
func bodies(scatter: TerrainScatter3D, at := Vector3.ZERO, reach := 200.0) -> Dictionary[int, RID]:
	var sphere := SphereShape3D.new()
	sphere.radius = reach
	var query := PhysicsShapeQueryParameters3D.new()
	query.shape = sphere
	query.transform.origin = at
	var result: Dictionary[int, RID] = {}
	for hit in space().intersect_shape(query, 100000):
		var id := scatter.get_body_instance(hit["rid"])
		check(hit["collider"] == scatter, "the collider of a body is the scatter")
		check(id != 0 and not result.has(id), "one body for each instance")
		result[id] = hit["rid"]
	return result


## Checks that exactly the instances of `standing` near one of `centers` have bodies. Bodies are added within `distance` and removed beyond
## LEAVE times `distance`, so in between a body is optional. Checks only bodies within the default reach of the origin.
func check_bodies(scatter: TerrainScatter3D, standing: Dictionary[int, Transform3D], centers: PackedVector3Array,
		context: String, distance := DISTANCE) -> void:
	var found := bodies(scatter)
	var near := 0
	for id in standing:
		var away := INF
		for center in centers:
			away = minf(away, center.distance_to(standing[id].origin))
		if away <= distance:
			near += 1
			if not found.has(id):
				check(false, "%s: no body for an instance %.2f m away" % [context, away])
		elif away > LEAVE * distance and found.has(id):
			check(false, "%s: a body for an instance %.2f m away" % [context, away])
	for id in found:
		if not standing.has(id):
			check(false, "%s: a body without an instance" % context)
	check(near > 5, "%s: %d instances are near" % [context, near])
	check(scatter.get_stats()["bodies"] >= found.size(), "%s: bodies in the stats" % context)


## Returns the instance nearest to a position.
func nearest(scatter: TerrainScatter3D, at := Vector3.ZERO) -> ScatterInstance:
	return scatter.query_nearest(at, 100.0)


func middle(instance: ScatterInstance, height := 1.5) -> Vector3:
	return instance.transform * Vector3(0, height, 0)


## Casts a ray through the middle of an instance and returns the ID of the instance that it hits, or 0.
func hit_id(scatter: TerrainScatter3D, at: Transform3D) -> int:
	var across := at.basis.x.normalized() * 1.5 * at.basis.get_scale().x
	var middle_of := at * Vector3(0, 1.5, 0)
	var hit := cast(middle_of + across, middle_of)
	return scatter.get_body_instance(hit["rid"]) if hit else 0
