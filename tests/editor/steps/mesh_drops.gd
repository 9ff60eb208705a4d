@tool
extends "res://tests/layer_choices.gd"
## Drops scenes on a scatter and on a layer. Also saves a scene while a layer uses it. All changes are undone at the end.

const PINE := "res://pine.tscn"
const FOLIAGE_FILES := ["res://demo_pine_trunk.tres", "res://demo_pine_crown.tres"]


## Saves a scene of a tree with a trunk, its collision shape, and a crown.
func save_pine(crown_size: float) -> void:
	var pine := Node3D.new()
	pine.name = "Pine"
	for part: Array in [["Trunk", CylinderMesh.new(), 1.0], ["Crown", SphereMesh.new(), 3.0]]:
		var instance := MeshInstance3D.new()
		instance.name = part[0]
		instance.mesh = part[1]
		instance.mesh.material = StandardMaterial3D.new()
		instance.mesh.material.resource_name = part[0]
		instance.position.y = part[2]
		pine.add_child(instance)
		instance.owner = pine
	(pine.get_node("Crown") as MeshInstance3D).scale = Vector3.ONE * crown_size
	var shape := CollisionShape3D.new()
	shape.shape = CylinderShape3D.new()
	pine.add_child(shape)
	shape.owner = pine
	save_scene(pine, PINE)


## Returns the drop area for scenes in the inspector.
func field() -> Control:
	for control: Control in EditorInterface.get_inspector().find_children("*", "PanelContainer", true, false):
		if control.get_script() != null and control.get_script().resource_path.ends_with("mesh_drop.gd"):
			return control
	check(false, "the inspector has no drop area")
	return null


func dragged(paths: PackedStringArray) -> Dictionary:
	return {"type": "files", "files": paths}


func drop() -> void:
	save_pine(2.0)
	var filesystem := EditorInterface.get_resource_filesystem()
	filesystem.update_file(PINE)
	await frames(5)
	await inspect(scatter)
	check(field()._can_drop_data(Vector2.ZERO, dragged([PINE])), "a scene can be dropped")
	check(not field()._can_drop_data(Vector2.ZERO, dragged([PINE, "res://terrain/valley.tres"])), "a scene cannot be dropped together with other resources")
	check(not field()._can_drop_data(Vector2.ZERO, {"type": "nodes", "nodes": []}), "nodes cannot be dropped")
	var before: Array = scatter.layers
	field()._drop_data(Vector2.ZERO, dragged([PINE]))
	check_equal(scatter.layers.size(), before.size() + 1, "the drop adds a layer")
	var layer: Resource = scatter.layers[before.size()]
	check_equal(layer.resource_name, "Pine", "the layer is named after its file")
	check(layer.radius > 1.0 and layer.radius < 2.01, "the radius matches the width of the crown: %f" % layer.radius)
	check(layer.min_scale < 0.9 and layer.max_scale > 1.1 and layer.max_tilt_degrees > 0.0, "instances vary in scale and tilt")
	check_equal(layer.collision_shape, 5, "the layer uses the scene's collision shape")
	await settle(scatter)
	check(instances(scatter, before.size()).size() > 100, "many pines are placed")
	var mesh: Mesh = scatter.get_tile(layer, scatter.get_shown_tiles(layer)[0]).get_mesh(0)
	check_equal(mesh.get_surface_count(), 2, "trunk and crown are in one mesh")
	check_equal(files_of(layer), FOLIAGE_FILES, "the foliage materials are saved in files next to the scene")
	await picture("dropped")
	history(scatter).undo()
	check(not FOLIAGE_FILES.any(FileAccess.file_exists), "undo deletes the files")
	history(scatter).redo()
	check(FOLIAGE_FILES.all(FileAccess.file_exists), "redo restores the files")

	await inspect(layer)
	var radius: float = layer.radius
	field()._drop_data(Vector2.ZERO, dragged([PINE]))
	check_equal(layer.meshes.size(), 2, "a drop on a layer adds a mesh")
	check_equal(layer.radius, radius, "the radius does not change")
	await undo_last(layer)
	check_equal(layer.meshes.size(), 1, "undo removes the mesh")
	await choose_kinds(layer)
	await make_foliage(layer)
	await split_a_pack(layer)

	save_pine(4.0)
	addon().scene_saved.emit(PINE)
	await settle(scatter)
	mesh = scatter.get_tile(layer, scatter.get_shown_tiles(layer)[0]).get_mesh(0)
	check(absf(mesh.get_aabb().size.x - 4.0) < 0.01, "a saved scene is drawn with its new content: %s" % mesh.get_aabb())
	history(scatter).undo()
	check_equal(scatter.layers, before, "undo restores the layers")


## Clicks the buttons at the top of the inspector that adapt the layer to a kind of plant.
func choose_kinds(layer: Resource) -> void:
	await inspect(layer)
	var radius: float = layer.radius
	var seen := {radius: true}
	for text: String in ["Shrub", "Grass", "Rock"]:
		await click_at(center_of(kind_button(text)))
		await frames(3)
		seen[layer.radius] = true
		await picture("fit_to_" + text.to_lower())
	check_equal(seen.size(), 4, "each kind has its own spacing: %s" % [seen.keys()])
	check(layer.clump_size > 0.0 and layer.density < 1.0, "rocks are placed in groups")
	await click_at(center_of(kind_button("Auto")))
	await frames(3)
	check_equal(layer.radius, radius, "Auto restores the radius of a tree")
	for step in 4:
		await undo_last(layer)
	check(layer.radius == radius and layer.clump_size == 0.0, "undo restores the radius and the clumps")


func files_of(layer: Resource) -> Array:
	return layer.get_materials().map(func(material: Material) -> String: return material.resource_path)


## Replaces standard materials with foliage materials in files next to the scene. Undo removes these files.
func make_foliage(layer: Resource) -> void:
	var dropped: Array = layer.meshes
	var packed: Resource = load(PINE)
	layer.meshes = [packed]
	await inspect(scatter)
	await inspect(layer)
	await click_at(center_of(kind_button("Make Foliage Materials")))
	await settle(scatter)
	var model: Resource = layer.meshes[0]
	check_equal(model.get_class(), "ScatterModel", "a ScatterModel replaces the scene")
	check_equal(model.scene, packed, "the model refers to the scene")
	check_equal(model.replacement_materials.keys(), ["Trunk", "Crown"], "both materials are replaced")
	var files := files_of(layer)
	check_equal(files, ["res://demo_pine_trunk_2.tres", "res://demo_pine_crown_2.tres"], "the files are next to the scene and have unused names")
	check(layer.get_materials()[0].get_shader_parameter(&"sway_height") > 3.0, "the trunk's sway depends on its height")
	check(inspector_button("Make Foliage Materials") == null or await foliage_is_done(layer), "no material is left to convert")
	await picture("foliage")
	await undo_last(layer)
	check_equal(layer.meshes[0], packed, "undo restores the scene")
	check(not files.any(FileAccess.file_exists), "the files are removed")
	await make_foliage_of_a_mesh(layer)
	await make_foliage_of_a_model(model)
	layer.meshes = dropped


## Checks a mesh that is not in a scene: its material is replaced, and the normal map is kept.
func make_foliage_of_a_mesh(layer: Resource) -> void:
	var bark := StandardMaterial3D.new()
	bark.resource_name = "Bark"
	bark.normal_enabled = true
	bark.normal_texture = GradientTexture2D.new()
	bark.uv1_scale = Vector3(2.0, 3.0, 1.0)
	var mesh := CylinderMesh.new()
	mesh.material = bark
	layer.meshes = [mesh]
	await inspect(scatter)
	await inspect(layer)
	await click_at(center_of(kind_button("Make Foliage Materials")))
	await settle(scatter)
	var new_material := mesh.material as ShaderMaterial
	check(new_material != null and new_material.get_shader_parameter(&"normal_texture") == bark.normal_texture, "the mesh's material has the normal map")
	check_equal(new_material.get_shader_parameter(&"uv_scale"), Vector2(2.0, 3.0), "the material keeps the scale of its texture")
	await undo_last(layer)
	check_equal(mesh.material, bark, "undo restores the material")


## Clicks the button in the inspector of a model. If a replacement is a standard material, it is converted, and its key in the list is kept.
func make_foliage_of_a_model(model: Resource) -> void:
	var own := StandardMaterial3D.new()
	own.resource_name = "Own"
	model.replacement_materials = {"Trunk": own}
	await inspect(model)
	await click_at(center_of(kind_button("Make Foliage Materials")))
	check_equal(model.replacement_materials.keys(), ["Trunk", "Crown"], "both materials are replaced, keyed by their names in the scene")
	check(model.replacement_materials.values().all(func(material: Material) -> bool: return material is ShaderMaterial), "the replacements are foliage materials")
	await undo_last(model)
	check_equal(model.replacement_materials, {"Trunk": own}, "undo restores the replacement material")


func foliage_is_done(layer: Resource) -> bool:
	await inspect(scatter)
	await inspect(layer)
	return inspector_button("Make Foliage Materials") == null


func kind_button(text: String) -> Button:
	var found := inspector_button(text)
	check(found != null, "the inspector must have a button %s" % text)
	return found


func inspector_button(text: String) -> Button:
	for button: Button in EditorInterface.get_inspector().find_children("*", "Button", true, false):
		if button.text == text and button.is_visible_in_tree():
			return button
	return null


## Splits a scene with six trees side by side into six models of the layer.
func split_a_pack(layer: Resource) -> void:
	check(inspector_button("Split into 2 Models") == null, "a tree of a trunk and a crown is one model")
	var before: Array = layer.meshes
	var radius: float = layer.radius
	var pack := Node3D.new()
	pack.name = "Pack"
	for index in 6:
		var tree := MeshInstance3D.new()
		tree.name = "Tree%d" % index
		tree.mesh = CylinderMesh.new()
		tree.mesh.height = 4.0 + index
		tree.position = Vector3(5.0 * index, 2.0 + 0.5 * index, 0.0)
		pack.add_child(tree)
		tree.owner = pack
	var packed := PackedScene.new()
	packed.pack(pack)
	pack.free()
	layer.meshes = [packed]
	await inspect(scatter)
	await inspect(layer)
	var split := inspector_button("Split into 6 Models")
	if not check(split != null, "the inspector offers to split a pack"):
		return
	await picture("split_offered")
	await click_at(center_of(split))
	await frames(5)
	check_equal(layer.meshes.size(), 6, "the layer has six models")
	check(layer.radius < 4.0, "the radius matches the width of one tree: %f" % layer.radius)
	check(layer.meshes.all(func(model: Resource) -> bool: return absf(model.get_aabb().get_center().x) < 0.01), "each model is centered at the origin")
	await undo_last(layer)
	check_equal(layer.meshes, [packed], "undo restores the scene")
	layer.meshes = before
	check_equal(layer.radius, radius, "undo restores the radius")
	await inspect(scatter)
	await inspect(layer)


func center_of(control: Control) -> Vector2:
	return control.get_global_rect().get_center()
