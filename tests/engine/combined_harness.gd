extends "terrain_harness.gd"
## Base class for the tests of ScatterGroundCombined: a terrain, and a bridge above it.

const SIDE := 64.0
const BRIDGE := 16.0
const HEIGHT := 8.0
const DENSITY := 0.547 / (PI * 0.25) ## Points per square meter of surface at a radius of 1 m.

## Returns a square of heights around the origin. `slope` is the rise of the ground along x.
func make_terrain(slope := 0.0) -> ScatterGroundHeightmap:
	var posts := int(SIDE) + 1
	var image := Image.create_empty(posts, posts, false, Image.FORMAT_RF)
	for row in posts:
		for column in posts:
			var wave := sin(0.7 * column) * cos(0.5 * row) if slope == 0.0 else 0.0
			image.set_pixel(column, row, Color(wave + slope * (column - SIDE / 2.0), 0.0, 0.0))
	var terrain := ScatterGroundHeightmap.new()
	terrain.image = image
	terrain.heights_in_meters = true
	terrain.rect = Rect2(-SIDE / 2.0, -SIDE / 2.0, SIDE, SIDE)
	return terrain


func put_bridge(height := HEIGHT) -> MeshInstance3D:
	var mesh := PlaneMesh.new()
	mesh.size = Vector2(BRIDGE, BRIDGE)
	var instance := MeshInstance3D.new()
	instance.mesh = mesh
	instance.position.y = height
	instance.add_to_group(&"bridge")
	root.add_child(instance)
	return instance


func make_bridges() -> ScatterGroundMeshes:
	var meshes := ScatterGroundMeshes.new()
	meshes.group = &"bridge"
	return meshes


func combine(grounds: Array[ScatterGround]) -> ScatterGroundCombined:
	var combined := ScatterGroundCombined.new()
	combined.grounds = grounds
	return combined


func is_on_bridge(at: Vector3) -> bool:
	return absf(at.x) < BRIDGE / 2.0 and absf(at.z) < BRIDGE / 2.0


func make_dense(on_surfaces := false) -> ScatterLayer:
	var layer := make_layer(1.0)
	layer.on_surfaces = on_surfaces
	layer.tile_size = 16.0
	layer.layer_id = 4
	return layer


func check_heights(scatter: TerrainScatter3D, height_at: Callable) -> void:
	var standing := instances(scatter, 0).values()
	check(standing.size() > 200, "%d instances" % standing.size())
	for at: Transform3D in standing:
		var expected: float = height_at.call(at.origin)
		if not check(absf(at.origin.y - expected) < 0.01, "an instance at %s, expected height %f" % [at.origin, expected]):
			break
