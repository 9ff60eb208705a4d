extends Node3D
## The scene's root node. Prints the scene's instances and the results of ray casts on them.

func _ready() -> void:
	for scatter: TerrainScatter3D in find_children("*", "TerrainScatter3D"):
		while not scatter.is_settled():
			await get_tree().process_frame
		await get_tree().physics_frame
		await get_tree().physics_frame
		for layer in scatter.get_all_layers():
			print_layer(scatter, layer)
		print("problems: ", scatter.get_problems())
	get_tree().quit()


func print_layer(scatter: TerrainScatter3D, layer: ScatterLayer) -> void:
	var near := scatter.query_sphere(Vector3.ZERO, 28.0, layer)
	var hits := PackedInt64Array()
	for at in near.size():
		var top := near.get_position(at) + Vector3(0.3, 9.0, 0.2)
		var hit := get_world_3d().direct_space_state.intersect_ray(PhysicsRayQueryParameters3D.create(top, top + Vector3.DOWN * 9.5))
		hits.append(roundi(hit["position"].y * 100.0) if hit else -1)
	print("layer: %s: %d instances, %d hits, %d" % [layer.resource_name, near.size(), hits.size() - hits.count(-1), hash(hits)])
