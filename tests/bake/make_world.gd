extends SceneTree
## Writes world.tscn, a scene with a scatter of trees and grass. The trees have colors, custom data, two meshes, and an offset along the normal that
## moves some of them off their tiles. The grass keeps a distance from the trees, and its tile size does not divide the tile size of the trees. In the
## scatter's state, some trees have been felled and some placed by hand.

const Hills := preload("res://hills.gd")


func _initialize() -> void:
	var trees := ScatterLayer.new()
	trees.resource_name = "Trees"
	trees.layer_id = 1
	trees.radius = 3.0
	trees.tile_size = 32.0
	trees.view_distance = 300.0
	var cone := CylinderMesh.new()
	cone.top_radius = 0.0
	ResourceSaver.save(cone, "res://cone.res")
	cone.take_over_path("res://cone.res")
	trees.meshes = [BoxMesh.new(), cone]
	trees.min_scale = 0.5
	trees.max_scale = 2.0
	trees.align_to_normal = 1.0
	trees.offset_along_normal = 1.5
	trees.use_colors = true
	var hues := Gradient.new()
	hues.colors = [Color.DARK_GREEN, Color.GOLD]
	trees.color_value = ScatterValueSource.new()
	trees.color_value.gradient = hues
	trees.use_custom_data = true
	var grass := ScatterLayer.new()
	grass.resource_name = "Grass"
	grass.layer_id = 2
	grass.radius = 1.0
	grass.tile_size = 20.0
	grass.view_distance = 300.0
	grass.spacing = {"Trees": 1.0}
	grass.meshes = [BoxMesh.new()]

	var scatter := TerrainScatter3D.new()
	scatter.name = "Scatter"
	scatter.seed = 11
	scatter.ground = Hills.new()
	scatter.layers = [trees, grass]
	root.add_child(scatter)
	await process_frame
	scatter.remove_instances(scatter.query_sphere(Vector3.ZERO, 25.0, "Trees").ids)
	scatter.add_instance("Trees", Transform3D(Basis.from_scale(Vector3(1, 2, 3)), Vector3(5.0, 1.0, 6.0)), 1)
	scatter.add_instance("Trees", Transform3D(Basis.from_scale(Vector3(-1, 1, 1)), Vector3(31.9999999, 1.0, 6.0)))
	ResourceSaver.save(scatter.state, "res://world_state.res")
	scatter.state.take_over_path("res://world_state.res")
	root.remove_child(scatter)

	var world := Node3D.new()
	world.name = "World"
	world.add_child(scatter)
	scatter.owner = world
	var clearing := ScatterRegion3D.new()
	clearing.name = "Clearing"
	clearing.shape = ScatterRegion3D.SHAPE_CYLINDER
	clearing.radius = 10.0
	clearing.position = Vector3(-40.0, 0.0, -20.0)
	clearing.height = 100.0
	scatter.add_child(clearing)
	clearing.owner = world
	var packed := PackedScene.new()
	packed.pack(world)
	ResourceSaver.save(packed, "res://world.tscn")
	world.free()
	quit()
