extends "import_harness.gd"
## Tests imports of tables of transforms: every supported form, and the error for every kind of mistake.


func table(text: String) -> String:
	var file := FileAccess.open("user://thicket_table.csv", FileAccess.WRITE)
	file.store_string(text)
	file.close()
	return "user://thicket_table.csv"


func one(text: String) -> Transform3D:
	var scatter := make_bare([make_layer()])
	scatter.layers[0].density = 0.0
	check_equal(ImportInstances.from_csv(scatter, scatter.layers[0], table(text)), 1, text)
	var found := scatter.query_rect(Rect2(-100, -100, 200, 200))
	return found.get_transform(0) if found.size() == 1 else Transform3D()


func check_near(got: Transform3D, expected: Transform3D, context: String) -> void:
	check(got.is_equal_approx(expected) and got.origin == expected.origin, "%s: got %s, expected %s" % [context, got, expected])


func test_tables() -> void:
	check_near(one("1.5,2,-3"), Transform3D(Basis(), Vector3(1.5, 2, -3)), "a position")
	check_near(one("\ufeffx;y;z\r\n\r\n# a comment\r\n1.5;2;-3\r\n"), Transform3D(Basis(), Vector3(1.5, 2, -3)), "with a header")
	var node := Node3D.new()
	node.position = Vector3(1, 2, 3)
	node.rotation_degrees = Vector3(10, 20, 30)
	check_near(one("1,2,3,10,20,30"), node.transform, "with a rotation")
	node.scale = Vector3(2, 2, 2)
	check_near(one("1\t2\t3\t10\t20\t30\t2"), node.transform, "with a uniform scale")
	node.scale = Vector3(2, 0.5, 3)
	check_near(one("1,2,3,10,20,30,2,0.5,3"), node.transform, "with a scale per axis")
	check_near(one("\"sy\",rotation_x,ry,RZ,z,y,x,sx,scale_z\n0.5,10,20,30,3,2,1,2,\"3\""), node.transform, "columns in any order")
	node.rotation = Vector3.ZERO
	node.scale = Vector3.ONE * 1.25
	check_near(one("scale,x,y,z\n1.25,1,2,3"), node.transform, "some columns")
	node.free()
	var exact := some_transforms(500)
	var lines := PackedStringArray(["a,b,c,d,e,f,g,h,i,j,k,l"])
	for at in exact:
		var numbers := PackedStringArray()
		for number in floats_of_transforms([at]):
			numbers.push_back(String.num_scientific(number))
		lines.push_back(",".join(numbers))
	var scatter := make_bare([make_layer()])
	scatter.layers[0].density = 0.0
	check_equal(ImportInstances.from_csv(scatter, scatter.layers[0], table("\n".join(lines))), 500, "rows of 12 numbers are imported")
	var wrong := 0
	var standing := {}
	var found := scatter.query_rect(Rect2(-200, -200, 400, 400))
	for index in found.size():
		standing[found.get_transform(index)] = true
	for at in exact:
		wrong += int(not standing.has(at))
	check(wrong == 0, "%d of 500 are not exact" % wrong)


func test_bad_tables_have_no_effect() -> void:
	var scatter := make_bare([make_layer()])
	for bad: Array in [
			["1,2,3\n1,b,3\n4,5,6", ["line 2", "position_y", "'b'"]], ["x,y,z\n1,2", ["line 2", "values must be 3", "got 2"]],
			["1,2\n", ["line 1", "columns must be 3, 6", "got 2"]], ["x,y,roation_x,z\n1,2,3,4", ["line 1", "'roation_x'"]], ["x,y\n1,2", ["line 1", "position_z"]],
			["x,y,z,x\n1,2,3,4", ["line 1", "'x'", "twice"]], ["1,2,3\n\n1,2,1e40", ["line 3", "position_z", "10^9"]],
			["1,2,nan\n", ["line 1", "'nan'"]], ["1,b,3\n4,5,6", ["line 1", "position_y", "'b'"]], ["\n", ["no transforms"]],
			["x,y,z", ["no transforms"]],
			["1,2,3\n1,2,inf", ["line 2", "'inf'"]]]:
		check_equal(ImportInstances.from_csv(scatter, scatter.layers[0], table(bad[0])), 0, str(bad[0]))
		check_error(bad[1], str(bad[0]))
	ImportInstances.from_csv(scatter, scatter.layers[0], "user://not_there.csv")
	check_error(["not_there.csv", "cannot be opened"], "no file")
	ImportInstances.from_csv(scatter, null, table("1,2,3"))
	check_error(["layer"], "no layer")
	check(scatter.state == null or scatter.state.get_added_count() == 0, "no instance was added")
	check_equal(scatter.layers.size(), 1, "no layer was added")
