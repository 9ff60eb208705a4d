extends "terrain_harness.gd"
## Tests meshes as ground: every kind of mesh is read within the frame budget or rejected with a reason.

const HALF := 4.0 ## Distance from the middle of a mesh, in meters, within which heights are compared.


func put(mesh: Mesh, at := Vector3.ZERO) -> MeshInstance3D:
	var instance := MeshInstance3D.new()
	instance.mesh = mesh
	instance.position = at
	instance.add_to_group(&"ground")
	root.add_child(instance)
	return instance


func make_on_meshes(budget_usec := 20000) -> TerrainScatter3D:
	var terrain := ScatterGroundMeshes.new()
	terrain.group = &"ground"
	var layer := make_layer(1.0)
	layer.tile_size = 8.0
	var scatter := make_scatter([layer], terrain, make_viewer())
	scatter.frame_budget_usec = budget_usec
	return scatter


## Returns vertices that zigzag over the ground, valid both as a strip and as triangles.
func zigzag(count := 24) -> PackedVector3Array:
	var vertices := PackedVector3Array()
	for index in count:
		vertices.push_back(Vector3(0.3 * index - 3.6, sin(index * 0.7), 3.0 if index % 2 == 0 else -2.5))
	return vertices


func arrays_of(vertices: Variant, indices: Variant = null) -> Array:
	var arrays := []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = vertices
	arrays[Mesh.ARRAY_INDEX] = indices
	return arrays


func mesh_of(primitive: Mesh.PrimitiveType, arrays: Array, flags := 0) -> ArrayMesh:
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(primitive, arrays, [], {}, flags)
	return mesh


func with_normals(vertices: PackedVector3Array) -> Array:
	var arrays := arrays_of(vertices)
	var normals := PackedVector3Array()
	normals.resize(vertices.size())
	normals.fill(Vector3.UP)
	arrays[Mesh.ARRAY_NORMAL] = normals
	return arrays


func plane(subdivisions: int, height := 0.0) -> PlaneMesh:
	var mesh := PlaneMesh.new()
	mesh.size = Vector2(2.0 * HALF, 2.0 * HALF)
	mesh.subdivide_width = subdivisions
	mesh.subdivide_depth = subdivisions
	mesh.center_offset.y = height
	return mesh


## A mesh whose script returns its arrays.
class ScriptedMesh extends Mesh:
	var arrays: Array
	var primitive := Mesh.PRIMITIVE_TRIANGLES
	var on_read := Callable()

	func _get_surface_count() -> int:
		return 1

	func _surface_get_array_len(_surface: int) -> int:
		return arrays[Mesh.ARRAY_VERTEX].size()

	func _surface_get_array_index_len(_surface: int) -> int:
		return 0

	func _surface_get_arrays(_surface: int) -> Array:
		if on_read.is_valid():
			on_read.call()
		return arrays

	func _surface_get_format(_surface: int) -> int:
		return Mesh.ARRAY_FORMAT_VERTEX

	func _surface_get_primitive_type(_surface: int) -> int:
		return primitive

	func _get_blend_shape_count() -> int:
		return 0

	func _surface_get_lods(_surface: int) -> Dictionary:
		return {}

	func _surface_get_material(_surface: int) -> Material:
		return null

	func _get_aabb() -> AABB:
		return AABB(Vector3.ONE * -4.0, Vector3.ONE * 8.0)


func odd_meshes() -> Dictionary[String, Mesh]:
	var flat := PackedVector2Array()
	for vertex in zigzag():
		flat.push_back(Vector2(vertex.x, vertex.z))
	var reversed := PackedInt32Array(range(23, -1, -1))
	var result: Dictionary[String, Mesh] = {
		"triangles": mesh_of(Mesh.PRIMITIVE_TRIANGLES, arrays_of(zigzag())),
		"indexed triangles": mesh_of(Mesh.PRIMITIVE_TRIANGLES, arrays_of(zigzag(), PackedInt32Array([0, 1, 2, 2, 1, 3, 9, 4, 6]))),
		"a strip": mesh_of(Mesh.PRIMITIVE_TRIANGLE_STRIP, arrays_of(zigzag())),
		"an indexed strip": mesh_of(Mesh.PRIMITIVE_TRIANGLE_STRIP, arrays_of(zigzag(), reversed)),
		"compressed": mesh_of(Mesh.PRIMITIVE_TRIANGLES, with_normals(zigzag()), Mesh.ARRAY_FLAG_COMPRESS_ATTRIBUTES),
		"compressed, vertices only": mesh_of(Mesh.PRIMITIVE_TRIANGLES, arrays_of(zigzag()), Mesh.ARRAY_FLAG_COMPRESS_ATTRIBUTES),
		"flat vertices": mesh_of(Mesh.PRIMITIVE_TRIANGLES, arrays_of(flat), Mesh.ARRAY_FLAG_USE_2D_VERTICES),
		"points": mesh_of(Mesh.PRIMITIVE_POINTS, arrays_of(zigzag())),
		"lines": mesh_of(Mesh.PRIMITIVE_LINE_STRIP, arrays_of(zigzag())),
		"more vertices than two bytes can count": mesh_of(Mesh.PRIMITIVE_TRIANGLES, plane(300).get_mesh_arrays()),
		"no surface": ArrayMesh.new(),
		"a placeholder": PlaceholderMesh.new(),
		"a box": BoxMesh.new(),
		"a torus": TorusMesh.new(),
		"a prism": PrismMesh.new(),
	}
	var many := mesh_of(Mesh.PRIMITIVE_LINES, arrays_of(zigzag()))
	many.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays_of(zigzag(6)))
	many.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLE_STRIP, arrays_of(zigzag(5), PackedInt32Array([4, 2, 3, 1])))
	result["lines, triangles and a strip"] = many
	var drawn := ImmediateMesh.new()
	drawn.surface_begin(Mesh.PRIMITIVE_TRIANGLES)
	for vertex in zigzag(9):
		drawn.surface_add_vertex(vertex)
	drawn.surface_end()
	result["an immediate mesh"] = drawn
	for primitive: Mesh.PrimitiveType in [Mesh.PRIMITIVE_TRIANGLES, Mesh.PRIMITIVE_TRIANGLE_STRIP, Mesh.PRIMITIVE_LINES]:
		var scripted := ScriptedMesh.new()
		scripted.arrays = arrays_of(zigzag())
		scripted.primitive = primitive
		result["a scripted mesh, primitive %d" % primitive] = scripted
	return result


## Returns the height of the topmost face at a position on the map, or NAN if there is none.
func top_of(faces: PackedVector3Array, at: Vector2) -> float:
	var top := NAN
	for first in range(0, faces.size(), 3):
		var a := faces[first]
		var b := faces[first + 1]
		var c := faces[first + 2]
		var area := (b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x)
		if absf(area) < 1e-9:
			continue
		var of_b := ((at.x - a.x) * (c.z - a.z) - (at.y - a.z) * (c.x - a.x)) / area
		var of_c := ((b.x - a.x) * (at.y - a.z) - (b.z - a.z) * (at.x - a.x)) / area
		if of_b >= 0.0 and of_c >= 0.0 and of_b + of_c <= 1.0:
			var height := a.y + of_b * (b.y - a.y) + of_c * (c.y - a.y)
			top = height if is_nan(top) else maxf(top, height)
	return top


## The library reads the same faces as the engine's TriangleMesh, which Mesh.get_faces returns.
func test_faces_match_the_engine() -> void:
	var scatter := make_on_meshes()
	for named: String in odd_meshes():
		var mesh := odd_meshes()[named]
		var instance := put(mesh)
		if named == "flat vertices":
			instance.rotation.x = -PI / 3.0 # Lay the mesh down, because it is vertical.
		await settle(scatter)
		check_no_error(named)
		var faces := mesh.get_faces()
		if "two bytes" in named:
			faces = plane(0).get_faces() # Two faces cover the same square.
		if "vertices only" in named:
			errors.take() # The engine fails to decode these meshes and prints errors.
			faces = zigzag()
		for index in faces.size():
			faces[index] = instance.global_transform * faces[index]
		var random := RandomNumberGenerator.new()
		random.seed = 5
		var wrong := 0
		var hits := 0
		for point in 300:
			var at := Vector2(random.randf_range(-HALF, HALF), random.randf_range(-HALF, HALF))
			var expected := top_of(faces, at)
			var height := scatter.ground.get_height(Vector3(at.x, 0.0, at.y))
			hits += int(not is_nan(expected))
			# The engine rounds vertices to 0.1 mm, so a point on an edge may be on either side.
			wrong += int(is_nan(height) != is_nan(expected) or absf(height - expected) > 0.01)
		check(wrong <= 2, "%s: %d of 300 heights differ" % [named, wrong])
		check((hits > 3) == (faces.size() > 0), "%s: %d points on %d faces" % [named, hits, faces.size() / 3])
		instance.free()


func test_surfaces_without_whole_triangles_are_skipped() -> void:
	var mesh := mesh_of(Mesh.PRIMITIVE_TRIANGLES, arrays_of(zigzag(22)))
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays_of(PackedVector3Array([
			Vector3(-1.0, 7.0, -1.0), Vector3(1.0, 7.0, -1.0), Vector3(0.0, 7.0, 1.0)])))
	put(mesh)
	var scatter := make_on_meshes()
	await settle(scatter)
	check_equal(scatter.ground.get_height(Vector3.ZERO), 7.0, "the second surface is ground")
	check(is_nan(scatter.ground.get_height(Vector3(-3.0, 0.0, 0.0))), "22 vertices are not whole triangles")


## A frame with no time left reads one surface, and the next frame reads the next surface.
func test_reading_keeps_to_the_budget() -> void:
	const SURFACES := 12
	var mesh := ArrayMesh.new()
	for surface in SURFACES:
		mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, plane(2).get_mesh_arrays())
	put(mesh)
	put(plane(1, 1.0))
	var scatter := make_on_meshes(1)
	var frames_before := 0
	while scatter.get_stats()["ground_reads"] < 2 and frames_before < 200:
		check(not scatter.is_settled(), "not settled before all surfaces are read")
		await process_frame
		frames_before += 1
	check(frames_before >= SURFACES, "%d surfaces took %d frames" % [SURFACES, frames_before])
	await settle(scatter)
	check_equal(scatter.ground.get_height(Vector3.ZERO), 1.0, "all surfaces are ground")


## Plants stay on the old ground until a worker has built the new one.
func test_the_old_ground_stays_until_the_new_one_is_built() -> void:
	var instance := put(plane(0))
	var scatter := make_on_meshes()
	await settle(scatter)
	var shown_count := scatter.get_shown_count(scatter.layers[0])
	check(shown_count > 30, "%d instances" % shown_count)
	instance.mesh = mesh_of(Mesh.PRIMITIVE_TRIANGLES, plane(400, 2.0).get_mesh_arrays())
	var minimum := shown_count
	var heights := {}
	await until(func() -> bool:
			minimum = mini(minimum, scatter.get_shown_count(scatter.layers[0]))
			heights[scatter.ground.get_height(Vector3(0.5, 0.0, 0.5))] = true
			return heights.has(2.0), "the new ground is used")
	check_equal(heights.keys(), [0.0, 2.0], "the old ground, then the new one")
	await settle(scatter)
	check(minimum > shown_count / 2, "at least %d of %d instances at any time" % [minimum, shown_count])
	var heads := all_transforms(scatter)
	check(heads.all(func(one: Transform3D) -> bool: return absf(one.origin.y - 2.0) < 1e-4), "all instances are on the new ground")


## Frames read a node's first ground gradually, but a query reads it immediately.
func test_a_query_reads_the_ground_immediately() -> void:
	put(plane(10))
	var scatter := make_on_meshes()
	check(scatter.query_rect(Rect2(-HALF, -HALF, 2.0 * HALF, 2.0 * HALF)).size() > 20, "instances in the node's first frame")
	var terrain: ScatterGroundMeshes = scatter.ground
	put(plane(10, 3.0)).add_to_group(&"other")
	terrain.group = &"other"
	var found := scatter.query_rect(Rect2(-HALF, -HALF, 2.0 * HALF, 2.0 * HALF))
	check(found.size() > 20 and Array(found.positions).all(func(at: Vector3) -> bool: return absf(at.y - 3.0) < 1e-4), "instances on the new group")


## refresh_ground finds changes in the renderer's data, which emit no signal.
func test_refresh_ground_reads_the_renderers_data() -> void:
	var mesh := mesh_of(Mesh.PRIMITIVE_TRIANGLES, plane(1).get_mesh_arrays())
	put(mesh)
	var scatter := make_on_meshes()
	await settle(scatter)
	check_equal(mesh.get_faces().size(), 24, "the engine caches its faces from now on")
	RenderingServer.mesh_clear(mesh.get_rid())
	RenderingServer.mesh_add_surface_from_arrays(mesh.get_rid(), RenderingServer.PRIMITIVE_TRIANGLES, plane(1, 4.0).get_mesh_arrays())
	mesh.emit_changed()
	scatter.refresh_ground()
	await settle(scatter)
	check_equal(scatter.ground.get_height(Vector3(0.5, 0.0, 0.5)), 4.0, "the ground is updated")
	check(all_transforms(scatter).all(func(one: Transform3D) -> bool: return absf(one.origin.y - 4.0) < 1e-4), "plants are updated")


func test_a_transform_that_is_not_finite() -> void:
	put(plane(0), Vector3(20.0, 0.0, 0.0))
	var instance := put(plane(0))
	instance.name = "Broken"
	var scatter := make_on_meshes()
	await settle(scatter)
	var shown_count := scatter.get_shown_count(scatter.layers[0])
	for bad: Transform3D in [Transform3D(Basis(), Vector3(NAN, 0.0, 0.0)), Transform3D(Basis(), Vector3(0.0, INF, 0.0)),
			Transform3D(Basis.from_scale(Vector3(1.0, NAN, 1.0)), Vector3.ZERO)]:
		instance.global_transform = bad
		await create_timer(0.3).timeout
		if not await settle(scatter):
			return
		var messages := Array(errors.take()).filter(func(error: String) -> bool: return "ScatterGroundMeshes" in error) # The engine also prints an error.
		check(messages.size() == 1 and "\"Broken\"" in messages[0] and "global_transform" in messages[0] and "finite" in messages[0], "a transform of %s: %s" % [bad, messages])
		await create_timer(0.6).timeout
		check_no_error("reported once")
		check("\"Broken\"" in "\n".join(scatter.get_problems()), "get_problems names the node")
		check_equal(scatter.get_shown_count(scatter.layers[0]), shown_count, "the instances do not change")
		instance.global_transform = Transform3D()
		await settle(scatter)
		check_equal(scatter.get_problems().size(), 0, "no problems with a finite transform")


func test_invalid_corners_are_rejected() -> void:
	put(plane(0), Vector3(20.0, 0.0, 0.0))
	var vertices := zigzag(6)
	vertices[4].y = NAN
	put(mesh_of(Mesh.PRIMITIVE_TRIANGLES, arrays_of(vertices))).name = "Hole"
	var far := put(plane(0))
	far.name = "Far"
	far.scale = Vector3.ONE * 1e8
	var scatter := make_on_meshes()
	await settle(scatter)
	var messages := errors.take()
	check_equal(messages.size(), 2, "a corner of NAN, and one far away")
	for error in messages:
		for word: String in ["ScatterGroundMeshes", "corner at (", "finite", "10000000"]:
			check(word in error, "%s in '%s'" % [word, error])
	check(scatter.get_shown_count(scatter.layers[0]) > 30, "the valid mesh is ground")
	var problems := "\n".join(scatter.get_problems())
	check(("\"Hole\"" in problems or "\"Far\"" in problems) and "1 other" in problems, problems)
	await create_timer(0.6).timeout
	check(scatter.is_settled(), "settled")
	check_no_error("reported once")
	scatter.refresh_ground()
	await settle(scatter)
	check_no_error("the same reason is not reported again")
	far.scale = Vector3.ONE
	await settle(scatter)
	check("\"Hole\"" in "\n".join(scatter.get_problems()), "the other mesh is still rejected")
	check(is_finite(scatter.ground.get_height(Vector3(0.5, 0.0, 0.5))), "the mesh that was too large is ground now")


## A mesh's script runs while the mesh is read, and may change the node then.
func test_a_scripted_mesh_changes_the_node() -> void:
	var meddling: Dictionary[String, Callable] = {
		"change": func(_scatter: TerrainScatter3D, mesh: Mesh) -> void: mesh.emit_changed(),
		"refresh": func(scatter: TerrainScatter3D, mesh: ScriptedMesh) -> void:
			mesh.on_read = Callable()
			(scatter.ground as ScatterGroundMeshes).refresh(),
		"group": func(scatter: TerrainScatter3D, mesh: ScriptedMesh) -> void:
			mesh.on_read = Callable()
			(scatter.ground as ScatterGroundMeshes).group = &"none",
		"terrain": func(scatter: TerrainScatter3D, _mesh: Mesh) -> void: scatter.ground = null,
		"leave": func(scatter: TerrainScatter3D, _mesh: Mesh) -> void: root.remove_child(scatter),
	}
	for how in meddling:
		var mesh := ScriptedMesh.new()
		mesh.arrays = arrays_of(zigzag())
		var instance := put(mesh)
		var scatter := make_on_meshes()
		var calls := [0]
		mesh.on_read = func() -> void:
			calls[0] += 1
			meddling[how].call(scatter, mesh)
		await frames(20)
		check(calls[0] > 0 and calls[0] < 40, "%s: %d calls" % [how, calls[0]])
		mesh.on_read = Callable() # The callback refers to the mesh.
		scatter.free()
		instance.free()
		check_no_error(how)


## A tile that is only kept in case the viewer returns disappears together with its ground, before the ground is rebuilt. A tile in view is replaced
## instead, by one without instances.
func test_tiles_out_of_view_disappear_with_their_ground() -> void:
	var chunks: Array[MeshInstance3D] = []
	for index in 16:
		chunks.push_back(put(plane(40), Vector3(8.0 * index + HALF, 0.0, HALF)))
	var scatter := make_on_meshes()
	var layer: ScatterLayer = scatter.layers[0]
	layer.view_distance = 64.0
	await settle(scatter)
	(scatter.get_node(scatter.viewers[0]) as Node3D).position.x = 67.5 + 8.0
	await settle(scatter)
	var tiles := scatter.get_shown_tiles(layer)
	check(tiles.has(Vector2i(0, 0)) and tiles.has(Vector2i(1, 0)), "both tiles are visible: %s" % [tiles])
	chunks[0].free()
	chunks[2].free()
	await frames(2)
	tiles = scatter.get_shown_tiles(layer)
	check(not tiles.has(Vector2i(0, 0)), "the tile out of view is hidden after two frames")
	check(tiles.has(Vector2i(2, 0)), "the tile in view is still visible")
	await settle(scatter)
	check(scatter.get_shown_tiles(layer).has(Vector2i(2, 0)) and scatter.get_tile(layer, Vector2i(2, 0)).is_empty(), "the tile in view is empty now")
	check(not scatter.get_tile(layer, Vector2i(1, 0)).is_empty(), "the tile between them is unchanged")
