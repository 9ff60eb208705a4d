@tool
extends "res://tests/newcomer_steps.gd"
## Films the steps of README.md and a stroke of the brush, for tools/film.sh. The second argument is the folder for the frames. A number in a frame's
## name repeats the frame that often.

## The number of frames in which the pointer moves from one control to the next.
const GLIDE := 5
const POINTER_HEIGHT := 22

var filming := false

var _frames := 0
var _pointer: Image
var _at := Vector2(0.55, 0.4) * Vector2(SIZE)


func test_film() -> void:
	_pointer = make_pointer()
	await enable_the_plugin()
	await open_a_scene()
	filming = true
	await hold(6)
	await create_a_forest()
	await click(bottom_tab("Scatter")) # Closes the panel, for a larger view.
	await hold(4)
	await orbit(Vector2(-60.0, 120.0), 12)
	await click(spot(button("Brush")))
	await click(spot(button("Erase")))
	workspace().toolbar.paint.set_brush(7.0, 1.0, 1.0)
	await glide(spot(surface(), Vector2(0.12, 0.55)))
	await mouse_drag(spot(surface(), Vector2(0.12, 0.55)), spot(surface(), Vector2(0.5, 0.75)))
	await mouse_drag(spot(surface(), Vector2(0.5, 0.75)), spot(surface(), Vector2(0.85, 0.45)))
	await settle(scatter)
	await hold(14)
	check(_frames > 60, "%d different frames" % _frames)


func step_done(title: String) -> void:
	if filming:
		await hold({"2": 6, "3": 3, "4": 12, "5": 8}[title])


func mouse_click(at: Vector2, index := MOUSE_BUTTON_LEFT, keys := 0) -> void:
	if filming:
		await glide(at)
	await super(at, index, keys)
	if filming:
		await hold(2)


func drag_files(paths: PackedStringArray, to: Vector2) -> void:
	if filming:
		await glide(drag_origin(paths))
	await super(paths, to)


## Returns the position of a file's row in the FileSystem dock.
func drag_origin(paths: PackedStringArray) -> Vector2:
	for tree: Tree in EditorInterface.get_file_system_dock().find_children("*", "Tree", true, false):
		var item := tree.get_root()
		while item != null:
			if item.get_text(0) == paths[0].get_file():
				var rect := tree.get_item_area_rect(item, 0)
				return tree.get_global_transform_with_canvas() * (rect.position + rect.size * Vector2(0.4, 0.5))
			item = item.get_next_in_tree()
	return super(paths)


func mouse_to(at: Vector2, buttons: int) -> void:
	await super(at, buttons)
	_at = at
	if filming and buttons != 0:
		await hold(1)


## Moves the pointer to a position, one frame at a time.
func glide(to: Vector2) -> void:
	var from := _at
	for step in GLIDE:
		await mouse_to(from.lerp(to, smoothstep(0.0, 1.0, (step + 1.0) / GLIDE)), 0)
		await hold(1)


## Rotates the view with the middle mouse button, by a distance in pixels.
func orbit(by: Vector2, steps: int) -> void:
	var from := spot(surface())
	await glide(from)
	await press_middle(from, true)
	for step in steps:
		await mouse_to(from + by * (smoothstep(0.0, 1.0, (step + 1.0) / steps)), MOUSE_BUTTON_MASK_MIDDLE)
	await press_middle(from + by, false)


func press_middle(at: Vector2, pressed: bool) -> void:
	var event := InputEventMouseButton.new()
	event.position = at
	event.global_position = at
	event.button_index = MOUSE_BUTTON_MIDDLE
	event.pressed = pressed
	event.button_mask = MOUSE_BUTTON_MASK_MIDDLE if pressed else 0
	get_window().push_input(event)
	await get_tree().process_frame


## Saves the window with the pointer as a frame that is repeated `count` times.
func hold(count: int) -> void:
	hide_test_files()
	await frames(2)
	for pass_index in 2:
		RenderingServer.force_draw()
		await get_tree().process_frame
	var image := get_window().get_texture().get_image()
	image.convert(Image.FORMAT_RGBA8)
	image.blend_rect(_pointer, Rect2i(Vector2i.ZERO, _pointer.get_size()), Vector2i(_at))
	image.save_png(OS.get_cmdline_user_args()[1].path_join("%04d-%d.png" % [_frames, count]))
	_frames += 1


## Draws a pointer: a white arrow with a dark edge.
func make_pointer() -> Image:
	var image := Image.create_empty(POINTER_HEIGHT, POINTER_HEIGHT, false, Image.FORMAT_RGBA8)
	for y in POINTER_HEIGHT:
		var width := int(0.72 * y) if y < 0.7 * POINTER_HEIGHT else int(0.72 * (POINTER_HEIGHT - y) * 2.0)
		for x in width + 1:
			image.set_pixel(x, y, Color.BLACK if x == 0 or x >= width - 1 or y > POINTER_HEIGHT - 3 else Color.WHITE)
	return image
