extends "harness.gd"
## Base of the tests of the demo's small scenes: a scene and what stands in it.

var scene: Node3D
var scatter: TerrainScatter3D
var terrain: ScatterGround
var viewer: Node3D


## Puts a scene of the demo into the tree, with `viewer` as its only one.
func load_scene(path: String) -> void:
	scene = (load(path) as PackedScene).instantiate()
	# Its own script would move the camera.
	scene.set_script(null)
	scatter = scene.get_node("Scatter")
	terrain = scatter.ground
	root.add_child(scene)
	viewer = make_viewer()
	scatter.viewers = [scatter.get_path_to(viewer)]
