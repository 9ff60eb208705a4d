extends "collision_harness.gd"
## Tests that collision bodies share shapes and are reused.


## Returns a model with one convex collision shape.
func make_convex_model() -> ScatterModel:
	var lod := ScatterLod.new()
	lod.mesh = BoxMesh.new()
	var hull := ConvexPolygonShape3D.new()
	hull.points = [Vector3(-1, 0, -1), Vector3(1, 0, -1), Vector3(0, 0, 1), Vector3(0, 3, 0)]
	var model := ScatterModel.new()
	model.lods = [lod]
	model.shapes = [hull]
	return model


## For each kind of shape, bodies of the same size share one shape.
func test_shapes_are_shared() -> void:
	var kinds: Array[ScatterLayer.CollisionShape] = [
		ScatterLayer.COLLISION_CYLINDER, ScatterLayer.COLLISION_CONVEX, ScatterLayer.COLLISION_MODEL]
	for shape in kinds:
		var layer := make_solid_layer(shape)
		if shape == ScatterLayer.COLLISION_MODEL:
			layer.meshes = [make_convex_model()]
		var scatter := make_solid([layer])
		await settle(scatter)
		var shapes := {}
		var found := bodies(scatter)
		for id in found:
			shapes[PhysicsServer3D.body_get_shape(found[id], 0)] = true
		check(found.size() > 20, "%d bodies" % found.size())
		check_equal(shapes.size(), 1, "their shapes")
		scatter.free()
		viewer.free()


## A pooled body is reused for another instance before a new one is created.
func test_bodies_are_reused() -> void:
	var scatter := make_solid([make_solid_layer()])
	var counts: Array[int] = []
	for step in 4:
		viewer.position.x = 300.0 * step
		await settle(scatter)
		var stats := scatter.get_stats()
		counts.push_back(stats["bodies"] + stats["bodies_pooled"])
		check(stats["bodies"] > 20, "%d bodies at position %d" % [stats["bodies"], step])
		await frames(140) # A removed body is not reused for 128 frames, because callers may still look up its instance.
	check(counts[1] > 1.5 * counts[0], "at the second position, the first bodies are not reused yet: %s" % [counts])
	check(counts[3] < 1.2 * counts[1], "later they are reused: %s" % [counts])
	scatter.free()
