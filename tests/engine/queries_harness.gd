extends "harness.gd"
## Base class for the query tests. Provides a wood, a scan of all its generated tiles, and checks of results against that scan.

const FLOATS := 2e-3 ## Tolerance in meters for single-precision rounding at these positions.
const AREA := Rect2(-96, -96, 192, 192) ## The scanned area. It consists of whole tiles in all layers.

## The instances that a scan found. Each array has one entry per instance.
class Scan:
	var ids: PackedInt64Array
	var layers: PackedInt32Array
	var meshes: PackedInt32Array
	var transforms: Array[Transform3D]

	## Generates all tiles of a layer in `area` one by one and adds their instances.
	func add(scatter: TerrainScatter3D, layer: int, area: Rect2) -> void:
		var size := scatter.layers[layer].tile_size
		for x in range(roundi(area.position.x / size), roundi(area.end.x / size)):
			for z in range(roundi(area.position.y / size), roundi(area.end.y / size)):
				var built := scatter.build_rect(scatter.layers[layer], Rect2(x * size, z * size, size, size))
				for mesh in built.get_mesh_count():
					_add_mesh(layer, mesh, built.get_origin(), built.get_ids(mesh), built.get_buffer(mesh))

	func _add_mesh(layer: int, mesh: int, origin: Vector3, mesh_ids: PackedInt64Array,
			buffer: PackedFloat32Array) -> void:
		var stride := buffer.size() / maxi(mesh_ids.size(), 1)
		for index in mesh_ids.size():
			ids.push_back(mesh_ids[index])
			layers.push_back(layer)
			meshes.push_back(mesh)
			transforms.push_back(TileBuffer.read(buffer, index * stride, origin))

	func without(gone: PackedInt64Array) -> Scan:
		var result := Scan.new()
		for index in ids.size():
			if not gone.has(ids[index]):
				result.ids.push_back(ids[index])
				result.layers.push_back(layers[index])
				result.meshes.push_back(meshes[index])
				result.transforms.push_back(transforms[index])
		return result


class TileBuffer:
	## Returns the transform whose 12 floats start at index `at` of a buffer, moved by `origin`.
	static func read(floats: PackedFloat32Array, at: int, origin := Vector3.ZERO) -> Transform3D:
		return Transform3D(
				Vector3(floats[at], floats[at + 4], floats[at + 8]),
				Vector3(floats[at + 1], floats[at + 5], floats[at + 9]),
				Vector3(floats[at + 2], floats[at + 6], floats[at + 10]),
				origin + Vector3(floats[at + 3], floats[at + 7], floats[at + 11]))


## Creates a scatter of leaning trees, and of ferns that are offset from their points and keep a distance from the trees. Tiles are 32 m wide for
## trees and 24 m for ferns.
func make_wood(viewer: Node3D) -> TerrainScatter3D:
	var trees := make_layer(4.0)
	trees.resource_name = "trees"
	trees.layer_id = 3
	trees.meshes = [BoxMesh.new(), SphereMesh.new()]
	trees.min_scale = 0.6
	trees.max_scale = 1.7
	trees.max_tilt_degrees = 20.0
	trees.instance_radius = 0.5
	trees.instance_height = 9.0
	var ferns := make_layer(1.6)
	ferns.layer_id = 4
	ferns.tile_size = 24.0
	ferns.align_to_normal = 1.0
	ferns.offset_along_normal = -1.2
	ferns.spacing = {"trees": 1.5}
	ferns.instance_radius = 0.7
	ferns.instance_height = 0.8
	ferns.use_custom_data = true
	var noise := FastNoiseLite.new()
	noise.frequency = 0.02
	var ground := ScatterGroundNoise.new()
	ground.noise = noise
	ground.amplitude = 9.0
	return make_scatter([trees, ferns], ground, viewer)


func layers_at(scatter: TerrainScatter3D, indices: PackedInt32Array) -> Array:
	return Array(indices).map(func(index: int) -> ScatterLayer: return scatter.layers[index])


func scan(scatter: TerrainScatter3D) -> Scan:
	var result := Scan.new()
	result.add(scatter, 0, AREA)
	result.add(scatter, 1, AREA)
	return result


## Compares a result with the scan's instances inside the queried shape. `depth` returns how many meters a position is inside the shape, or
## a negative value outside. Instances within the tolerance of its surface may be found or not. Returns the size of the result.
func check_answer(scatter: TerrainScatter3D, answer: ScatterInstances, all: Scan, layers: PackedInt32Array, depth: Callable, context: String) -> int:
	var ids := answer.ids
	var index_of_id := {}
	for index in ids.size():
		index_of_id[ids[index]] = index
	var wrong := 0
	for index in all.ids.size():
		var wanted := layers.is_empty() or layers.has(all.layers[index])
		var inside: float = depth.call(all.transforms[index].origin) if wanted else -1.0
		var at: int = index_of_id.get(all.ids[index], -1)
		if at < 0:
			wrong += int(inside > FLOATS)
			continue
		var stands := TileBuffer.read(answer.transforms, at * 12)
		wrong += int(inside < -FLOATS or answer.get_layer(at) != scatter.layers[all.layers[index]] or
				answer.get_mesh(at) != all.meshes[index] or stands.basis != all.transforms[index].basis or
				stands.origin.distance_to(all.transforms[index].origin) > FLOATS or
				answer.positions[at] != stands.origin or answer.get_position(at) != stands.origin or
				answer.get_transform(at) != stands or answer.get_id(at) != all.ids[index])
		index_of_id.erase(all.ids[index])
	check(wrong == 0 and index_of_id.is_empty(), "%s: %d wrong, %d too many of %d" % [context, wrong, index_of_id.size(), ids.size()])
	var of_layers := answer.layer_indices
	for index in range(1, ids.size()):
		if of_layers[index - 1] == of_layers[index] and ids[index - 1] >= ids[index]:
			check(false, context + ": sorted by id")
	return ids.size()


## Returns where a ray first touches an instance's cylinder, as a fraction of the ray's length. Returns 2 if it misses.
func first_touch(layer: ScatterLayer, at: Transform3D, from: Vector3, to: Vector3) -> float:
	var inverse := at.affine_inverse()
	var start := inverse * from
	var way := inverse * to - start
	var shares: Array[float] = [0.0, -start.y / way.y, (layer.instance_height - start.y) / way.y]
	var a := way.x * way.x + way.z * way.z
	var b := start.x * way.x + start.z * way.z
	var c := start.x * start.x + start.z * start.z - layer.instance_radius ** 2
	shares.push_back((-b - sqrt(b * b - a * c)) / a if b * b > a * c else 2.0)
	var first := 2.0
	for share in shares:
		var touch := start + share * way
		var inside := touch.y > -1e-4 and touch.y < layer.instance_height + 1e-4 and \
				Vector2(touch.x, touch.z).length() < layer.instance_radius + 1e-4
		if share >= 0.0 and share <= 1.0 and inside:
			first = minf(first, share)
	return first


func check_ray(scatter: TerrainScatter3D, all: Scan, from: Vector3, to: Vector3, layers: PackedInt32Array) -> bool:
	var first := 2.0
	var id := 0
	for index in all.ids.size():
		if layers.is_empty() or layers.has(all.layers[index]):
			var touch := first_touch(scatter.layers[all.layers[index]], all.transforms[index], from, to)
			if touch < first:
				first = touch
				id = all.ids[index]
	var hit := scatter.query_ray(from, to, layers_at(scatter, layers))
	var same: bool = hit == null if first > 1.0 else \
			hit != null and absf(hit.distance - first * from.distance_to(to)) < 0.01 and \
			hit.hit_position.distance_to(from.lerp(to, first)) < 0.01
	check(same, "a ray from %s to %s hits %d at %f: %s" % [from, to, id, first, hit.id if hit != null else 0])
	return first <= 1.0


func check_nearest(scatter: TerrainScatter3D, all: Scan, at: Vector3, distance: float,
		layers: PackedInt32Array) -> bool:
	var best := INF
	var id := 0
	for index in all.ids.size():
		var to := all.transforms[index].origin.distance_to(at)
		if (layers.is_empty() or layers.has(all.layers[index])) and to < best:
			best = to
			id = all.ids[index]
	if absf(best - distance) < FLOATS:
		return false
	var found := scatter.query_nearest(at, distance, layers_at(scatter, layers))
	var same: bool = found == null if best > distance else \
			found != null and found.id == id and absf(found.distance - best) < FLOATS
	check(same, "nearest to %s is %d, %f m away: %s" % [at, id, best, found])
	return best < distance


## Runs random queries of all kinds in the middle of AREA, where the scan contains every possible result.
func check_all(scatter: TerrainScatter3D, all: Scan, random: RandomNumberGenerator, context: String) -> void:
	var counts := {"rect": 0, "sphere": 0, "hits": 0, "near": 0}
	for round in 14:
		var layers: PackedInt32Array = [[], [], [0], [1], [1, 0]][random.randi() % 5]
		var at := Vector3(random.randf_range(-50, 50), random.randf_range(-4, 20), random.randf_range(-50, 50))
		var rect := Rect2(at.x, at.z, random.randf_range(0, 30), random.randf_range(0, 30))
		counts["rect"] += check_answer(scatter, scatter.query_rect(rect, layers_at(scatter, layers)), all, layers, func(point: Vector3) -> float:
			return minf(minf(point.x - rect.position.x, rect.end.x - point.x),
					minf(point.z - rect.position.y, rect.end.y - point.z)), "%s: %s" % [context, rect])
		var radius := random.randf_range(0.5, 30)
		counts["sphere"] += check_answer(scatter, scatter.query_sphere(at, radius, layers_at(scatter, layers)), all, layers,
				func(point: Vector3) -> float: return radius - point.distance_to(at), "%s: sphere" % context)
		var mark := all.transforms[random.randi() % all.ids.size()].origin.clamp(-50 * Vector3.ONE, 50 * Vector3.ONE)
		var away := Vector3(random.randf_range(-1, 1), random.randf_range(0, 0.5), random.randf_range(-1, 1))
		var from := mark + away * random.randf_range(0, 30)
		counts["hits"] += int(check_ray(scatter, all, from, mark - away * 10.0, layers))
		counts["near"] += int(check_nearest(scatter, all, at, random.randf_range(0.5, 20), layers))
		var any := random.randi() % all.ids.size()
		var found := scatter.get_instance(all.ids[any])
		check(found != null and found.id == all.ids[any] and found.layer == scatter.layers[all.layers[any]] and
				found.mesh == all.meshes[any] and not found.added and scatter.has_instance(all.ids[any]) and
				found.position.distance_to(all.transforms[any].origin) < FLOATS, "get_instance")
	check(counts["rect"] > 200 and counts["sphere"] > 500 and counts["hits"] > 2 and counts["near"] > 2,
			"%s: results %s" % [context, counts])
