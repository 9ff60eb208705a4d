extends RefCounted
## Builds models for the impostor tests: a tree with a trunk and leaf cards, and a stone.


static func tree() -> ArrayMesh:
	var mesh := ArrayMesh.new()
	var trunk := CylinderMesh.new()
	trunk.height = 3.0
	trunk.top_radius = 0.1
	trunk.bottom_radius = 0.25
	trunk.radial_segments = 10
	var moved := SurfaceTool.new()
	moved.append_from(trunk, 0, Transform3D(Basis.IDENTITY, Vector3(0.0, 1.5, 0.0)))
	moved.commit(mesh)
	var bark := StandardMaterial3D.new()
	bark.albedo_color = Color(0.36, 0.27, 0.18)
	mesh.surface_set_material(0, bark)
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, _crown(380))
	var leaves := StandardMaterial3D.new()
	leaves.albedo_texture = ImageTexture.create_from_image(_leaves())
	leaves.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA_SCISSOR
	leaves.alpha_scissor_threshold = 0.4
	leaves.cull_mode = BaseMaterial3D.CULL_DISABLED
	leaves.vertex_color_use_as_albedo = true
	leaves.vertex_color_is_srgb = true # The Compatibility renderer always assumes sRGB.
	mesh.surface_set_material(1, leaves)
	return mesh


## Returns the arrays of leaf cards spread through an ellipsoid. They face outward, each in a random shade.
static func _crown(count: int) -> Array:
	var random := RandomNumberGenerator.new()
	random.seed = 5
	var tool := SurfaceTool.new()
	tool.begin(Mesh.PRIMITIVE_TRIANGLES)
	for card in count:
		var out := Vector3(random.randfn(), random.randfn(), random.randfn()).normalized()
		var at := Vector3(0.0, 3.8, 0.0) + out * Vector3(1.7, 1.5, 1.7) * sqrt(random.randf_range(0.2, 1.0))
		var basis := Basis(Vector3(random.randfn(), random.randfn(), random.randfn()).normalized(), random.randf() * TAU)
		if basis.z.dot(out) < 0.0:
			basis = basis.rotated(basis.y, PI)
		tool.set_color(Color.from_hsv(random.randf_range(0.22, 0.34), 0.4, random.randf_range(0.7, 1.0)))
		tool.set_normal(out)
		for corner: Vector2 in [Vector2(0, 0), Vector2(1, 0), Vector2(1, 1), Vector2(0, 0), Vector2(1, 1), Vector2(0, 1)]:
			tool.set_uv(corner)
			tool.add_vertex(at + basis * Vector3(corner.x - 0.5, 0.5 - corner.y, 0.0) * 0.7)
	return tool.commit_to_arrays()


## Returns an image of a clump of pointed leaves. Alpha is 0 around them.
static func _leaves() -> Image:
	var image := Image.create_empty(128, 128, false, Image.FORMAT_RGBA8)
	image.fill(Color(0.3, 0.42, 0.16, 0.0))
	var random := RandomNumberGenerator.new()
	random.seed = 3
	for leaf in 12:
		var middle := Vector2(random.randf_range(26, 102), random.randf_range(26, 102))
		var along := Vector2.from_angle(random.randf() * TAU)
		var color := Color.from_hsv(random.randf_range(0.2, 0.3), 0.7, random.randf_range(0.4, 0.8))
		for y in 128:
			for x in 128:
				var from := Vector2(x, y) - middle
				if absf(from.dot(along)) / 22.0 + absf(from.cross(along)) / 10.0 < 1.0:
					image.set_pixel(x, y, color)
	image.generate_mipmaps()
	return image


static func stone() -> ArrayMesh:
	var sphere := SphereMesh.new()
	sphere.radial_segments = 48
	sphere.rings = 24
	var noise := FastNoiseLite.new()
	noise.seed = 2
	noise.frequency = 0.8
	var arrays := sphere.get_mesh_arrays()
	var vertices: PackedVector3Array = arrays[Mesh.ARRAY_VERTEX]
	for index in vertices.size():
		var out := vertices[index].normalized()
		vertices[index] = out * Vector3(1.3, 0.8, 1.0) * (1.0 + 0.35 * noise.get_noise_3dv(out * 2.0)) + Vector3(0.0, 0.6, 0.0)
	arrays[Mesh.ARRAY_VERTEX] = vertices
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	var tool := SurfaceTool.new()
	tool.create_from(mesh, 0)
	tool.generate_normals()
	mesh = tool.commit()
	var gray := StandardMaterial3D.new()
	var spots := Image.create_empty(64, 64, false, Image.FORMAT_RGB8)
	for y in 64:
		for x in 64:
			var shade := 0.45 + 0.2 * noise.get_noise_2d(x * 0.4, y * 0.4)
			spots.set_pixel(x, y, Color(shade, shade * 0.97, shade * 0.9))
	spots.generate_mipmaps()
	gray.albedo_texture = ImageTexture.create_from_image(spots)
	gray.roughness = 0.9
	mesh.surface_set_material(0, gray)
	return mesh
