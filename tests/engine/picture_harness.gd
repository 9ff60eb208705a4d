extends "harness.gd"
## Base class for the tests that check screenshots. They need a renderer, so run them without --headless.


## Makes the window small. Returns a camera at (10, 40, 10) that looks straight down.
func look_down() -> Camera3D:
	root.size = Vector2i(160, 120)
	var camera := Camera3D.new()
	root.add_child(camera)
	camera.position = Vector3(10.0, 40.0, 10.0)
	camera.rotation_degrees.x = -90.0
	camera.make_current()
	return camera


## Returns the fraction (0 to 1) of pixels in the next frame for which `wanted`, a function of a Color, returns true.
func share_of_pixels(wanted: Callable) -> float:
	await frames(3)
	await RenderingServer.frame_post_draw
	var image := root.get_texture().get_image()
	var count := 0
	for x in image.get_width():
		for y in image.get_height():
			count += int(wanted.call(image.get_pixel(x, y)))
	return count / float(image.get_width() * image.get_height())
