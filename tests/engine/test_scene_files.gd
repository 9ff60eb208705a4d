extends "harness.gd"
## Tests that the editor's tools report files that they cannot read or write, and retry writing them.

const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")
const Presets := preload("res://addons/thicket/editor/layers/presets.gd")
const LayerEdits := preload("res://addons/thicket/editor/layers/layer_edits.gd")

const FOLDER := "user://scene_files"
const PATH := FOLDER + "/mask.res"


## If a file cannot be written, the next call tries again.
func test_failed_writes_are_repeated() -> void:
	DirAccess.remove_absolute(PATH)
	DirAccess.remove_absolute(FOLDER)
	var mask := ScatterMask.new()
	mask.take_over_path(PATH)
	var files := SceneFiles.new()
	files.mark(mask)
	files.save()
	check(not errors.take().is_empty(), "an error: the folder is missing")
	DirAccess.make_dir_absolute(FOLDER)
	files.save()
	check(FileAccess.file_exists(PATH), "the file is written when the folder exists")
	DirAccess.remove_absolute(PATH)
	files.save()
	check(not FileAccess.file_exists(PATH), "the file is not written a second time")


func test_a_preset_that_is_missing_is_reported() -> void:
	check(Presets.open("moor") == null, "no layers")
	check_error(["moor", "forest, meadow, pine_wood"], "no such preset")


## The message names each dropped resource that did not become a layer.
func test_skipped_resources_are_named() -> void:
	var drawn := BoxMesh.new()
	var empty := ArrayMesh.new()
	empty.resource_path = "res://empty.res"
	var layer := ScatterLayer.new()
	layer.meshes = [drawn]
	var sentence := LayerEdits.skipped_message([drawn, empty, layer], [layer])
	check("res://empty.res" in sentence and not "BoxMesh" in sentence and not "ScatterLayer" in sentence, sentence)
	check_equal(LayerEdits.skipped_message([drawn], [layer]), "", "nothing is skipped")
