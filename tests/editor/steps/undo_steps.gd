@tool
extends "res://tests/steps.gd"
## Checks that each change that the plugin makes to a scene is one undo step. Undo and redo must restore the saved scene and the files next to it,
## byte for byte. Tests each step alone, then all of them one by one, and then all together.

const BakeReplacement := preload("res://addons/thicket/editor/bake/bake_replacement.gd")
const GroundButtons := preload("res://addons/thicket/editor/ground/ground_buttons.gd")
const ImpostorButton := preload("res://addons/thicket/editor/inspector/impostor_button.gd")
const LayerChoice := preload("res://addons/thicket/editor/inspector/layer_property.gd")
const LayerChoices := preload("res://addons/thicket/editor/inspector/layer_list_property.gd")
const LayerEdits := preload("res://addons/thicket/editor/layers/layer_edits.gd")
const MeshDrop := preload("res://addons/thicket/editor/layers/mesh_drop.gd")
const Shared := preload("res://addons/thicket/editor/layers/shared_layers.gd")
const SpacingEditor := preload("res://addons/thicket/editor/inspector/spacing_editor.gd")
const SCENE := "res://heath.tscn"
const FERN := "res://fern.tres"
const MOSS := "res://moss.tres"
const TABLE := "res://stones.txt"

var root: Node
var scatter: Node3D
var manager: EditorUndoRedoManager

# The saved files before the first step and after each step.
var _saved: Array[Dictionary] = []
var _names := PackedStringArray()


func make_layer(title: String, radius: float) -> Resource:
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = title
	layer.meshes = [BoxMesh.new()]
	layer.meshes[0].size = Vector3(0.2, 0.4, 0.2)
	layer.radius = radius
	layer.view_distance = 40.0
	layer.tile_size = 16.0
	return layer


func add(node: Node, title: String, parent: Node, owner_of_all: Node) -> Node:
	node.name = title
	parent.add_child(node)
	node.owner = owner_of_all
	return node


## Saves a scene with a mesh and a body for a ground, instances to import, regions that refer to layers, and a layer in its own file.
func make_scene() -> void:
	ResourceSaver.save(make_layer("Moss", 3.0), MOSS)
	ResourceSaver.save(make_layer("Fern", 2.0), FERN)
	FileAccess.open(TABLE, FileAccess.WRITE).store_string("x,y,z,scale\n-10,0,-3,1.5\n-11,0,-3,2\n")
	var heath := Node3D.new()
	heath.name = "Heath"
	var ground := add(MeshInstance3D.new(), "Ground", heath, heath) as MeshInstance3D
	ground.mesh = PlaneMesh.new()
	(ground.mesh as PlaneMesh).size = Vector2(60.0, 60.0)
	var body := add(StaticBody3D.new(), "Floor", heath, heath)
	var shape := add(CollisionShape3D.new(), "Shape", body, heath) as CollisionShape3D
	shape.shape = BoxShape3D.new()
	var old := add(MultiMeshInstance3D.new(), "Old", heath, heath) as MultiMeshInstance3D
	old.multimesh = MultiMesh.new()
	old.multimesh.transform_format = MultiMesh.TRANSFORM_3D
	old.multimesh.mesh = CylinderMesh.new()
	old.multimesh.instance_count = 20
	for index in 20:
		old.multimesh.set_instance_transform(index, Transform3D(Basis(), Vector3(0.7 * index, 0.0, 5.0)))
	var new_scatter: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	add(new_scatter, "Scatter", heath, heath)
	new_scatter.position = Vector3(1.0, 0.0, 0.5)
	new_scatter.ground = ClassDB.instantiate(&"ScatterGroundFlat")
	new_scatter.layers = [make_layer("Grass", 1.5), make_layer("Trees", 4.0), load(MOSS)]
	new_scatter.layers[1].spacing = {"Grass": 0.5, new_scatter.layers[2]: 1.0}
	new_scatter.layers[0].proximity_layer = "Trees"
	new_scatter.layers[1].color_value = ClassDB.instantiate(&"ScatterValueSource")
	new_scatter.layers[1].color_value.source = 5 # SOURCE_DISTANCE, whose layer is not set yet.
	for kind in 4:
		var region := add(ClassDB.instantiate(&"ScatterRegion3D"), "Region%d" % kind, new_scatter, heath) as Node3D
		region.shape = kind
		region.size = Vector3(2.0, 2.0, 2.0)
		region.position = Vector3(4.0 * kind - 8.0, 0.0, -9.0)
		region.polygon = PackedVector2Array([Vector2(-1, -1), Vector2(1, -1), Vector2(0, 1)])
		region.layers = ["Grass", "Trees"] if kind < 2 else []
	save_scene(heath, SCENE)


func select(node: Node) -> void:
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(node)
	EditorInterface.edit_node(node)
	await frames(3)


func layer(title: String) -> Resource:
	for each: Resource in scatter.layers:
		if each.resource_name == title:
			return each
	check(false, "there is a layer " + title)
	return null


## Makes a change, undoes and redoes it, and checks the saved files each time.
func step(title: String, change: Callable) -> void:
	_names.append(title)
	@warning_ignore("redundant_await")
	await change.call()
	await frames(3)
	var after := saved_files()
	check(after != _saved[-1], title + " changes the saved files")
	await undo()
	check_same(saved_files(), _saved[-1], title + ", undone")
	await redo()
	check_same(saved_files(), after, title + ", redone")
	_saved.append(after)
	await settle(scatter)


func test_open() -> void:
	make_scene()
	root = await open(SCENE)
	scatter = root.get_node("Scatter")
	manager = plugin.get_undo_redo()
	EditorInterface.set_main_screen_editor("3D")
	await select(scatter)
	await settle(scatter)
	# The editor adds data when it first saves a file. Later saves do not change the files.
	saved_files()
	_saved.append(saved_files())


func test_layers() -> void:
	var panel: Control = workspace().dock.panel
	await step("New layers", panel.add.bind([make_layer("Heather", 1.0), SphereMesh.new()] as Array[Resource]))
	await step("An empty layer", panel._on_add.bind(panel.Add.EMPTY))
	await step("Meshes for the empty layer", func() -> void: MeshDrop.add(layer("Layer"), [BoxMesh.new()] as Array[Resource], panel._files, manager))
	await step("A preset", panel._on_add.bind(panel.Add.FIRST_PRESET + 1))
	await step("A name", func() -> void: LayerEdits.rename(scatter, layer("Grass"), "Sedge", manager))
	await step("A new name of a layer in a file", func() -> void: LayerEdits.rename(scatter, layer("Moss"), "Lichen", manager))
	await step("A proximity layer", choose_in_inspector.bind(layer("Trees"), &"proximity_layer"))
	await step("A layer for a color source", choose_in_inspector.bind(layer("Trees").color_value, &"layer"))
	await step("A new order of layers", func() -> void: LayerEdits.move(scatter, [layer("Trees")], 0, manager))
	await step("A distance in the inspector", func() -> void:
		EditorInterface.inspect_object(layer("Heather"), "", true)
		await frames(4)
		for property in EditorInterface.get_inspector().find_children("*", "EditorProperty", true, false):
			if property is SpacingEditor:
				property._set_distance(0.75, "Trees", false))
	await step("A layer from a file", panel._on_file_chosen.bind(FERN))
	check(scatter.layers.any(func(each: Resource) -> bool: return each.resource_path == FERN), "the file is among the layers")
	await step("Meshes for a layer in a file", func() -> void: MeshDrop.add(layer("Lichen"), [SphereMesh.new()] as Array[Resource], panel._files, manager))
	await select(scatter)


## Chooses the first layer in the inspector's list for a property.
func choose_in_inspector(object: Object, property: StringName) -> void:
	EditorInterface.inspect_object(object, "", true)
	await frames(4)
	for editor in EditorInterface.get_inspector().find_children("*", "EditorProperty", true, false):
		if editor is LayerChoice and editor.get_edited_property() == property:
			editor._on_selected(1)


func stroke_of(mode: int, titles: PackedStringArray, at: Vector3) -> void:
	var layers: Array[ScatterLayer] = []
	for title in titles:
		layers.append(layer(title))
	var brush: RefCounted = workspace().toolbar.paint.brush
	brush.radius = 4.0
	check_equal(brush.begin(scatter, layers, SCENE, mode, at), "", "the stroke starts")
	brush.move(at + Vector3(6.0, 0.0, 0.0))
	brush.finish(manager)


func test_masks() -> void:
	await step("The first stroke", stroke_of.bind(1, ["Sedge", "Trees"], Vector3(2.0, 0.0, 3.0)))
	await step("A second stroke", stroke_of.bind(1, ["Sedge"], Vector3(2.0, 0.0, 8.0)))
	await step("A stroke that paints", stroke_of.bind(0, ["Sedge"], Vector3(0.0, 0.0, 5.0)))
	await step("A stroke that smooths", stroke_of.bind(2, ["Sedge", "Trees"], Vector3(1.0, 0.0, 3.0)))
	await step("The first stroke that paints", stroke_of.bind(0, ["Heather"], Vector3(-5.0, 0.0, 3.0)))
	await step("The first stroke on a layer in a file", stroke_of.bind(1, ["Lichen"], Vector3(-5.0, 0.0, 3.0)))
	check(FileAccess.get_file_as_string(MOSS).contains("heath_lichen_mask.res"), "a layer in a file is saved with its mask")
	await step("A copy of painted layers", func() -> void:
		workspace().dock.panel.choose([layer("Sedge"), layer("Trees")] as Array[ScatterLayer])
		workspace().dock.panel.duplicate_chosen())
	await step("A removed layer", func() -> void: LayerEdits.remove(scatter, [layer("Trees")], manager))


func by_hand(change: Callable) -> void:
	var edits: RefCounted = workspace().toolbar.hand.edits
	check(edits.begin(scatter, SCENE), "the edit starts: " + edits.problem)
	change.call(edits)
	edits.commit("By Hand")


func import_from(source: Variant, layer_index: int) -> void:
	var dialog: ConfirmationDialog = workspace().imports
	dialog.fill(scatter, root)
	if source is Node:
		dialog.choose_node(source)
	else:
		dialog.choose_table(source)
	dialog.choose_layer(layer_index)
	dialog.start()
	check(dialog.imported > 0, "instances are imported: " + dialog.message())


func test_instances() -> void:
	var sedge := layer("Sedge")
	var by_rules: int = scatter.query_nearest(Vector3(-8.0, 0.0, -3.0), 9.0, sedge).id
	var planted := []
	await step("A plant", by_hand.bind(func(edits: RefCounted) -> void:
		planted.append(edits.add(sedge, Transform3D(Basis(), Vector3(1.0, 0.0, 2.0)), 0))))
	await step("Two plants", by_hand.bind(func(edits: RefCounted) -> void:
		for x: float in [3.0, 4.0]:
			edits.add(sedge, Transform3D(Basis(), Vector3(x, 0.0, 2.0)), 0)))
	await step("A move", by_hand.bind(func(edits: RefCounted) -> void:
		edits.set_transform(planted[0], Transform3D(Basis(Vector3.UP, 1.0), Vector3(1.5, 0.0, 2.5)))))
	await step("A move of a generated instance", by_hand.bind(func(edits: RefCounted) -> void:
		edits.set_transform(by_rules, Transform3D(Basis(), Vector3(-8.0, 0.5, -3.0)))))
	await step("A removed plant", by_hand.bind(func(edits: RefCounted) -> void: edits.remove(planted[0])))
	await step("An import from a node", import_from.bind(root.get_node("Old"), -1))
	await step("An import from a table", import_from.bind(TABLE, scatter.layers.find(sedge)))


func drag_handle(region: Node3D, handle: int, to: Vector3) -> void:
	var gizmo := region.get_gizmos()[0] as EditorNode3DGizmo
	var gizmos := gizmo.get_plugin()
	gizmos._begin_handle_action(gizmo, handle, false)
	var restore: Variant = gizmos._get_handle_value(gizmo, handle, false)
	gizmos._set_handle(gizmo, handle, false, camera(), camera().unproject_position(region.to_global(to)))
	gizmos._commit_handle(gizmo, handle, false, restore, false)


func test_regions() -> void:
	var menu: Node = workspace().toolbar.regions
	for kind: int in [0, 1, 2]:
		await select(scatter)
		await step("A region of shape %d" % kind, menu._on_chosen.bind(kind))
	for kind: int in [4, 8]:
		await select(scatter)
		await step("A drawn region of shape %d" % (kind % 5), func() -> void:
			var drawing: Node = workspace().toolbar.region_drawing
			menu._on_chosen(kind)
			drawing.corners = PackedVector3Array([Vector3(-1, 0, -1), Vector3(1, 0, -1), Vector3(0, 0, 1)])
			drawing.close())
	await step("Layers of a region", func() -> void:
		EditorInterface.edit_node(scatter.get_node("Region2"))
		await frames(4)
		for editor in EditorInterface.get_inspector().find_children("*", "EditorProperty", true, false):
			if editor is LayerChoices:
				editor._toggle(true, layer("Sedge")))
	for kind in 4:
		await select(scatter.get_node("Region%d" % kind))
		var at: Vector3 = [Vector3(1.7, 0.0, 0.0), Vector3(6.0, 0.0, 0.0), Vector3(6.0, 0.0, 0.0), Vector3(-1.3, 0.0, -1.2)][kind]
		await step("A handle of shape %d" % kind, drag_handle.bind(scatter.get_node("Region%d" % kind), 0, at))
	await select(scatter)


func bake_impostors(frames_a_side: int) -> void:
	var button: Node = ImpostorButton.new(layer("Sedge"), workspace().toolbar.paint.brush.files)
	plugin.add_child(button)
	button.job.impostor.frames = frames_a_side
	button.job.impostor.frame_size = 16
	button.press()
	await until(func() -> bool: return not button.is_processing(), "baked")
	check_equal(button.job.problem, "", "problem")
	button.free()


func test_files() -> void:
	await step("Impostors", bake_impostors.bind(3))
	await step("New impostors in the same files", bake_impostors.bind(4))
	check_equal(layer("Sedge").get_mesh_lods(0)[-1].mesh.resource_path, "res://heath_sedge_impostor_0.res", "the layer refers to the file")
	await step("A bake that replaces instances", func() -> void:
		var dialog: Node = workspace().bake
		dialog.choose_folder("res://baked")
		dialog.fill(scatter, Rect2(0.0, 0.0, 6.0, 6.0))
		dialog.choose_replacing(true)
		dialog.start()
		await until(func() -> bool: return not dialog.is_processing(), "baked")
		check_equal(dialog.job.problem, "", "problem"))


func test_nodes() -> void:
	await step("A duplicate", func() -> void:
		var other := scatter.duplicate()
		manager.create_action("Duplicate", UndoRedo.MERGE_DISABLE, root)
		manager.add_do_method(root, &"add_child", other, true)
		manager.add_do_property(other, &"owner", root)
		manager.add_do_reference(other)
		manager.add_undo_method(root, &"remove_child", other)
		manager.commit_action())
	await step("A unique duplicate", func() -> void:
		var other: Node3D = root.get_node("Scatter2")
		check_equal(Shared.make_unique(other, true, true, workspace().toolbar.paint.brush.files, SCENE, manager), "", "made unique"))
	await step("A mesh as ground", func() -> void: GroundButtons.use(scatter, [root.get_node("Ground")] as Array[Node], manager))
	await step("A second scatter", workspace().dock.panel.add_scatter)
	await step("A body as its ground", func() -> void: GroundButtons.use(root.get_child(-1), [root.get_node("Floor")] as Array[Node], manager))


## Undoes and redoes all steps and checks the saved files after each.
func test_all_one_by_one() -> void:
	for index in range(_names.size() - 1, -1, -1):
		await undo()
		check_same(saved_files(), _saved[index], _names[index] + ", undone with all later steps")
	for index in _names.size():
		await redo()
		check_same(saved_files(), _saved[index + 1], _names[index] + ", redone after all earlier steps")


## Undoes and redoes all steps and checks the saved files only at both ends.
func test_all_together() -> void:
	for title in _names:
		await undo()
	check_same(saved_files(), _saved[0], "all steps are undone")
	for title in _names:
		await redo()
	check_same(saved_files(), _saved[-1], "all steps are redone")
