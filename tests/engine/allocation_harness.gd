extends SceneTree
## Base class for the small scenes that tests/engine/test_allocations.py runs once for each failing allocation. Together, they cover much of
## the library.
##
## Steps never await, so `_run` continues with the next step when one fails. At the end, it prints "result: " and a hash of all results.

const MOST_FRAMES := 60 ## Frames to wait for the scatter to settle.

var scatter: TerrainScatter3D
var answers: Array = []


func _initialize() -> void:
	_run.call_deferred()


func _run() -> void:
	command("sweep")
	make_scene()
	await settle()
	read_tiles()
	for step in steps():
		step.call()
		await process_frame
	await settle()
	read_tiles()
	print("result: %d" % hash(answers))
	command("end")
	quit()


## Creates `scatter` and adds it to the tree. Scenes override this.
func make_scene() -> void:
	pass


func steps() -> Array[Callable]:
	return []


func command(text: String) -> void:
	OS.set_environment("THICKET_ALLOCATIONS", text)


func settle() -> void:
	for frame in MOST_FRAMES:
		await process_frame
		if scatter != null and scatter.is_settled():
			return


func make_layer(layer_name: String, radius: float, meshes: Array) -> ScatterLayer:
	var layer := ScatterLayer.new()
	layer.resource_name = layer_name
	layer.radius = radius
	layer.tile_size = 32.0
	layer.view_distance = 48.0
	layer.meshes = meshes
	return layer


func make_scatter(layers: Array[ScatterLayer], terrain: ScatterGround) -> void:
	var viewer := Node3D.new()
	root.add_child(viewer)
	scatter = TerrainScatter3D.new()
	scatter.layers = layers
	scatter.ground = terrain
	scatter.state = ScatterState.new()
	scatter.frame_budget_usec = 50000
	root.add_child(scatter)
	scatter.viewers = [scatter.get_path_to(viewer)]


func read_tiles() -> void:
	for layer in scatter.layers.size():
		for at in scatter.get_shown_tiles(scatter.layers[layer]):
			var tile := scatter.get_tile(scatter.layers[layer], at)
			answers.push_back([layer, at, tile.get_digest()])
			for mesh in tile.get_mesh_count():
				answers.push_back([tile.get_ids(mesh), tile.get_buffer(mesh)])
	var built := scatter.build_rect(scatter.layers[0], Rect2(0, 0, 16, 16))
	for mesh in built.get_mesh_count():
		answers.push_back([built.get_ids(mesh), built.get_buffer(mesh)])
