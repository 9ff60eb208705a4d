@tool
extends "res://tests/steps.gd"
## Layers of biomes in the panel and under the brush: listed below the name of their biome, and chosen, hidden, painted and undone like the
## scatter's own layers. They can only be added and removed in their biome.

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
	var made: Resource = ClassDB.instantiate(&"ScatterBiome")
	made.resource_name = title
	made.color = color
	for each: Resource in layers:
		made.layers.push_back(each)
	return made


## Returns a valley with meadow on the left and swamp on the right.
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


func look() -> void:
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
	var packed := PackedScene.new()
	packed.pack(root)
	root.free()
	ResourceSaver.save(packed, SCENE)
	root = await open(SCENE)
	EditorInterface.set_main_screen_editor("3D")
	scatter = root.get_node("Scatter")
	EditorInterface.get_selection().add_node(scatter)
	EditorInterface.edit_node(scatter)
	await settle(scatter)
	await look()
	var titles: Array = tree().rows().map(func(row: TreeItem) -> String: return row.get_text(0))
	check_equal(titles, ["Rock", "Grass", "Reed", "Willow"], "one row per layer")
	check_equal(tree().row_of(layer("Rock")).get_parent(), tree().get_root(), "the scatter's own layer has no parent row")
	for pair: Array in [["Grass", "Meadow"], ["Reed", "Swamp"], ["Willow", "Swamp"]]:
		var row: TreeItem = tree().row_of(layer(pair[0]))
		check_equal(row.get_parent().get_text(0), pair[1], pair[0] + " is below its biome")
		var count: int = scatter.get_shown_count(layer(pair[0]))
		check(count > 20, "%s: %d instances" % [pair[0], count])
		check_equal(row.get_text(1), load("res://addons/thicket/number_text.gd").grouped(count), "the count is in its row")
	await picture("biome_layers")


func test_a_layer_of_a_biome_is_chosen_and_hidden() -> void:
	var before := saved_files()
	await mouse_click(await name_at(layer("Reed")))
	await frames(2)
	check_equal(workspace().toolbar.chosen, [layer("Reed")] as Array[ScatterLayer], "a click chooses it for the tools")
	check_equal(workspace().toolbar.paint.layer, layer("Reed"), "for the brush, too")
	check_equal(scatter.get_all_layers()[workspace().toolbar.paint.layer_index], layer("Reed"), "the scatter knows it by this index")
	check(workspace().dock.panel._remove.disabled and workspace().dock.panel._copy.disabled, "layers of biomes cannot be removed or copied")
	await key(KEY_DELETE)
	check(layer("Reed") != null, "the key does not delete it")
	await mouse_click(await mark_at(layer("Reed"), 2))
	await settle(scatter)
	check(workspace().dock.marks.is_hidden(layer("Reed")), "the eye hides it")
	check_equal(scatter.get_stats().drawn, scatter.get_stats().instances - scatter.get_shown_count(layer("Reed")), "it is not drawn")
	var state: Dictionary = addon()._get_state()
	workspace().dock.marks.put(layer("Reed"), &"hidden", null)
	addon()._set_state(state)
	check(workspace().dock.marks.is_hidden(layer("Reed")), "kept by the editor, for the scene")
	workspace().dock.marks.put(layer("Reed"), &"hidden", null)
	await settle(scatter)
	check_same(saved_files(), before, "the scene does not change")


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
	check(layer("Reed").mask != null and layer("Willow").mask == null and layer("Rock").mask == null, "only on this layer")
	await settle(scatter)
	check_equal(scatter.query_rect(Rect2(0.0, -3.0, 8.0, 6.0), layer("Reed")).size(), 0, "no reed remains there")
	var after := saved_files()
	check(after != before and after.size() == before.size() + 1, "the mask is a file beside the scene: %s" % [after.keys()])
	await undo()
	check_same(saved_files(), before, "undone")
	await redo()
	check_same(saved_files(), after, "redone")
	await undo()
	paint.set_on(false)


## Replacing a biome by one assignment: the panel shows the new layers, and the old layers are no longer chosen.
func test_a_biome_is_replaced() -> void:
	await mouse_click(await name_at(layer("Reed")))
	scatter.biomes.biomes[1] = new_biome("Dry Bed", Color.RED, [new_layer("Thistle", 2.0)])
	await settle(scatter)
	await look()
	var titles: Array = tree().rows().map(func(row: TreeItem) -> String: return row.get_text(0))
	check_equal(titles, ["Rock", "Grass", "Thistle"], "the rows follow")
	check_equal(tree().row_of(layer("Thistle")).get_parent().get_text(0), "Dry Bed", "below its name")
	check_equal(workspace().toolbar.chosen, [layer("Rock")] as Array[ScatterLayer], "the tools have an existing layer")
