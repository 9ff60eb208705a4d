extends "collision_harness.gd"
## Shapes are shared by bodies, and bodies are used again.


## All bodies of the same size have one shape, whichever kind it is of.
func test_shapes_are_shared() -> void:
	for shape: ScatterLayer.CollisionShape in [ScatterLayer.COLLISION_CYLINDER, ScatterLayer.COLLISION_CONVEX]:
		var scatter := make_solid([make_solid_layer(shape)])
		await settle(scatter)
		var shapes := {}
		var found := bodies(scatter)
		for id in found:
			shapes[PhysicsServer3D.body_get_shape(found[id], 0)] = true
		check(found.size() > 20, "%d bodies" % found.size())
		check_equal(shapes.size(), 1, "their shapes")
		scatter.free()
		viewer.free()


## A body that has rested stands for another instance before a new one is made.
func test_bodies_are_used_again() -> void:
	var scatter := make_solid([make_solid_layer()])
	var counts: Array[int] = []
	for place in 4:
		viewer.position.x = 300.0 * place
		await settle(scatter)
		var stats := scatter.get_stats()
		counts.push_back(stats["bodies"] + stats["bodies_pooled"])
		check(stats["bodies"] > 20, "%d bodies at place %d" % [stats["bodies"], place])
		await frames(140) # What has fallen rests for a while, for who still asks for it.
	check(counts[1] > 1.5 * counts[0], "at the second place those of the first rest: %s" % [counts])
	check(counts[3] < 1.2 * counts[1], "then they stand again: %s" % [counts])
	scatter.free()
