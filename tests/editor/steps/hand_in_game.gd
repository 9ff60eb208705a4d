extends SceneTree
## Loads the scene that hand.gd saved, as a game does. The planted instances must be bit-identical, and the game's changes must not affect the scene.

const SCENE := "res://field.tscn"

var failures := 0


func check(condition: bool, message: String) -> void:
	if not condition:
		failures += 1
		print("FAILED: " + message)


func settled(field: Node) -> Node3D:
	root.add_child(field)
	var scatter := field.get_node("Rocks") as Node3D
	scatter.set(&"viewers", [scatter.get_path_to(field.get_node("Ramp"))] as Array[NodePath])
	await process_frame
	while not scatter.is_settled():
		await process_frame
	return scatter


func _initialize() -> void:
	var noted: Array = FileAccess.open("res://noted.bin", FileAccess.READ).get_var()
	var first := await settled((load(SCENE) as PackedScene).instantiate())
	var second := await settled((load(SCENE) as PackedScene).instantiate())
	check(first.state.get_digest() == noted[2], "the loaded state is the one that the designer saved")
	var drawn := {}
	for layer in 2:
		for tile: Vector2i in first.get_shown_tiles(first.layers[layer]):
			for id: int in first.get_tile(first.layers[layer], tile).get_ids(0):
				drawn[id] = true
	for id: int in noted[0]:
		check(first.get_instance(id) != null and first.get_instance(id).transform == noted[0][id], "%d is at its planted position" % id)
		check(drawn.has(id), "%d is drawn" % id)
	for id: int in noted[1]:
		check(not first.has_instance(id) and not drawn.has(id), "%d was deleted" % id)
	# Each instance of the scene has its own copy of the state, even one that is loaded later.
	var planted: int = noted[0].keys()[0]
	var designed: int = first.state.get_revision()
	first.remove_instance(planted)
	var grown: int = first.add_instance(first.layers[0], Transform3D(Basis(), Vector3(4.0, 0.0, 4.0)))
	check(second.has_instance(planted) and not second.has_instance(grown), "changes to one instance of the scene do not affect the other")
	var saved: PackedByteArray = first.state.diff_since(designed, false)
	check(saved.size() < 200, "the diff of a game's changes takes less than 200 bytes: %d" % saved.size())
	first.get_parent().free()
	var again := await settled((load(SCENE) as PackedScene).instantiate())
	check(again.has_instance(planted), "the reloaded scene is unchanged")
	check(again.state.apply_diff(saved) == OK, "the saved changes are applied")
	check(not again.has_instance(planted) and again.has_instance(grown), "the changes are visible in the game")
	for id: int in noted[0]:
		check(id == planted or again.has_instance(id), "in addition to the designer's instances")
	print("hand in game: %d failed" % failures)
	quit(mini(failures, 1))
