@tool
extends "res://tests/steps.gd"
## Tests biome layers in the panel and with the brush. The panel lists the layers of a biome below the biome's name.
## Like the layers of the scatter itself, they can be selected, hidden, painted and undone. They can be added and
## removed only in their biome.

const SCENE := "res://valley.tscn"

var scatter: Node3D


func tree() -> Tree:
	return workspace().dock.panel.tree


func layer(title: String) -> Resource:
	for each: Resource in scatter.get_all_layers():
		if each != null and each.resource_name == title:
			return each
	return null


func new_layer(title: String, radius: float) -> Resource:
	var made: Resource = ClassDB.instantiate(&"ScatterLayer")
	made.resource_name = title
	made.radius = radius
	made.meshes = [BoxMesh.new()]
	return made


func new_biome(title: String, color: Color, layers: Array) -> Resource:
	var biome: Resource = ClassDB.instantiate(&"ScatterBiome")
	biome.resource_name = title
	biome.color = color
	for each: Resource in layers:
		biome.layers.push_back(each)
	return biome


## Returns a biome map with a meadow on the left and a swamp on the right.
func new_map() -> Resource:
	var image := Image.create_empty(2, 1, false, Image.FORMAT_RGB8)
	image.set_pixel(0, 0, Color.LIME)
	image.set_pixel(1, 0, Color.RED)
	var map: Resource = ClassDB.instantiate(&"ScatterBiomeMap")
	map.map_rect = Rect2(-128.0, -128.0, 256.0, 256.0)
	map.border_noise = 0.0
	map.biomes.push_back(new_biome("Meadow", Color.LIME, [new_layer("Grass", 1.5)]))
	map.biomes.push_back(new_biome("Swamp", Color.RED, [new_layer("Reed", 1.5), new_layer("Willow", 6.0)]))
	map.map_image = image
	return map


func wait_for_panel() -> void:
	await get_tree().create_timer(0.6).timeout


func test_layers_of_biomes_are_listed() -> void:
	var root := Node3D.new()
	root.name = "Valley"
	scatter = ClassDB.instantiate(&"TerrainScatter3D")
	scatter.name = "Scatter"
	scatter.ground = ClassDB.instantiate(&"ScatterGroundFlat")
	scatter.layers = [new_layer("Rock", 5.0)]
	scatter.biomes = new_map()
	root.add_child(scatter)
	scatter.owner = root
	save_scene(root, SCENE)
	root = await open(SCENE)
	EditorInterface.set_main_screen_editor("3D")
	scatter = root.get_node("Scatter")
	EditorInterface.get_selection().add_node(scatter)
	EditorInterface.edit_node(scatter)
	await settle(scatter)
	await wait_for_panel()
	var titles: Array = tree().rows().map(func(row: TreeItem) -> String: return row.get_text(0))
	check_equal(titles, ["Rock", "Grass", "Reed", "Willow"], "one row per layer")
	check_equal(tree().row_of(layer("Rock")).get_parent(), tree().get_root(), "the layer of the scatter itself has no parent row")
	for pair: Array in [["Grass", "Meadow"], ["Reed", "Swamp"], ["Willow", "Swamp"]]:
		var row: TreeItem = tree().row_of(layer(pair[0]))
		check_equal(row.get_parent().get_text(0), pair[1], pair[0] + " is listed below its biome")
		var count: int = scatter.get_shown_count(layer(pair[0]))
		check(count > 20, "%s: %d instances" % [pair[0], count])
		check_equal(row.get_text(1), load("res://addons/thicket/number_text.gd").grouped(count), "its row shows the count")
	await picture("biome_layers")


func test_a_layer_of_a_biome_is_selected_and_hidden() -> void:
	var before := saved_files()
	await mouse_click(await name_at(layer("Reed")))
	await frames(2)
	check_equal(workspace().toolbar.chosen, [layer("Reed")] as Array[ScatterLayer], "a click selects it for the tools")
	check_equal(workspace().toolbar.paint.layer, layer("Reed"), "the brush uses it, too")
	check_equal(scatter.get_all_layers()[workspace().toolbar.paint.layer_index], layer("Reed"), "the brush has its index")
	check(workspace().dock.panel._remove.disabled and workspace().dock.panel._copy.disabled, "layers of biomes cannot be removed or copied")
	await key(KEY_DELETE)
	check(layer("Reed") != null, "the Delete key does not delete it")
	await mouse_click(await mark_at(layer("Reed"), 2))
	await settle(scatter)
	check(workspace().dock.marks.is_hidden(layer("Reed")), "a click on the eye hides it")
	check_equal(scatter.get_stats().drawn, scatter.get_stats().instances - scatter.get_shown_count(layer("Reed")), "its instances are not drawn")
	var state: Dictionary = addon()._get_state()
	workspace().dock.marks.put(layer("Reed"), &"hidden", null)
	addon()._set_state(state)
	check(workspace().dock.marks.is_hidden(layer("Reed")), "the editor restores the mark with the scene")
	workspace().dock.marks.put(layer("Reed"), &"hidden", null)
	await settle(scatter)
	check_same(saved_files(), before, "the saved scene does not change")


func test_a_layer_of_a_biome_is_painted() -> void:
	var before := saved_files()
	await mouse_click(await name_at(layer("Reed")))
	await frames(2)
	var paint: Node = workspace().toolbar.paint
	paint.set_on(true)
	paint.choose_mode(1)
	paint.set_brush(8.0, 1.0, 1.0)
	await stroke([Vector3(2.0, 0.0, 0.0), Vector3(6.0, 0.0, 0.0)])
	check_equal(paint.problem, "", "the stroke is painted")
	check(layer("Reed").mask != null and layer("Willow").mask == null and layer("Rock").mask == null, "only this layer gets a mask")
	await settle(scatter)
	check_equal(scatter.query_rect(Rect2(0.0, -3.0, 8.0, 6.0), layer("Reed")).size(), 0, "no reed remains where the stroke erased it")
	var after := saved_files()
	check(after != before and after.size() == before.size() + 1, "the mask is saved in a file next to the scene: %s" % [after.keys()])
	await undo()
	check_same(saved_files(), before, "undo restores the saved files")
	await redo()
	check_same(saved_files(), after, "redo restores the saved files")
	await undo()
	paint.set_on(false)


func test_a_biome_is_painted() -> void:
	var before := saved_files()
	var map: Resource = scatter.biomes
	var tool: Node = workspace().toolbar.biomes
	check(tool.button.visible and not tool.visible, "the toolbar shows a brush for biomes")
	tool.set_on(true)
	await wait_for_panel()
	check_equal(tool._biomes.item_count, 3, "the list has an item for each biome and one for no biome")
	tool.choose_biome(1)
	tool._radius.value = 10.0
	await stroke([Vector3(-14.0, 0.0, 0.0), Vector3(-10.0, 0.0, 0.0)])
	check_equal(tool.problem, "", "the stroke is painted")
	check_equal(map.get_biome_at(Vector2(-12.0, 0.0)), map.biomes[1], "the stroke paints swamp into the meadow")
	check_equal(map.get_biome_at(Vector2(-40.0, 0.0)), map.biomes[0], "the meadow around it is unchanged")
	await settle(scatter)
	var inside := Rect2(-15.0, -3.0, 6.0, 6.0)
	check_equal(scatter.query_rect(inside, layer("Grass")).size(), 0, "no grass remains in the stroke")
	check(scatter.query_rect(inside, layer("Reed")).size() > 3, "reed grows in the stroke")
	await wait_for_panel()
	check(tool.overlay.is_shown(), "the overlay shows the biomes")
	await picture("biome_painted")
	var after := saved_files()
	check_equal(after.size(), before.size() + 1, "the map's image is saved in a file next to the scene: %s" % [after.keys()])
	await undo()
	check_same(saved_files(), before, "undo restores the saved files")
	check_equal(map.get_biome_at(Vector2(-12.0, 0.0)), map.biomes[0], "undo restores the meadow")
	await redo()
	check_same(saved_files(), after, "redo restores the saved files")
	check_equal(map.get_biome_at(Vector2(-12.0, 0.0)), map.biomes[1], "redo restores the swamp")
	tool.choose_biome(-1)
	await stroke([Vector3(4.0, 0.0, 0.0)])
	check(map.get_biome_at(Vector2(4.0, 0.0)) == null, "the stroke removes the biome")
	check_equal(saved_files().size(), after.size(), "the image stays in the same file")
	await undo()
	check_same(saved_files(), after, "undo restores every pixel")
	map.biomes[1].color = Color.LIME
	check("Meadow and Swamp have the same color" in tool.brush.begin(scatter, 1, SCENE, Vector3.ZERO), "equal colors are rejected")
	map.biomes[1].color = Color.RED
	check("The map ends here" in tool.brush.begin(scatter, 0, SCENE, Vector3(300.0, 0.0, 0.0)), "a position outside the map is rejected")
	tool.set_on(false)
	await undo()
	check_same(saved_files(), before, "undo restores all files")


## Tests the images that the biome brush creates for maps without an image. With MAP_MODE_INDICES, such an image stores biome numbers in one channel.
func test_images_for_the_biome_brush() -> void:
	var brush: RefCounted = workspace().toolbar.biomes.brush
	var map := new_map()
	scatter.biomes = map
	map.map_mode = 1
	for number: int in [1, -1, 0]:
		map.map_image = null
		check_equal(brush.begin(scatter, number, SCENE, Vector3(20.0, 0.0, 30.0)), "", "the stroke creates an image")
		brush.finish(null)
		check_equal(map.map_image.get_format(), Image.FORMAT_R8, "the image has one channel")
		check_equal(map.map_image.get_size(), Vector2i(1024, 1024), "the image has the default size")
		check(map.get_biome_at(Vector2(20.0, 30.0)) == (map.biomes[number] if number >= 0 else null), "biome %d" % number)
		check_equal(map.get_biome_at(Vector2(60.0, 30.0)), map.biomes[0], "all other pixels contain the first biome")
	map.map_mode = 0
	var imported := Image.create_empty(512, 256, true, Image.FORMAT_RGB8)
	imported.fill(Color.LIME)
	map.map_image = ImageTexture.create_from_image(imported)
	check_equal(brush.begin(scatter, 1, SCENE, Vector3(20.0, 0.0, 30.0)), "", "the stroke starts on a copy of the texture")
	brush.finish(null)
	check(map.map_image is Image and map.map_image.get_size() == Vector2i(512, 256), "the image has the texture's size: %s" % map.map_image)
	check_equal(map.get_biome_at(Vector2(20.0, 30.0)), map.biomes[1], "the copy is painted")
	ResourceSaver.save(map, "res://valley_map.tres")
	map.take_over_path("res://valley_map.tres")
	map.map_image = null
	brush.begin(scatter, 1, SCENE, Vector3(40.0, 0.0, 30.0))
	brush.finish(null)
	EditorInterface.save_scene()
	var saved := ResourceLoader.load("res://valley_map.tres", "", ResourceLoader.CACHE_MODE_IGNORE_DEEP)
	check_equal(saved.get_biome_at(Vector2(40.0, 30.0)).resource_name, "Swamp", "a map in its own file is saved with the scene")
	for path: String in files("res://"):
		if path.begins_with("valley_biomes"):
			DirAccess.remove_absolute("res://" + path)


## Checks that, after a script has replaced a biome, the panel shows the new layers, and the tools no longer use the old ones.
func test_a_biome_is_replaced() -> void:
	await mouse_click(await name_at(layer("Reed")))
	scatter.biomes.biomes[1] = new_biome("Dry Bed", Color.RED, [new_layer("Thistle", 2.0)])
	await settle(scatter)
	await wait_for_panel()
	var titles: Array = tree().rows().map(func(row: TreeItem) -> String: return row.get_text(0))
	check_equal(titles, ["Rock", "Grass", "Thistle"], "the rows are updated")
	check_equal(tree().row_of(layer("Thistle")).get_parent().get_text(0), "Dry Bed", "the new layer is listed below the new biome's name")
	check_equal(workspace().toolbar.chosen, [layer("Rock")] as Array[ScatterLayer], "the tools use a layer that still exists")
