extends SceneTree
## Renders an SVG file as a PNG of 256 by 256 pixels:
##   tools/godot --headless --script tools/package/store_icon.gd -- ICON.svg ICON.png

const SIZE := 256


func _initialize() -> void:
	var arguments := OS.get_cmdline_user_args()
	var image := Image.new()
	var text := FileAccess.get_file_as_string(arguments[0])
	var error := image.load_svg_from_string(text, 1.0)
	if error == OK:
		error = image.load_svg_from_string(text, SIZE / float(image.get_width()))
	if error == OK:
		error = image.save_png(arguments[1])
	if error != OK:
		printerr("store_icon: cannot convert %s to %s: %s" % [arguments[0], arguments[1], error_string(error)])
	quit(error)
