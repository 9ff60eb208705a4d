extends "harness.gd"
## Base class for the tests of the demo's small scenes: a scene and its scatter.

var scene: Node3D
var scatter: TerrainScatter3D
var terrain: ScatterGround
var viewer: Node3D


## Adds a demo scene to the tree and makes `viewer` its only viewer.
func load_scene(path: String) -> void:
	scene = (load(path) as PackedScene).instantiate()
	# The scene's script would move the camera.
	scene.set_script(null)
	scatter = scene.get_node("Scatter")
	terrain = scatter.ground
	root.add_child(scene)
	viewer = make_viewer()
	scatter.viewers = [scatter.get_path_to(viewer)]
