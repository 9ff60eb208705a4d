extends "models_harness.gd"
## Tests models in a layer's meshes: entries, LODs by distance, bodies, and rejected input.

const RADIUS := 6.0


## Returns a layer of these models whose radius keeps bodies apart.
func make_model_layer(entries: Array) -> ScatterLayer:
	var layer := make_layer(RADIUS)
	layer.meshes = entries
	return layer


func test_models_and_meshes_have_the_same_instances() -> void:
	var viewer := make_viewer()
	var plain := make_model_layer([BoxMesh.new(), BoxMesh.new()])
	plain.mesh_weights = [1.0, 3.0]
	var scatter := make_scatter([plain], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	var tiles := scatter.get_shown_tiles(scatter.layers[0])
	var digests := tiles.map(func(tile: Vector2i) -> int: return scatter.get_tile(scatter.layers[0], tile).get_digest())
	var model := ScatterModel.new()
	model.scene = pack(make_tree())
	plain.meshes = [pack(make_tree()), model]
	await settle(scatter)
	check(tiles.size() > 10 and scatter.get_shown_tiles(scatter.layers[0]) == tiles, "tiles")
	for index in tiles.size():
		var tile := scatter.get_tile(scatter.layers[0], tiles[index])
		check_equal(tile.get_digest(), digests[index], "digest of tile %s" % tiles[index])
		check_equal(tile.get_mesh(1), model.get_mesh(), "the mesh that is drawn")
		check_equal(tile.get_mesh(0).get_surface_count(), 2, "the merged mesh of all parts of the scene")
	var read := scatter.get_tile(scatter.layers[0], tiles[0]).get_mesh(0)
	plain.meshes = [BoxMesh.new(), plain.meshes[0]]
	await settle(scatter)
	check_equal(scatter.get_tile(scatter.layers[0], tiles[0]).get_mesh(1), read, "an entry that stays in the list is not read again")


func test_entries() -> void:
	var model := ScatterModel.new()
	model.scene = pack(make_tree())
	var scene := pack(make_tree())
	var mesh := BoxMesh.new()
	var layer := make_model_layer([mesh, scene, model, null])
	check_equal(layer.meshes, [mesh, scene, model, null], "the list reads back")
	layer.meshes = [mesh, ImageTexture.new()]
	check_error(["ScatterLayer.meshes[1]", "ImageTexture"], "a resource of another class")
	layer.meshes = ["res://tree.glb"]
	check_error(["ScatterLayer.meshes[0]", "not a resource"], "a string")
	layer.meshes = [mesh, PackedScene.new()]
	check_error(["ScatterModel.scene", "it is empty"], "an empty scene")
	check_equal(layer.meshes, [mesh, scene, model, null], "the old list stays")
	var many := []
	many.resize(257)
	layer.meshes = many
	check_error(["ScatterLayer.meshes", "257"], "too many")
	var typed: Array[Mesh] = [mesh]
	layer.meshes = typed
	check_equal(layer.meshes.size(), 1, "a typed list is accepted")

	# A layer that is being loaded has no list yet, so it keeps invalid entries and reports them.
	var loaded := ScatterLayer.new()
	var empty := PackedScene.new()
	loaded.meshes = [empty]
	check_error(["ScatterModel.scene", "it is empty"], "an empty scene while loading")
	check_equal(loaded.meshes, [empty], "the entry stays in the list")
	var scatter := make_scatter([loaded], ScatterGroundFlat.new(), make_viewer())
	var problems := "\n".join(scatter.get_problems())
	check("ScatterLayer.meshes[0], a scene without a file, has nothing to draw: it is empty" in problems, "reported: " + problems)


## Scripts share the list with the layer, so changes in place take effect.
func test_a_list_that_is_changed_in_place() -> void:
	var layer := make_model_layer([BoxMesh.new()])
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var list := layer.meshes
	list.append(pack(make_tree()))
	check(not scatter.is_settled(), "the node detects the change immediately")
	await settle(scatter)
	var tile := scatter.get_tile(scatter.layers[0], scatter.get_shown_tiles(scatter.layers[0])[0])
	check_equal(tile.get_mesh_count(), 2, "the tile also draws the added scene")
	check_equal(tile.get_mesh(1).get_surface_count(), 2, "the mesh has both surfaces of the added scene")
	list[0] = null
	await settle(scatter)
	check(scatter.get_tile(scatter.layers[0], scatter.get_shown_tiles(scatter.layers[0])[0]).get_mesh(0) == null, "the removed entry is not drawn")
	var kept := list.duplicate()
	list.append(ImageTexture.new())
	await settle(scatter)
	check_error(["ScatterLayer.meshes[2]", "ImageTexture"], "a rejected change")
	check_equal(layer.meshes, kept, "the old list is restored")
	layer.meshes.resize(257)
	await settle(scatter)
	check_error(["ScatterLayer.meshes", "257"], "too many")
	check_equal(layer.meshes, kept, "the old list is restored again")
	layer.meshes.resize(1)
	check_equal(layer.get_materials().size(), 0, "getters use the current list")
	await settle(scatter)


## A scene is read on demand. If that fails, the error is reported once, and the entry draws nothing.
func test_entries_that_cannot_be_drawn() -> void:
	var hollow := pack(Node3D.new())
	var layer := make_model_layer([BoxMesh.new()])
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	layer.meshes = [BoxMesh.new(), hollow]
	check_no_error("setting an entry reads nothing")
	await settle(scatter)
	check_error(["ScatterModel.scene", "no visible MeshInstance3D"], "the node reports the entry when it reads the scene")
	check_equal(layer.meshes[1], hollow, "the entry stays in the list")
	check(scatter.get_tile(scatter.layers[0], scatter.get_shown_tiles(scatter.layers[0])[0]).get_mesh(1) == null, "the entry draws nothing")
	layer.density = 0.5
	await settle(scatter)
	check_no_error("the scene is not read again")
	var problems := "\n".join(scatter.get_problems())
	check("ScatterLayer.meshes[1], a scene without a file, has nothing to draw: it has no visible" in problems, "reported: " + problems)


## Two scenes that inherit from each other. The engine does not load them, so an entry of [member ScatterLayer.meshes] with such a scene is null and
## draws nothing. If the file of [member ScatterModel.scene] becomes such a scene, [method ScatterModel.reload] fails and the model does not change.
func test_circular_scenes() -> void:
	for name: String in ["one", "other"]:
		var file := FileAccess.open("user://%s.tscn" % name, FileAccess.WRITE)
		file.store_string('[gd_scene load_steps=2 format=3]\n\n[ext_resource type="PackedScene" path="user://%s.tscn" id="1"]\n\n'
				% ("other" if name == "one" else "one"))
		file.store_string('[node name="Tree" instance=ExtResource("1")]\n')
	var scene := pack(make_tree())
	var layer := make_model_layer([scene, load("user://one.tscn")])
	check(not errors.take().is_empty(), "the engine prints an error")
	check(layer.meshes[0] == scene and layer.meshes[1] == null, "the entry draws nothing")
	var model := ScatterModel.new()
	model.scene = scene
	model.scene.take_over_path("user://one.tscn")
	check(not model.reload(), "a model whose file has become circular")
	var problems := errors.take()
	check(problems.has("ScatterModel.scene: user://one.tscn cannot be loaded. Check that the file exists and can be opened."), "reported: %s" % problems)
	check_equal(model.lods.size(), 3, "the model does not change")


func test_lods_of_models_and_of_meshes_together() -> void:
	var viewer := make_viewer()
	var model := ScatterModel.new()
	model.scene = pack(make_tree())
	model.scene = null
	model.lods[1].distance = 20.0
	model.lods[2].distance = 50.0
	var near := BoxMesh.new()
	var far := BoxMesh.new()
	var layer := make_model_layer(with_lods([near, model], [[far, null]], [35.0]))
	layer.tile_size = 8.0
	layer.view_distance = 80.0
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	var seen := {}
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		var displayed_tile := scatter.get_tile(scatter.layers[0], tile)
		for entry in 2:
			var multimesh := displayed_tile.get_multimesh(entry)
			if multimesh.is_valid():
				seen[[entry, RenderingServer.multimesh_get_mesh(multimesh)]] = true
	if DisplayServer.get_name() != "headless": # The headless renderer does not store multimeshes.
		check_equal(seen.size(), 5, "meshes: two of the first entry, three of the second")
	check_no_error("LODs")


func test_bodies_match_the_scene() -> void:
	var packed := pack(make_tree())
	var layer := make_model_layer([packed])
	layer.collision_shape = ScatterLayer.COLLISION_MODEL
	layer.collision_distance = 30.0
	layer.min_scale = 0.7
	layer.max_scale = 1.6
	layer.min_tilt_degrees = 0.0
	layer.max_tilt_degrees = 20.0
	var viewer := make_viewer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	await physics_frame
	var found := scatter.query_sphere(Vector3.ZERO, 22.0)
	check(found.size() > 20, "%d instances" % found.size())
	# Places the scene far from all instances. Rays in the space of an instance must hit both at the same points.
	var alone := packed.instantiate() as Node3D
	root.add_child(alone)
	alone.position = Vector3(0, 500, 0)
	await physics_frame
	await physics_frame
	var random := RandomNumberGenerator.new()
	random.seed = 5
	var hits := 0
	var differ := 0
	for index in mini(found.size(), 40):
		var at := found.get_transform(index)
		var size := at.basis.get_scale().x
		for ray in 30:
			var from := Vector3(random.randf_range(-4, 4), random.randf_range(0.2, 6), random.randf_range(-4, 4))
			var to := Vector3(random.randf_range(-0.6, 0.6), random.randf_range(0.2, 5), random.randf_range(-0.6, 0.6))
			var expected := cast(alone.position + from, alone.position + to)
			var got := cast(at * from, at * to)
			if got and scatter.get_body_instance(got["rid"]) != found.get_id(index):
				continue # The ray hits a neighbor first.
			hits += int(not expected.is_empty())
			if expected.is_empty() != got.is_empty():
				differ += 1 # The ray grazes the edge of a body whose size is rounded.
			elif expected:
				var apart := (at.affine_inverse() * (got["position"] as Vector3)).distance_to(expected["position"] - alone.position)
				differ += int(apart > 0.08)
	check(hits > 400, "%d hits" % hits)
	check(differ < hits / 40, "%d of %d rays differ" % [differ, hits])


func cast(from: Vector3, to: Vector3) -> Dictionary:
	return root.world_3d.direct_space_state.intersect_ray(PhysicsRayQueryParameters3D.create(from, to))


## far_lods adds an LOD beyond those of the model's scene, as baking an impostor does.
func test_far_lods() -> void:
	var model := ScatterModel.new()
	model.scene = pack(make_tree())
	var far := QuadMesh.new()
	var layer := make_model_layer([model])
	model.far_lods = [null, make_lod(null, 10.0), make_lod(far, 40.0)]
	check_equal(model.lods.size(), 3, "the scene's LODs")
	check_equal(layer.get_mesh_lods(0).filter(func(lod: ScatterLod) -> bool: return lod.mesh == far).size(), 1, "LODs of the layer with the far mesh")
	layer.tile_size = 16.0
	layer.view_distance = 90.0
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var triangles: int = scatter.get_draw_stats()["triangles"]
	model.far_lods = []
	check_no_error("LODs behind a scene")
	var many: Array[ScatterLod] = []
	many.resize(17)
	model.far_lods = many
	check_error(["ScatterModel.far_lods", "17"], "too many")
	check_equal(model.far_lods.size(), 0, "the list is unchanged")
	await settle(scatter)
	check(triangles < scatter.get_draw_stats()["triangles"], "far trees are quads: %d triangles" % triangles)


## A game's changes and bakes apply to whole models.
func test_changes_and_bakes() -> void:
	var layer := make_model_layer([pack(make_tree()), BoxMesh.new()])
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	scatter.state = ScatterState.new()
	await settle(scatter)
	var tile: Vector2i = scatter.get_shown_tiles(scatter.layers[0])[0]
	var digest := scatter.get_tile(scatter.layers[0], tile).get_digest()
	var id := scatter.get_tile(scatter.layers[0], tile).get_ids(0)[0]
	check(scatter.remove_instance(id), "a tree is removed")
	var added := scatter.add_instance(scatter.layers[0], Transform3D(Basis(), scatter.get_tile(scatter.layers[0], tile).get_origin()), 0)
	await settle(scatter)
	check(added != 0 and scatter.get_tile(scatter.layers[0], tile).get_ids(0).has(added), "a tree is added")
	check_equal(scatter.get_tile(scatter.layers[0], tile).get_mesh(0).get_surface_count(), 2, "the added tree is complete")
	check(scatter.restore_instance(id) and scatter.remove_instance(added), "both changes are undone")
	await settle(scatter)
	check_equal(scatter.get_tile(scatter.layers[0], tile).get_digest(), digest, "the tile's digest after both changes were undone")
	var bake: RefCounted = load("res://addons/thicket/bake.gd").new()
	check_equal(bake.begin(scatter, Rect2(0, 0, 32, 32), "res://baked", "models"), OK, "started")
	while bake.step(100.0):
		await process_frame
	check_equal(bake.problem, "", "no problem")
	var scene := (load("res://baked/models.tscn") as PackedScene).instantiate()
	var surfaces := scene.get_children().map(func(node: MultiMeshInstance3D) -> int: return node.multimesh.mesh.get_surface_count())
	surfaces.sort()
	check_equal(surfaces, [1, 2], "surfaces of the baked box and the baked tree")
	scene.free()


func box_of(size: Vector3) -> BoxMesh:
	return box(size, null)


func test_a_reimported_scene_is_read_again() -> void:
	ResourceSaver.save(pack(make_tree()), "user://oak.tscn")
	var layer := make_model_layer([load("user://oak.tscn")])
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var tile: Vector2i = scatter.get_shown_tiles(scatter.layers[0])[0]
	check_equal(scatter.get_tile(scatter.layers[0], tile).get_mesh(0).get_surface_count(), 2, "surfaces before the scene is reimported")
	var other := Node3D.new()
	put_mesh(box_of(Vector3.ONE * 3.0), "Block", other, other)
	ResourceSaver.save(pack(other), "user://oak.tscn")
	layer.reload_scenes(["user://elm.tscn"])
	await settle(scatter)
	check_equal(scatter.get_tile(scatter.layers[0], tile).get_mesh(0).get_surface_count(), 2, "surfaces after another file has changed")
	layer.reload_scenes(["user://oak.tscn"])
	await settle(scatter)
	check_equal(scatter.get_tile(scatter.layers[0], tile).get_mesh(0).get_aabb().size, Vector3.ONE * 3.0, "the model's size after the scene was reimported")


## A scene's root node that runs an action when it is instantiated.
class ActingNode extends Node3D:
	static var action: Callable

	func _init() -> void:
		if action.is_valid():
			action.call()


func pack_acting_node() -> PackedScene:
	var action := ActingNode.action
	ActingNode.action = Callable()
	var root_node := ActingNode.new()
	put_mesh(box_of(Vector3.ONE), "Stone", root_node, root_node)
	ActingNode.action = action
	return pack(root_node)


func test_scripts_in_a_scene_run_while_it_is_read() -> void:
	var acting := pack_acting_node()
	var scatter := make_scatter([make_model_layer([BoxMesh.new()])], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var layer := scatter.layers[0]
	ActingNode.action = func() -> void: layer.meshes = []
	layer.meshes = [acting]
	check_equal(layer.meshes, [acting], "setting the list runs no script")
	await settle(scatter)
	check_equal(layer.meshes, [], "the change that the script made while the scene was read is kept")
	for action: Callable in [func() -> void: scatter.free(), func() -> void: root.remove_child(scatter)]:
		ActingNode.action = action
		layer.reload_scenes([""]) # This call reads nothing, because no file matches.
		layer.meshes = [SphereMesh.new()]
		layer.meshes = [pack_acting_node()]
		await frames(3)
	check(was_kept_from_being_freed(), "the engine refuses to free a node in the middle of a call")
	check(not scatter.is_inside_tree() and layer.meshes.size() == 1, "the node is outside of the tree, and the layer is unchanged")
	scatter.free()
	var model := ScatterModel.new()
	var tree := pack(make_tree())
	ActingNode.action = func() -> void:
		ActingNode.action = Callable()
		check(model.get_mesh() == null, "a model has no mesh while it is read")
		model.scene = tree
	model.scene = acting
	check_equal(model.get_mesh().get_surface_count(), 2, "surfaces of the scene that a script set while another one was read")
	check_equal(model.scene, tree, "the property has the new scene")
	ActingNode.action = Callable()
