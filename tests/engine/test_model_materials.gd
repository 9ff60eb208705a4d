extends "models_harness.gd"
## Tests replacing the materials of a model's scene.


## A scene's materials are replaced by name in all LODs. The scene itself is unchanged.
func test_materials_are_replaced_by_name() -> void:
	var scene := Node3D.new()
	var bark := material_of(TRUNK)
	bark.resource_name = "Bark"
	var leaves := material_of(LEAF)
	leaves.resource_name = "Leaves"
	for level in 2:
		put_mesh(box(Vector3(1, 4, 1), bark), "Trunk_LOD%d" % level, scene, scene)
		put_mesh(box(Vector3(3, 3, 3), leaves), "Crown_LOD%d" % level, scene, scene, Transform3D(Basis(), Vector3(0, 4, 0)))
	var model := ScatterModel.new()
	model.scene = pack(scene)
	var other := ShaderMaterial.new()
	var changes := [0]
	model.changed.connect(func() -> void: changes[0] += 1)
	model.replacement_materials = {"Leaves": other}
	check_equal(changes[0], 1, "changes")
	for level in 2:
		var mesh := model.get_mesh(level)
		check_equal(range(2).map(func(surface: int) -> Material: return mesh.surface_get_material(surface)), [bark, other], "materials of LOD %d" % level)
	check(model.replacement_materials.is_read_only(), "the dictionary is read-only")
	model.replacement_materials = {"Leaves": 3}
	check_error(["ScatterModel.replacement_materials", "Leaves", "3"], "a number instead of a material")
	model.replacement_materials = {7: other}
	check_error(["ScatterModel.replacement_materials", "7"], "a number instead of a name")
	check_equal(model.replacement_materials, {"Leaves": other}, "the last value stays")
	model.replacement_materials = {}
	check_equal(model.get_mesh(0).surface_get_material(1), leaves, "the scene's material is back")


func test_a_material_is_named_by_its_resource_name_or_its_file() -> void:
	var model := ScatterModel.new()
	var material := material_of(LEAF)
	check_equal([model.get_material_name(null), model.get_material_name(material)], ["", ""], "no name")
	ResourceSaver.save(material, "user://moss.tres")
	check_equal(model.get_material_name(load("user://moss.tres")), "moss", "the file's")
	material.resource_name = "Fern"
	check_equal(model.get_material_name(material), "Fern", "the resource name of the material")
