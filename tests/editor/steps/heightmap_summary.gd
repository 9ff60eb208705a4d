@tool
extends "res://tests/steps.gd"
## Checks that the inspector of a heightmap shows its size, spacing, range and format, a thumbnail, and the reason why it cannot be
## read. No node uses the heightmap.

const PATH := "res://heights.png"


func _inspector_parts(kind: String) -> Array[Node]:
	return EditorInterface.get_inspector().find_children("*", kind, true, false).filter(func(part: Control) -> bool:
		return part.get_parent().get_script() != null and part.get_parent().get_script().resource_path.ends_with("heightmap_summary.gd"))


func _summary_text() -> String:
	var labels := _inspector_parts("Label")
	return (labels[0] as Label).text if labels.size() == 1 else ""


func test_summary() -> void:
	var image := Image.create_empty(5, 4, false, Image.FORMAT_L8)
	image.fill(Color8(51, 51, 51))
	image.set_pixel(4, 3, Color8(255, 255, 255))
	check_equal(image.save_png(PATH), OK, "the image is saved")
	var ground: Resource = ClassDB.instantiate(&"ScatterGroundHeightmap")
	ground.set(&"heightmap_path", PATH)
	ground.set(&"rect", Rect2(0, 0, 10, 6))
	ground.set(&"max_height", 500.0)
	EditorInterface.edit_resource(ground)
	await until(func() -> bool: return "5 × 4" in _summary_text(), "the inspector shows a summary")
	check_equal(_summary_text(), "5 × 4 heights, 8-bit PNG\n2.5 × 2.0 m apart\nLowest 100.0 m, highest 500.0 m", "the summary is complete")
	var texture := (_inspector_parts("TextureRect")[0] as TextureRect).texture
	check_equal(texture.get_image().get_size(), Vector2i(5, 4), "the thumbnail has one pixel per height")
	await picture("heightmap_summary")
	ground.set(&"max_height", 1000.0)
	await until(func() -> bool: return "highest 1000.0 m" in _summary_text(), "the summary shows the new range")
	EditorInterface.edit_resource(null)
	DirAccess.remove_absolute(PATH)
