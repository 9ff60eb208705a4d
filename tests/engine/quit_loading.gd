extends SceneTree
## Quits while the engine loads a scene, whose layers scatter scenes, in the background. The runner checks the exit code and the output. `--
## FRAMES` sets the number of frames before quitting.

func _initialize() -> void:
	_run.call_deferred()


func make_tree() -> PackedScene:
	var tree := Node3D.new()
	for lod in 3:
		for part in 3:
			var mesh_instance := MeshInstance3D.new()
			mesh_instance.name = "Part%d_LOD%d" % [part, lod]
			var mesh := ArrayMesh.new()
			mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, SphereMesh.new().get_mesh_arrays())
			mesh_instance.mesh = mesh
			tree.add_child(mesh_instance)
			mesh_instance.owner = tree
	var packed := PackedScene.new()
	packed.pack(tree)
	tree.free()
	return packed


func _run() -> void:
	var level := Node3D.new()
	var scatter := TerrainScatter3D.new()
	scatter.ground = ScatterGroundFlat.new()
	level.add_child(scatter)
	scatter.owner = level
	for number in 12:
		ResourceSaver.save(make_tree(), "user://quit_tree_%d.scn" % number)
		var layer := ScatterLayer.new()
		layer.meshes = [load("user://quit_tree_%d.scn" % number)]
		scatter.layers.append(layer)
	var packed := PackedScene.new()
	packed.pack(level)
	level.free()
	ResourceSaver.save(packed, "user://quit_level.scn")
	packed = null
	ResourceLoader.load_threaded_request("user://quit_level.scn", "", false, ResourceLoader.CACHE_MODE_IGNORE_DEEP)
	for frame in int(OS.get_cmdline_user_args()[0]):
		await process_frame
	print("thicket quits while it loads")
	quit()
