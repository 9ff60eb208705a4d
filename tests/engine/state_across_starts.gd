extends "harness.gd"
## Fells trees and saves the state in one process (`-- test_save DIR`). Loads the state in a second process (`-- test_load DIR`) and checks
## that the trees are still felled.

var folder := arguments[1] if arguments.size() > 1 else "user://"


func make_wood() -> TerrainScatter3D:
	return make_scatter([make_layer(3.0)], ScatterGroundFlat.new(), make_viewer())


func test_save() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var felled := scatter.remove_in_sphere(Vector3(10, 0, 10), 15.0)
	check(felled.size() > 20, "%d trees are felled" % felled.size())
	var placed := scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(11.5, 2.0, 9.25)))
	scatter.set_instance_data(placed, {"planted": "spring"})
	for ending: String in [".tres", ".res"]:
		check_equal(ResourceSaver.save(scatter.state, folder.path_join("state" + ending)), OK, "saved as " + ending)
	check_equal(scatter.state.save_to_file(folder.path_join("state.bytes")), OK, "saved as bytes")
	var notes := FileAccess.open(folder.path_join("notes"), FileAccess.WRITE)
	notes.store_var([felled, placed, scatter.state.get_digest(), digests(scatter, 0)])


func test_load() -> void:
	var noted: Array = FileAccess.open(folder.path_join("notes"), FileAccess.READ).get_var()
	for ending: String in [".tres", ".res", ".bytes"]:
		var scatter := make_wood()
		var path := folder.path_join("state" + ending)
		if ending == ".bytes":
			scatter.state = ScatterState.new()
			check_equal(scatter.state.load_from_file(path), OK, "loaded")
		else:
			scatter.state = ResourceLoader.load(path, "", ResourceLoader.CACHE_MODE_IGNORE) as ScatterState
		await settle(scatter)
		check_equal(scatter.state.get_digest(), noted[2], "digest from " + ending)
		for id: int in noted[0]:
			check(not scatter.has_instance(id), "%d is felled" % id)
		check_equal(scatter.get_instance_data(noted[1]), {"planted": "spring"}, "data")
		check_equal((scatter.get_instance(noted[1]).transform as Transform3D).origin, Vector3(11.5, 2.0, 9.25), "the planted instance")
		check_equal(digests(scatter, 0), noted[3], "the tiles from " + ending)
		scatter.free()
