extends SceneTree
## Writes levels.tscn, a scene with a scatter on the surfaces of a floor, of a bridge above it and of a wall. Prints the IDs and positions of the
## instances in the rectangle of the test's bake, as JSON. The layer's tiles differ from the tiles of the bake.


func _initialize() -> void:
	var world := Node3D.new()
	world.name = "World"
	add_box(world, Vector3(60.0, 1.0, 60.0), Vector3.ZERO)
	add_box(world, Vector3(60.0, 1.0, 8.0), Vector3(0.0, 9.0, 0.0))
	add_box(world, Vector3(1.0, 20.0, 60.0), Vector3(-30.0, 10.0, 0.0))
	var layer := ScatterLayer.new()
	layer.resource_name = "Moss"
	layer.layer_id = 3
	layer.radius = 1.0
	layer.on_surfaces = true
	layer.max_slope_degrees = 180.0
	layer.tile_size = 20.0
	layer.view_distance = 200.0
	layer.meshes = [BoxMesh.new()]
	var ground := ScatterGroundMeshes.new()
	ground.group = &"levels"
	var scatter := TerrainScatter3D.new()
	scatter.name = "Scatter"
	scatter.ground = ground
	scatter.layers = [layer]
	world.add_child(scatter)
	scatter.owner = world
	root.add_child(world)
	for frame in 30:
		await physics_frame
	var found := scatter.query_rect(Rect2(-32.0, -32.0, 64.0, 64.0))
	var instances := {}
	for index in found.size():
		var at := found.get_position(index)
		instances[str(found.get_id(index))] = [at.x, at.y, at.z]
	print("instances ", JSON.stringify(instances))
	root.remove_child(world)
	var packed := PackedScene.new()
	packed.pack(world)
	ResourceSaver.save(packed, "res://world.tscn")
	world.free()
	quit()


func add_box(world: Node3D, size: Vector3, at: Vector3) -> void:
	var mesh := BoxMesh.new()
	mesh.size = size
	var node := MeshInstance3D.new()
	node.mesh = mesh
	node.position = at
	node.add_to_group(&"levels", true)
	world.add_child(node, true)
	node.owner = world
