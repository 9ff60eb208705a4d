extends "terrain_harness.gd"
## Tests ground from meshes whose data was updated in the renderer only.


func test_updated_vertices_are_ground_after_refresh_ground() -> void:
	var plane := PlaneMesh.new()
	plane.size = Vector2(40.0, 40.0)
	for compressed: bool in [false, true]:
		var mesh := ArrayMesh.new()
		var flags := Mesh.ARRAY_FLAG_COMPRESS_ATTRIBUTES if compressed else 0
		var arrays := plane.get_mesh_arrays()
		if compressed: # Compressed vertices are fractions of the surface's AABB, which must have a height.
			arrays[Mesh.ARRAY_VERTEX].append(Vector3(0.0, 5.0, 0.0))
			arrays[Mesh.ARRAY_NORMAL].append(Vector3.UP)
			arrays[Mesh.ARRAY_TANGENT].append_array([1.0, 0.0, 0.0, 1.0])
			arrays[Mesh.ARRAY_TEX_UV].append(Vector2.ZERO)
		mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays, [], {}, flags)
		var instance := MeshInstance3D.new()
		instance.mesh = mesh
		instance.add_to_group(&"ground")
		root.add_child(instance)
		var terrain := ScatterGroundMeshes.new()
		terrain.group = &"ground"
		var layer := make_layer(1.0)
		layer.tile_size = 8.0
		var scatter := make_scatter([layer], terrain, make_viewer())
		await settle(scatter)
		check(all_transforms(scatter).all(func(one: Transform3D) -> bool: return absf(one.origin.y) < 1e-4), "all instances are at height 0 at first")
		check(mesh.get_faces().size() > 0, "the engine caches its faces from now on")
		var raised := PackedByteArray()
		for vertex in 4:
			var at: Vector3 = arrays[Mesh.ARRAY_VERTEX][vertex]
			if compressed:
				var numbers := PackedByteArray()
				numbers.resize(8)
				numbers.encode_u16(0, roundi((at.x + 20.0) / 40.0 * 65535.0))
				numbers.encode_u16(2, 65535)
				numbers.encode_u16(4, roundi((at.z + 20.0) / 40.0 * 65535.0))
				raised.append_array(numbers)
			else:
				raised.append_array(PackedFloat32Array([at.x, 5.0, at.z]).to_byte_array())
		mesh.surface_update_vertex_region(0, 0, raised)
		mesh.emit_changed()
		scatter.refresh_ground()
		await settle(scatter)
		check(absf(terrain.get_height(Vector3(1.0, 0.0, 2.0)) - 5.0) < 1e-3, "compressed %s: the ground is updated" % compressed)
		var stand := all_transforms(scatter)
		check(stand.size() > 300 and stand.all(func(one: Transform3D) -> bool: return absf(one.origin.y - 5.0) < 1e-3),
				"compressed %s: %d plants on it" % [compressed, stand.size()])
		scatter.free()
		instance.free()
		check_no_error("compressed %s" % compressed)


func test_an_updated_texture_is_ground() -> void:
	var image := Image.create_empty(257, 257, false, Image.FORMAT_RF)
	var texture := ImageTexture.create_from_image(image)
	var terrain := ScatterGroundHeightmap.new()
	terrain.heights_in_meters = true
	terrain.rect = Rect2(-128.0, -128.0, 256.0, 256.0)
	terrain.image = texture
	var layer := make_layer(1.0)
	layer.tile_size = 8.0
	var scatter := make_scatter([layer], terrain, make_viewer())
	await settle(scatter)
	for by_region: bool in [false, true]:
		var region := Rect2i(120, 122, 10, 4)
		var height := 4.0 if by_region else 3.0
		image.fill_rect(region, Color(height, 0.0, 0.0))
		var regenerated_tiles := await regenerated_by(scatter, func() -> void:
				texture.update(image)
				if by_region:
					terrain.update_region(region)
				else:
					texture.emit_changed())
		check(regenerated_tiles.size() >= 4 and regenerated_tiles.size() <= 9, "by region %s: %d tiles were regenerated" % [by_region, regenerated_tiles.size()])
		check_equal(terrain.get_height(Vector3(125.0 - 128.0, 0.0, 124.0 - 128.0)), height, "by region %s: height" % by_region)
		check(all_transforms(scatter).any(func(one: Transform3D) -> bool: return one.origin.y > height - 0.2), "plants are updated")
	check_no_error("an updated texture")
