extends "import_harness.gd"
## Tests imports of existing instances as hand-placed instances. Transforms are exact, and a failed import does not change the scatter.


func test_add_instances_equals_many_calls_to_add_instance() -> void:
	var layer := make_layer()
	layer.density = 0.0
	layer.meshes = [BoxMesh.new(), SphereMesh.new()]
	var scatter := make_bare([layer])
	var all := some_transforms(3000)
	all[5] = all[4] # With equal transforms, the second instance gets the next free ID.
	var meshes := PackedInt32Array()
	for index in all.size():
		meshes.push_back(index % 2)
	meshes[5] = meshes[4]
	var added_ids: Array[int] = []
	scatter.instance_added.connect(func(id: int, _layer: ScatterLayer, _at: Transform3D) -> void: added_ids.push_back(id))
	var ids := scatter.add_instances(layer, floats_of_transforms(all), meshes)
	check_equal(ids.size(), all.size(), "all instances are placed")
	var other := make_bare([layer])
	for index in all.size():
		var id := other.add_instance(other.layers[0], all[index], meshes[index])
		if id != ids[index]:
			check(false, "the ID of instance %d is wrong" % index)
	check_equal(scatter.state.to_bytes(), other.state.to_bytes(), "the same state, byte for byte")
	check_placed(scatter, 0, all, "exact")
	check_equal(scatter.get_instance(ids[7]).mesh, 1, "the instance has the requested mesh")
	scatter.viewers = [scatter.get_path_to(make_viewer())]
	await settle(scatter)
	check_equal(PackedInt64Array(added_ids), ids, "each instance emits one signal, in order")
	var some := ids.slice(0, 2000)
	some.push_back(some[0])
	some.push_back(-12345)
	check_equal(scatter.remove_instances(some), ids.slice(0, 2000), "existing instances are removed")
	check_placed(scatter, 0, all.slice(2000), "the other instances stay")
	var again := scatter.add_instances(scatter.layers[0], floats_of_transforms(all.slice(0, 2000)), meshes.slice(0, 2000))
	check_equal(again, ids.slice(0, 2000), "added again, the instances have the same IDs")
	var by_rule := make_layer()
	var mixed := make_bare([by_rule])
	var point := mixed.query_rect(Rect2(0, 0, 20, 20)).get_id(0)
	var hand := mixed.add_instances(mixed.layers[0], floats_of_transforms([Transform3D()]))[0]
	check_equal(mixed.remove_instances(PackedInt64Array([point, hand])), PackedInt64Array([point, hand]), "generated instances are removed, too")
	check(mixed.state.is_removed(point) and not mixed.has_instance(hand), "both instances are removed")


func test_add_instances_adds_all_or_none() -> void:
	var scatter := make_bare([make_layer()])
	var floats := floats_of_transforms(some_transforms(10))
	scatter.add_instances(scatter.layers[0], floats.slice(1))
	check_error(["add_instances", "transforms", 119], "a missing float")
	scatter.add_instances(scatter.layers[0], floats, PackedInt32Array([1]))
	check_error(["add_instances", "meshes", 1], "one mesh for ten")
	scatter.add_instances("larch", floats)
	check_error(["add_instances", "\"larch\""], "no such layer")
	scatter.add_instances(scatter.layers[0], floats, PackedInt32Array([0, 0, 0, -1, 0, 0, 0, 0, 0, 0]))
	check_error(["transform 3", "mesh", -1], "a missing mesh")
	for bad: float in [NAN, INF, 2e9]:
		var broken := floats.duplicate()
		broken[6 * 12 + 3] = bad
		check(scatter.add_instances(scatter.layers[0], broken).is_empty(), "invalid transforms add no instances")
		check_error(["transform 6", "position"], "a position of %s" % bad)
	floats[12 + 1] = NAN
	scatter.add_instances(scatter.layers[0], floats)
	check_error(["transform 1", "basis"], "a basis of NAN")
	check(scatter.state == null or scatter.state.get_added_count() == 0, "no instance was added")
	check_equal(scatter.add_instances(scatter.layers[0], PackedFloat32Array()), PackedInt64Array(), "an empty array adds no instances")
	scatter.ground = null
	scatter.add_instances(scatter.layers[0], PackedFloat32Array())
	check_error(["add_instances", "ground"], "without a ground")


func test_multimeshes() -> void:
	var box := BoxMesh.new()
	box.resource_name = "Crate"
	var ball := SphereMesh.new()
	var layer := make_layer()
	layer.density = 0.0
	layer.meshes = [CylinderMesh.new(), box]
	var scatter := make_bare([layer])
	var top := Node3D.new()
	top.name = "Old"
	root.add_child(top)
	var plain := some_transforms(50)
	var moved := some_transforms(60)
	var hidden := some_transforms(20)
	top.add_child(make_multimesh(box, plain))
	var node := make_multimesh(ball, moved, true)
	node.transform = Transform3D(Basis.from_euler(Vector3(0.1, 0.7, -0.2)), Vector3(3, 1, -8))
	node.name = "Balls"
	top.add_child(node)
	var cut := make_multimesh(ball, hidden)
	cut.multimesh.visible_instance_count = 5
	top.add_child(cut)
	var red := make_multimesh(box, some_transforms(3))
	red.material_override = StandardMaterial3D.new()
	red.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	red.layers = 4
	top.add_child(red)
	top.add_child(MultiMeshInstance3D.new())
	check_equal(ImportInstances.from_node(scatter, null, top), 118, "all visible instances are imported")
	check_equal(scatter.layers.size(), 3, "two layers are added")
	check_placed(scatter, 0, plain, "the mesh of a layer")
	check_equal(scatter.query_rect(Rect2(-100, -100, 200, 200), scatter.layers[0]).get_mesh(0), 1, "the instance has that mesh")
	var placed: Array[Transform3D] = []
	for each in moved:
		placed.push_back(node.global_transform * each)
	check_placed(scatter, 1, placed + hidden.slice(0, 5), "a new layer")
	check(scatter.layers[1].meshes == [ball] and scatter.layers[1].density == 0.0 and scatter.layers[1].layer_id >= 0, "the new layer has only this mesh, and only hand-placed instances")
	var painted := scatter.layers[2]
	check(painted.material_override == red.material_override and painted.cast_shadow == 0 and painted.render_layers == 4, "the layer has the node's drawing settings")
	check_equal(painted.resource_name, "Crate", "the layer is named after its mesh")
	var again := make_bare([layer])
	check_equal(ImportInstances.from_node(again, "all", top), 0, "no such layer")
	check_error(["add_instances", "all"], "no such layer")
	layer.resource_name = "all"
	check_equal(ImportInstances.from_node(again, "all", top), 118, "all instances are imported into one layer")
	check_equal(again.layers.size(), 1, "no layer is added")


func test_failed_imports_have_no_effect() -> void:
	var layer := make_layer()
	var scatter := make_bare([layer])
	var top := Node3D.new()
	root.add_child(top)
	check_equal(ImportInstances.from_node(scatter, null, null), 0, "no node")
	check_error(["no node"], "no node")
	check_equal(ImportInstances.from_node(scatter, null, top), 0, "an empty node")
	check_error(["no instances"], "an empty node")
	top.add_child(make_multimesh(BoxMesh.new(), some_transforms(5)))
	var bare := make_multimesh(null, some_transforms(5))
	bare.name = "Bare"
	top.add_child(bare)
	check_equal(ImportInstances.from_node(scatter, null, top), 0, "a multimesh without a mesh")
	check_error(["Bare", "mesh"], "a multimesh without a mesh")
	bare.free()
	var broken := make_multimesh(SphereMesh.new(), [Transform3D(Basis(), Vector3(2e9, 0, 0))])
	top.add_child(broken)
	check_equal(ImportInstances.from_node(scatter, null, top), 0, "a transform too far away")
	check_error(["transform 0", "position"], "a transform too far away")
	check_equal(scatter.layers, [layer] as Array[ScatterLayer], "the layers are unchanged")
	check_equal(scatter.state.get_added_count(), 0, "no instance was added")


## Returns nodes like those of ProtonScatter 4: an output with one node per item.
func proton_output(items: Array[Node]) -> Node3D:
	var scatter := Node3D.new()
	scatter.name = "Proton"
	scatter.position = Vector3(10, 0, 0)
	var source := MeshInstance3D.new() # An item's source mesh, which is not an instance.
	source.mesh = BoxMesh.new()
	scatter.add_child(source)
	var output := Marker3D.new()
	output.name = "ScatterOutput"
	scatter.add_child(output)
	for item in items:
		output.add_child(item)
	root.add_child(scatter)
	return scatter


func test_proton_scatter() -> void:
	var mesh := CylinderMesh.new()
	var all := some_transforms(40)
	var grass := Node3D.new()
	grass.name = "Grass"
	for chunk in 4:
		var node := make_multimesh(mesh, all.slice(chunk * 10, chunk * 10 + 10))
		node.name = "MultiMeshInstance3D_%d" % chunk
		grass.add_child(node)
	grass.add_child(StaticBody3D.new())
	var rocks := Node3D.new()
	rocks.name = "Rocks"
	var rock := SphereMesh.new()
	var copies := some_transforms(12)
	for at in copies:
		var body := StaticBody3D.new()
		body.transform = at
		var mesh_instance := MeshInstance3D.new()
		mesh_instance.mesh = rock
		body.add_child(mesh_instance)
		rocks.add_child(body)
	var scene := PackedScene.new()
	var hut := Node3D.new()
	hut.name = "Hut"
	var walls := MeshInstance3D.new()
	walls.mesh = BoxMesh.new()
	hut.add_child(walls)
	walls.owner = hut
	scene.pack(hut)
	hut.free()
	ResourceSaver.save(scene, "user://thicket_hut.tscn")
	var huts := Node3D.new()
	huts.name = "Huts"
	var points := some_transforms(3)
	for at in points:
		var copy: Node3D = (load("user://thicket_hut.tscn") as PackedScene).instantiate()
		copy.transform = at
		huts.add_child(copy)
	var proton := proton_output([grass, rocks, huts])
	var scatter := make_bare()
	check_equal(ImportInstances.from_node(scatter, null, proton), 55, "all instances of the output")
	var names := scatter.layers.map(func(layer: ScatterLayer) -> String: return layer.resource_name)
	check_equal(names, ["Grass", "Rocks", "Huts"], "a layer for each item")
	var move := func(at: Transform3D) -> Transform3D: return proton.global_transform * at
	check_placed(scatter, 0, Array(all.map(move), TYPE_TRANSFORM3D, "", null), "chunks")
	check_placed(scatter, 1, Array(copies.map(move), TYPE_TRANSFORM3D, "", null), "copies of nodes")
	check_placed(scatter, 2, Array(points.map(move), TYPE_TRANSFORM3D, "", null), "copies of scenes")
	check((scatter.layers[2].meshes[0] as PackedScene).resource_path == "user://thicket_hut.tscn", "the layer contains the scene")
	var particles := Node3D.new()
	particles.name = "Sparks"
	particles.add_child(GPUParticles3D.new())
	check_equal(ImportInstances.from_node(scatter, null, proton_output([particles])), 0, "particles are not imported")
	check_error(["Sparks", "particles"], "particles")


## A node that stores instances as Terrain3D does: by region, mesh and cell, relative to the region's corner.
class Terrain3DDouble extends Node3D:
	class Region extends RefCounted:
		var location := Vector2i.ZERO
		var region_size := 64
		var instances := {}

	class Data extends RefCounted:
		var regions := {}

		func get_region_locations() -> Array[Vector2i]:
			return Array(regions.keys(), TYPE_VECTOR2I, "", null)

		func get_region(location: Vector2i) -> Region:
			return regions.get(location)

	class MeshAsset extends RefCounted:
		var name := "New Mesh"
		var material_override: Material
		var mesh: Mesh

		func get_mesh(_lod := 0) -> Mesh:
			return mesh

	class Assets extends RefCounted:
		var meshes: Array[MeshAsset] = []

		func get_mesh_asset(id: int) -> MeshAsset:
			return meshes[id] if id < meshes.size() else null

	var data := Data.new()
	var assets := Assets.new()
	var vertex_spacing := 2.0

	func add(location: Vector2i, mesh: int, cell: Vector2i, all: Array[Transform3D]) -> void:
		if not data.regions.has(location):
			data.regions[location] = Region.new()
			data.regions[location].location = location
		var instances: Dictionary = data.regions[location].instances
		if not instances.has(mesh):
			instances[mesh] = {}
		instances[mesh][cell] = [all, PackedColorArray(), true]


func test_terrain_3d() -> void:
	var terrain := Terrain3DDouble.new()
	for name: String in ["Birch", "Fern"]:
		var asset := Terrain3DDouble.MeshAsset.new()
		asset.name = name
		asset.mesh = BoxMesh.new()
		terrain.assets.meshes.push_back(asset)
	terrain.assets.meshes[1].material_override = StandardMaterial3D.new()
	var first := some_transforms(30)
	var second := some_transforms(20)
	terrain.add(Vector2i.ZERO, 0, Vector2i(0, 1), first.slice(0, 10))
	terrain.add(Vector2i(-1, 1), 0, Vector2i(1, 1), first.slice(10))
	terrain.add(Vector2i(-1, 1), 1, Vector2i(0, 0), second)
	var drawn := make_multimesh(terrain.assets.meshes[0].mesh, first)
	terrain.add_child(drawn) # Terrain3D draws its instances with such nodes, which must not be imported again.
	terrain.position = Vector3(5, 5, 5) # Terrain3D ignores the node's position for its instances.
	root.add_child(terrain)
	var scatter := make_bare()
	check_equal(ImportInstances.from_node(scatter, null, terrain), 50, "all instances are imported once")
	var corner := Vector3(-128, 0, 128)
	var expected: Array[Transform3D] = first.slice(0, 10)
	for at in first.slice(10):
		expected.push_back(Transform3D(at.basis, at.origin + corner))
	check_placed(scatter, "Birch", expected, "two regions")
	var ferns: Array[Transform3D] = []
	for at in second:
		ferns.push_back(Transform3D(at.basis, at.origin + corner))
	check_placed(scatter, "Fern", ferns, "the second mesh")
	check(scatter.layers[1].material_override == terrain.assets.meshes[1].material_override, "the layer has the mesh's material")
	terrain.add(Vector2i.ZERO, 2, Vector2i.ZERO, some_transforms(1))
	var before := scatter.state.get_added_count()
	check_equal(ImportInstances.from_node(scatter, null, terrain), 0, "a missing mesh")
	check_error(["mesh 2"], "a missing mesh")
	check_equal(scatter.state.get_added_count(), before, "a failed import adds no instances")


func test_a_moved_world() -> void:
	var scatter := make_bare([make_layer()])
	scatter.layers[0].density = 0.0
	scatter.world_offset = Vector3(65536, 0, -1024)
	var all := some_transforms(200)
	var top := make_multimesh(scatter.layers[0].meshes[0], all)
	root.add_child(top)
	check_equal(ImportInstances.from_node(scatter, scatter.layers[0], top), 200, "all instances are imported")
	check_placed(scatter, 0, all, "the same position in the engine's space")
