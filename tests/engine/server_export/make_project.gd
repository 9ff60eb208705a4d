extends SceneTree
## Creates the scene of a project to export as a dedicated server. The project's images must already be imported.

func _initialize() -> void:
	_make.call_deferred()


func make_tree() -> PackedScene:
	var tree := Node3D.new()
	tree.name = "Tree"
	for lod in 2:
		var mesh_instance := MeshInstance3D.new()
		mesh_instance.name = "Trunk_LOD%d" % lod
		mesh_instance.mesh = CylinderMesh.new()
		mesh_instance.position.y = 1.0
		tree.add_child(mesh_instance)
		mesh_instance.owner = tree
	var body := StaticBody3D.new()
	body.name = "Body"
	tree.add_child(body)
	body.owner = tree
	var shape := CollisionShape3D.new()
	shape.shape = CylinderShape3D.new()
	shape.name = "Shape"
	shape.position.y = 1.0
	body.add_child(shape)
	shape.owner = tree
	var packed := PackedScene.new()
	packed.pack(tree)
	tree.free()
	return packed


func make_rock() -> ArrayMesh:
	var mesh := ArrayMesh.new()
	var sphere := SphereMesh.new()
	sphere.material = StandardMaterial3D.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, sphere.get_mesh_arrays())
	return mesh


func make_layer(name: String, mesh: Resource, shape: ScatterLayer.CollisionShape) -> ScatterLayer:
	var layer := ScatterLayer.new()
	layer.resource_name = name
	layer.radius = 4.0
	layer.tile_size = 32.0
	layer.view_distance = 64.0
	layer.collision_distance = 30.0
	layer.meshes = [mesh]
	layer.collision_shape = shape
	return layer


func add_scatter(level: Node, name: String, terrain: ScatterGround, layers: Array[ScatterLayer]) -> TerrainScatter3D:
	var scatter := TerrainScatter3D.new()
	scatter.name = name
	scatter.ground = terrain
	scatter.layers = layers
	level.add_child(scatter)
	scatter.owner = level
	return scatter


func _make() -> void:
	ResourceSaver.save(make_tree(), "res://tree.tscn")
	ResourceSaver.save(make_rock(), "res://rock.res")
	var level := Node3D.new()
	level.name = "Level"
	var ground := ScatterGroundHeightmap.new()
	ground.image = load("res://heights.png")
	ground.rect = Rect2(-64, -64, 128, 128)
	ground.max_height = 20.0
	var masked := make_layer("Masked", BoxMesh.new(), ScatterLayer.COLLISION_BOX)
	masked.mask_texture = load("res://mask.png")
	masked.mask_texture_rect = Rect2(-64, -64, 128, 128)
	var apart := make_layer("Apart", load("res://rock.res"), ScatterLayer.COLLISION_CONVEX)
	ResourceSaver.save(apart, "res://apart.tres")
	add_scatter(level, "Wood", ground, [
		make_layer("Model", load("res://tree.tscn"), ScatterLayer.COLLISION_MODEL),
		make_layer("Convex", load("res://rock.res"), ScatterLayer.COLLISION_CONVEX),
		make_layer("Convex scene", load("res://tree.tscn"), ScatterLayer.COLLISION_CONVEX),
		make_layer("Convex inside", make_rock(), ScatterLayer.COLLISION_CONVEX),
		masked,
		load("res://apart.tres"),
	])
	var biome := ScatterBiome.new()
	biome.color = Color.RED
	biome.layers = [make_layer("Biome", BoxMesh.new(), ScatterLayer.COLLISION_BOX)]
	var map := ScatterBiomeMap.new()
	map.biomes = [biome]
	map.map_image = load("res://map.png")
	map.map_rect = Rect2(-64, -64, 128, 128)
	add_scatter(level, "Biomes", ScatterGroundFlat.new(), []).biomes = map
	var camera := Camera3D.new()
	camera.name = "Camera"
	level.add_child(camera)
	camera.owner = level
	level.set_script(load("res://server.gd"))
	var packed := PackedScene.new()
	packed.pack(level)
	level.free()
	ResourceSaver.save(packed, "res://level.tscn")
	quit()
