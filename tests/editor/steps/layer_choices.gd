@tool
extends "res://tests/steps.gd"
## Checks that properties that refer to layers offer a list in the inspector, and that renaming a layer updates all references to it, with undo.

var scatter: Node3D


## Returns the inspector's editor for a property, or null.
func property_editor(property: StringName) -> EditorProperty:
	for editor: EditorProperty in EditorInterface.get_inspector().find_children("*", "EditorProperty", true, false):
		if editor.get_edited_property() == property:
			return editor
	check(false, "the inspector does not show %s" % property)
	return null


func inspect(object: Object) -> void:
	if object is Resource:
		EditorInterface.edit_resource(object)
	else:
		EditorInterface.edit_node(object)
	await frames(5)
	for section in EditorInterface.get_inspector().find_children("*", "EditorInspectorSection", true, false):
		section.call(&"unfold")
	await frames(2)


## Presses an option button and returns the texts of its items.
func items(button: OptionButton) -> PackedStringArray:
	button.pressed.emit()
	var result := PackedStringArray()
	for index in button.item_count:
		result.append(button.get_item_text(index))
	return result


func undo_last(object: Object) -> void:
	var manager := plugin.get_undo_redo()
	manager.get_history_undo_redo(manager.get_object_history_id(object)).undo()
	await frames(3)


## Runs all checks on a scatter with one layer named "Posts", and finally undoes all changes.
func choose() -> void:
	workspace().toolbar.preset_chosen.emit("forest")
	var names: Array = scatter.layers.map(func(layer: Resource) -> String: return layer.resource_name)
	check_equal(scatter.layers.map(func(layer: Resource) -> int: return layer.layer_id), [0, 1, 2, 3, 4, 5, 6, 7, 8], "all layers have consecutive IDs")
	var fern: Resource = scatter.layers[names.find("Fern")]
	fern.proximity_layer = "Spruce"
	fern.spacing = {"Spruce": 0.7, "Birch": 0.7, "Bush": 1.0}
	await inspect(fern)
	var choice: OptionButton = property_editor(&"proximity_layer").find_children("*", "OptionButton", true, false)[0]
	check_equal(items(choice), PackedStringArray(["None", "Posts", "Spruce", "Oak", "Birch", "Bush", "Stone", "Deadwood"]), "layers before the ferns")
	check_equal(choice.get_item_text(choice.selected), "Spruce", "the list shows the current choice")
	choice.item_selected.emit(4)
	check_equal(fern.proximity_layer, "Birch", "choosing a layer sets the property")
	await undo_last(fern)
	check_equal(fern.proximity_layer, "Spruce", "undo restores the choice")
	for property: StringName in [&"color_value", &"variation_value", &"scale_value"]:
		var value: Resource = ClassDB.instantiate(&"ScatterValueSource")
		value.set(&"source", 5) # SOURCE_DISTANCE.
		fern.set(property, value)
		await inspect(value)
		choice = property_editor(&"layer").find_children("*", "OptionButton", true, false)[0]
		check_equal(items(choice), PackedStringArray(["None", "Posts", "Spruce", "Oak", "Birch", "Bush", "Stone", "Deadwood"]), "layers before the ferns")
		choice.item_selected.emit(1)
		check_equal(value.get(&"layer"), "Posts", property + " refers to a layer")
		await undo_last(value)
		check_equal(value.get(&"layer"), "", "undo clears the layer")
		fern.set(property, null)
	fern.set(&"on_surfaces", true)
	await inspect(fern)
	var boxes := property_editor(&"surface_layers").find_children("*", "CheckBox", true, false)
	check_equal(boxes.map(func(box: CheckBox) -> String: return box.text), names.slice(0, names.find("Fern")), "a box for each layer before the ferns")
	boxes[5].button_pressed = true
	await frames(3)
	check_equal(fern.get(&"surface_layers"), ["Stone"], "the checked box makes ferns grow on stones")
	await undo_last(fern)
	check_equal(fern.get(&"surface_layers"), [], "undone: grows on the ground")
	fern.set(&"on_surfaces", false)
	await inspect(fern)
	var spacing := property_editor(&"spacing")
	EditorInterface.get_inspector().ensure_control_visible(spacing)
	await picture("neighbors")
	var add: MenuButton = spacing.find_children("*", "MenuButton", true, false)[0]
	add.about_to_popup.emit()
	check_equal(add.get_popup().get_item_text(2), "Stone", "the menu offers a layer that has no distance yet")
	add.get_popup().index_pressed.emit(2)
	await frames(3)
	check_equal(fern.spacing.keys(), ["Spruce", "Birch", "Bush", "Stone"], "a distance is added")
	var sliders := spacing.find_children("*", "EditorSpinSlider", true, false)
	check_equal(sliders.size(), 4, "one row per distance")
	sliders[3].value = 2.5
	check_equal(fern.spacing["Stone"], 2.5, "the slider sets the distance")
	check(spacing.find_children("*", "EditorSpinSlider", true, false)[3] == sliders[3], "the dragged row stays")
	await frames(2)
	(spacing.find_children("*", "Button", true, false).filter(func(button: Button) -> bool: return button.icon != null)[0] as Button).pressed.emit()
	check_equal(fern.spacing.keys(), ["Birch", "Bush", "Stone"], "the button removes the distance")
	await undo_last(fern)
	check(fern.spacing.has("Spruce"), "undone: %s" % fern.spacing)
	var region: Node3D = ClassDB.instantiate(&"ScatterRegion3D")
	scatter.add_child(region)
	region.owner = EditorInterface.get_edited_scene_root()
	await inspect(region)
	var ticks := property_editor(&"layers").find_children("*", "CheckBox", true, false)
	check_equal(ticks.map(func(box: CheckBox) -> String: return box.text), names, "a box for each layer")
	ticks[1].button_pressed = true
	await frames(3)
	check_equal(region.layers, ["Spruce"], "one box is checked")
	property_editor(&"layers").find_children("*", "CheckBox", true, false)[3].button_pressed = true
	await frames(3)
	await picture("region_layers")
	check_equal(region.layers, ["Spruce", "Birch"], "two boxes are checked")
	var spruce: Resource = scatter.layers[1]
	var undo_redo := plugin.get_undo_redo()
	undo_redo.create_action("Rename Layer", UndoRedo.MERGE_DISABLE, scatter)
	undo_redo.add_do_property(spruce, &"resource_name", "Fir")
	undo_redo.add_undo_property(spruce, &"resource_name", "Spruce")
	undo_redo.commit_action()
	check_equal([fern.proximity_layer, region.layers], ["Fir", ["Fir", "Birch"]], "all references refer to the renamed layer")
	check(fern.spacing.has("Fir") and scatter.get_problems().is_empty(), "no problems: %s" % scatter.get_problems())
	history(scatter).undo()
	check_equal([fern.proximity_layer, region.layers], ["Spruce", ["Spruce", "Birch"]], "undo renames all references back")
	await inspect(fern)
	EditorInterface.get_inspector().scroll_vertical = 0
	await picture("layer")
	while scatter.layers.size() > 1 and history(scatter).has_undo():
		history(scatter).undo()
	check_equal(scatter.layers.size(), 1, "undo removes the preset's layers")
	# The region is freed last, because undoing an action of a freed node prints an error.
	region.queue_free()
	await frames(2)
