extends "allocation_harness.gd"
## A scene that uses models, mesh and image grounds, biomes, impostors and a navigation mesh.


func steps() -> Array[Callable]:
	return [read_models, use_heightmap, use_image_biomes, bake_impostor, bake_navigation, use_flat_ground]


func make_scene() -> void:
	var ground := MeshInstance3D.new()
	var plane := PlaneMesh.new()
	plane.size = Vector2(60, 60)
	plane.subdivide_width = 4
	ground.mesh = plane
	ground.add_to_group(&"ground")
	root.add_child(ground)
	var terrain := ScatterGroundMeshes.new()
	terrain.group = &"ground"
	var pines := make_layer("pines", 4.0, [pine()])
	pines.layer_id = 5
	pines.lod_fade = 0.2
	pines.draw_cell_size = 8.0
	pines.use_colors = true
	pines.collision_shape = ScatterLayer.COLLISION_MODEL
	pines.collision_distance = 12.0
	pines.scene = pine()
	pines.scene_distance = 8.0
	make_scatter([pines], terrain)
	var wood := ScatterRegion3D.new()
	wood.shape = ScatterRegion3D.SHAPE_POLYGON
	wood.polygon = PackedVector2Array([Vector2(-30, -30), Vector2(30, -30), Vector2(30, 30), Vector2(-20, 10)])
	scatter.add_child(wood)


## Returns a model with parts to merge, a coarser LOD and a body.
func pine() -> PackedScene:
	var scene := Node3D.new()
	for index in 3:
		var part := MeshInstance3D.new()
		part.mesh = BoxMesh.new() if index < 2 else SphereMesh.new()
		part.position = Vector3(0, index, 0)
		part.rotation.y = index
		scene.add_child(part)
		part.owner = scene
	var shape := CollisionShape3D.new()
	shape.shape = BoxShape3D.new()
	var body := StaticBody3D.new()
	scene.add_child(body)
	body.owner = scene
	body.add_child(shape)
	shape.owner = scene
	var packed := PackedScene.new()
	packed.pack(scene)
	scene.free()
	return packed


func read_models() -> void:
	var model := ScatterModel.new()
	model.scene = pine()
	answers.push_back(model.lods.size())
	for lod in model.lods:
		answers.push_back(lod.mesh.get_aabb())


func use_heightmap() -> void:
	var image := Image.create_empty(33, 33, false, Image.FORMAT_RF)
	image.fill(Color(0.25, 0, 0))
	var heights := ScatterGroundHeightmap.new()
	heights.rect = Rect2(-40, -40, 80, 80)
	heights.max_height = 20.0
	heights.image = image
	scatter.ground = heights
	answers.push_back(scatter.query_rect(Rect2(-10, -10, 20, 20)).positions)
	image.fill_rect(Rect2i(4, 4, 8, 8), Color(0.75, 0, 0))
	heights.update_region(Rect2i(4, 4, 8, 8))
	answers.push_back(scatter.query_rect(Rect2(-40, -40, 30, 30)).positions)


func use_image_biomes() -> void:
	var image := Image.create_empty(16, 16, false, Image.FORMAT_L8)
	var moss := make_layer("moss", 3.0, [BoxMesh.new()])
	moss.layer_id = 6
	var biome := ScatterBiome.new()
	biome.layers = [moss]
	var biomes := ScatterBiomeMap.new()
	biomes.biomes = [biome]
	biomes.map_image = image
	biomes.map_rect = Rect2(-20, -20, 40, 40)
	scatter.biomes = biomes
	answers.push_back(biomes.get_biome_at(Vector2(3, 3)) == biome)
	answers.push_back(scatter.query_rect(Rect2(-10, -10, 20, 20)).ids)


func bake_impostor() -> void:
	var baker := ScatterImpostorBaker.new()
	baker.frames = 2
	baker.frame_size = 16
	baker.samples = 1
	baker.add_surface(BoxMesh.new().get_mesh_arrays(), Transform3D.IDENTITY, Color.WHITE)
	answers.push_back(baker.bake())
	answers.push_back(baker.get_albedo_image().get_data())


func bake_navigation() -> void:
	var mesh := NavigationMesh.new()
	mesh.filter_baking_aabb = AABB(Vector3(-10, -2, -10), Vector3(20, 12, 20))
	var data := NavigationMeshSourceGeometryData3D.new()
	# Baking a region would crash an engine without worker threads.
	NavigationServer3D.parse_source_geometry_data(mesh, data, scatter)
	answers.push_back(data.get_projected_obstructions())


func use_flat_ground() -> void:
	scatter.ground = ScatterGroundFlat.new()
