extends SceneTree
## Prints the content of each tile of an exported world, as a line of JSON for each node. Argument: the path of the
## index.


const Index := preload("res://addons/thicket/baked_world_index.gd")
const Tile := preload("res://addons/thicket/baked_world_tile.gd")


func _initialize() -> void:
	var index := Index.new()
	index.read(OS.get_cmdline_user_args()[0])
	var meshes: Array[Mesh] = []
	for mesh in index.meshes:
		meshes.append(load(mesh))
	for number in index.instances.size():
		var tile := Vector2i(index.tiles[2 * number], index.tiles[2 * number + 1])
		var file := Tile.new(index, number, meshes, [])
		file.run()
		for node: MultiMeshInstance3D in file.node.get_children():
			var multimesh := node.multimesh
			print("node ", JSON.stringify({
				"tile": [tile.x, tile.y],
				"center": [index.centers[3 * number], index.centers[3 * number + 1], index.centers[3 * number + 2]],
				"name": node.name,
				"mesh": multimesh.mesh.resource_path,
				"surfaces": multimesh.mesh.get_surface_count(),
				"height": multimesh.mesh.get_aabb().size.y,
				"colors": multimesh.use_colors,
				"custom": multimesh.use_custom_data,
				"buffer": Marshalls.raw_to_base64(multimesh.buffer.to_byte_array()),
				"begin": node.visibility_range_begin,
				"end": node.visibility_range_end,
				"box": [node.custom_aabb.position.x, node.custom_aabb.position.y, node.custom_aabb.position.z,
					node.custom_aabb.end.x, node.custom_aabb.end.y, node.custom_aabb.end.z],
			}))
		file.drop()
	quit()
