extends "harness.gd"
## Tests ScatterMask: painting, saved data, undo, rejected input, and the signals that layers emit.

const SPOT := "user://thicket_mask"


## Records the change signals of a mask or a layer.
class SignalLog:
	var areas: Array[Rect2] = []
	var changes := 0

	func _init(object: Resource) -> void:
		object.connect("area_changed", func(rect: Rect2) -> void: areas.push_back(rect))
		object.changed.connect(func() -> void: changes += 1)


func blank(background := 0.0, pixel_size := 1.0) -> ScatterMask:
	var mask := ScatterMask.new()
	mask.background = background
	mask.pixel_size = pixel_size
	return mask


## Returns the densities on a grid that extends `reach` meters from a position on each axis.
func samples(mask: ScatterMask, center: Vector2, reach: float) -> PackedFloat32Array:
	var result := PackedFloat32Array()
	for row in 21:
		for column in 21:
			result.push_back(mask.sample(center + reach * Vector2(column - 10, row - 10) / 10.0))
	return result


## Checks that setting a value causes one error that names the property and has no effect.
func refuse(mask: ScatterMask, property: StringName, value: Variant, words: Array) -> void:
	var signals := SignalLog.new(mask)
	var before: Variant = mask.get(property)
	mask.set(property, value)
	check_error(["ScatterMask.%s" % property] + words, "an invalid %s" % property)
	check(mask.get(property) == before, "%s stays" % property)
	check_equal(signals.changes, 0, "no signal")


func test_new_masks() -> void:
	var mask := ScatterMask.new()
	check_equal(mask.pixel_size, 1.0, "pixel_size")
	check_equal(mask.background, 1.0, "background")
	check_equal(mask.data, PackedByteArray(), "a blank mask stores no data")
	for at: Vector2 in [Vector2.ZERO, Vector2(-1e6, 3e5)]:
		check_equal(mask.sample(at), 1.0, "density")
	mask.background = 0.5
	check_equal(mask.background, 0.5, "the value reads back exactly")
	check(absf(mask.sample(Vector2(7, 7)) - 0.5) <= 0.501 / 255.0, "a background between two of the 255 steps is rounded")
	check_equal(mask.sample(Vector2(NAN, 0)), 0.0, "density at an invalid position")


func test_paint() -> void:
	for pixel_size: float in [0.25, 1.0, 3.0]:
		for center: Vector2 in [Vector2(0, 0), Vector2(-1000.3, 64.0), Vector2(123456.5, -98765.25)]:
			var mask := blank(0.0, pixel_size)
			var signals := SignalLog.new(mask)
			var rect := mask.paint(center, 12.0, 1.0, 0.75)
			check_equal(signals.areas, [rect] as Array[Rect2], "one signal with the returned rectangle")
			check_equal(signals.changes, 0, "a dab does not emit changed")
			check_equal(mask.sample(center), 1.0, "density in the middle of the dab")
			check_equal(mask.sample(center + Vector2(9.0 - 1.5 * pixel_size, 0)), 1.0, "density within the dab's hardness")
			check_equal(mask.sample(center + Vector2(12.1 + pixel_size, 0)), 0.0, "density beyond the dab's rim")
			for away: Vector2 in [Vector2(-0.01, 0), Vector2(0, -0.01)]:
				check_equal(mask.sample(rect.position + away * pixel_size), 0.0, "density outside the returned rectangle")
			check(Rect2(center - Vector2(12, 12), Vector2(24, 24)).grow(2.0 * pixel_size).encloses(rect), "%s fits the dab to within two pixels" % rect)


func test_modes() -> void:
	var mask := blank(0.0)
	mask.paint(Vector2.ZERO, 20.0)
	mask.paint(Vector2.ZERO, 5.0, 1.0, 1.0, ScatterMask.MODE_ERASE)
	check_equal(mask.sample(Vector2.ZERO), 0.0, "density in the erased middle")
	check_equal(mask.sample(Vector2(8, 0)), 1.0, "density around the erased middle")
	var sharp := absf(mask.sample(Vector2(3, 0)) - mask.sample(Vector2(7, 0)))
	for stroke in 5:
		mask.paint(Vector2(5, 0), 8.0, 1.0, 1.0, ScatterMask.MODE_SMOOTH)
	check(absf(mask.sample(Vector2(3, 0)) - mask.sample(Vector2(7, 0))) < sharp, "smoothing reduces the step at the border")
	var weak := blank(0.0)
	weak.paint(Vector2.ZERO, 10.0, 0.25)
	check(absf(weak.sample(Vector2.ZERO) - 0.25) < 0.01, "a strength of a quarter paints a quarter: %s" % weak.sample(Vector2.ZERO))
	var signals := SignalLog.new(mask)
	check_equal(blank(0.0).paint(Vector2.ZERO, 5.0, 1.0, 0.5, ScatterMask.MODE_ERASE), Rect2(), "the changed rectangle if there is nothing to erase")
	check_equal(signals.areas.size(), 0, "no signal")


func test_rejected_dabs() -> void:
	var mask := blank(0.0)
	mask.paint(Vector2(3, 3), 4.0)
	var data := mask.data
	var signals := SignalLog.new(mask)
	for dab: Array in [[Vector2(NAN, 0), 5.0], [Vector2(0, INF), 5.0], [Vector2.ZERO, 0.0], [Vector2.ZERO, -1.0],
			[Vector2.ZERO, NAN], [Vector2.ZERO, 2000.0], [Vector2.ZERO, 5.0, 1.5], [Vector2.ZERO, 5.0, -0.1],
			[Vector2.ZERO, 5.0, 1.0, 2.0], [Vector2.ZERO, 5.0, 1.0, NAN], [Vector2.ZERO, 5.0, 1.0, 0.5, 3],
			[Vector2.ZERO, 5.0, 1.0, 0.5, -1], [Vector2(1e12, 0), 5.0]]:
		check_equal(mask.paint.callv(dab), Rect2(), "%s" % [dab])
		check_error(["ScatterMask."], "paint%s" % [dab])
	check_equal(mask.data, data, "the mask before")
	check_equal(signals.areas.size() + signals.changes, 0, "no signal")


func test_undo_and_redo() -> void:
	var mask := blank(1.0, 0.5)
	mask.paint(Vector2(40, -20), 15.0, 0.8, 0.2, ScatterMask.MODE_ERASE)
	var before := samples(mask, Vector2(50, -25), 40.0)
	var pixels := mask.get_pixel_rect(Rect2(45, -35, 20, 20))
	var saved_pixels := mask.get_pixels(pixels)
	check_equal(saved_pixels.size(), pixels.size.x * pixels.size.y, "one byte per pixel")
	mask.paint(Vector2(55, -25), 10.0, 1.0, 0.5, ScatterMask.MODE_ERASE)
	var after := samples(mask, Vector2(50, -25), 40.0)
	var painted := mask.get_pixels(pixels)
	check(before != after, "painted")
	var signals := SignalLog.new(mask)
	check_equal(signals.areas, [] as Array[Rect2], "area_changed signals before the undo")
	var rect := mask.set_pixels(pixels, saved_pixels)
	check_equal(signals.areas, [rect] as Array[Rect2], "undo reports its area")
	check(Rect2(45, -35, 20, 20).grow(1.0).encloses(rect), "%s contains the dab" % rect)
	check_equal(samples(mask, Vector2(50, -25), 40.0), before, "undone")
	mask.set_pixels(pixels, painted)
	check_equal(samples(mask, Vector2(50, -25), 40.0), after, "redone")
	check_equal(mask.set_pixels(pixels, painted), Rect2(), "the changed rectangle if the pixels are equal already")
	check_equal(signals.areas.size(), 2, "no signal")


func test_rejected_pixels() -> void:
	var mask := blank(0.0)
	mask.paint(Vector2.ZERO, 10.0)
	var data := mask.data
	check_equal(mask.get_pixels(Rect2i(0, 0, 0, 5)), PackedByteArray(), "no pixels")
	check_no_error("an empty rectangle")
	for rect: Rect2i in [Rect2i(0, 0, -1, 5), Rect2i(0, 0, 1 << 13, 1 << 13), Rect2i((1 << 31) - 3, 0, 9, 9)]:
		check_equal(mask.get_pixels(rect), PackedByteArray(), "pixels of %s" % rect)
		check_error(["ScatterMask.rect"], "pixels of %s" % rect)
		check_equal(mask.set_pixels(rect, PackedByteArray([1, 2])), Rect2(), "setting pixels of %s" % rect)
		check_error(["ScatterMask.rect"], "setting pixels of %s" % rect)
	check_equal(mask.set_pixels(Rect2i(0, 0, 2, 2), PackedByteArray([1, 2, 3])), Rect2(), "too few pixels")
	check_error(["ScatterMask.", "wrong size"], "three pixels for four")
	for rect: Rect2 in [Rect2(), Rect2(0, 0, -5, 5), Rect2(NAN, 0, 5, 5)]:
		check_equal(mask.get_pixel_rect(rect).size, Vector2i.ZERO, "pixels of %s" % rect)
	check_no_error("invalid rectangles contain no pixels")
	check_equal(mask.data, data, "the mask before")


func test_pixel_size_and_background() -> void:
	var mask := blank(0.0)
	for value: float in [NAN, INF, -INF]:
		refuse(mask, "pixel_size", value, ["finite"])
		refuse(mask, "background", value, ["finite"])
	for value: float in [0.0, -1.0]:
		refuse(mask, "pixel_size", value, ["must be between 0.0"])
	for value: float in [0.01, 2000.0]:
		refuse(mask, "pixel_size", value, ["range"])
	for value: float in [-0.1, 1.1]:
		refuse(mask, "background", value, ["range"])
	var signals := SignalLog.new(mask)
	mask.pixel_size = 2.0
	mask.background = 1.0
	check_equal(signals.changes, 2, "changed signals, one for each change")
	mask.background = 1.0
	check_equal(signals.changes, 2, "changed signals after setting the same values")
	mask.paint(Vector2.ZERO, 10.0, 1.0, 0.5, ScatterMask.MODE_ERASE)
	refuse(mask, "pixel_size", 4.0, ["painted", "clear"])
	refuse(mask, "background", 0.5, ["painted", "clear"])
	mask.pixel_size = 2.0
	mask.background = 1.0
	check_no_error("the same values again")
	mask.clear()
	check_equal(signals.changes, 3, "cleared")
	check_equal(mask.sample(Vector2.ZERO), 1.0, "density after clear")
	mask.pixel_size = 4.0
	check_equal(mask.pixel_size, 4.0, "pixel_size after clear can be changed again")
	mask.clear()
	check_equal(signals.changes, 4, "changed signals after clearing an empty mask")


func test_stored_bytes() -> void:
	var mask := blank(0.5, 0.5)
	mask.paint(Vector2(-300.5, 77.0), 30.0)
	mask.paint(Vector2(900.0, -5000.0), 8.0, 0.6, 0.0, ScatterMask.MODE_ERASE)
	var seen := samples(mask, Vector2(-300, 77), 40.0)
	var other := ScatterMask.new()
	var signals := SignalLog.new(other)
	other.data = mask.data
	check_equal(signals.changes, 1, "changed signals")
	check_equal(other.data, mask.data, "the copy's data")
	check_equal([other.pixel_size, other.get_pixels(Rect2i(0, 0, 1, 1))], [0.5, mask.get_pixels(Rect2i(0, 0, 1, 1))], "pixel size and background are included")
	check_equal(samples(other, Vector2(-300, 77), 40.0), seen, "the copy's densities")
	var good := mask.data
	for broken: PackedByteArray in [good.slice(0, good.size() / 2), good.slice(1), "nonsense".to_utf8_buffer(), PackedByteArray([0])]:
		refuse(other, "data", broken, [])
	for at: int in [0, 5, good.size() / 2, good.size() - 1]:
		var flipped := good.duplicate()
		flipped[at] ^= 0x10
		refuse(other, "data", flipped, [])
	check_equal(samples(other, Vector2(-300, 77), 40.0), seen, "densities after invalid data")
	other.data = PackedByteArray()
	check_no_error("no bytes")
	check_equal([other.data, other.pixel_size], [PackedByteArray(), 0.5], "nothing is painted, the pixel size stays")


func test_files() -> void:
	var mask := blank(0.5, 2.0)
	mask.paint(Vector2(50, 60), 25.0)
	var seen := samples(mask, Vector2(50, 60), 40.0)
	for ending: String in [".tres", ".res"]:
		check_equal(ResourceSaver.save(mask, SPOT + ending), OK, "saved")
		var loaded: ScatterMask = ResourceLoader.load(SPOT + ending, "", ResourceLoader.CACHE_MODE_IGNORE)
		check_equal([loaded.pixel_size, loaded.background], [2.0, 0.5], "properties from " + ending)
		check_equal(samples(loaded, Vector2(50, 60), 40.0), seen, "densities from " + ending)
		check(FileAccess.get_size(SPOT + ending) < 8192, "%s of %d bytes" % [ending, FileAccess.get_size(SPOT + ending)])
		# Load into the existing object, as the editor does when a file has changed.
		loaded.clear()
		loaded.pixel_size = 1.0
		loaded.paint(Vector2(-9, 9), 3.0)
		ResourceSaver.save(mask, SPOT + ending)
		var again: ScatterMask = ResourceLoader.load(SPOT + ending, "", ResourceLoader.CACHE_MODE_REPLACE)
		check_equal(samples(again, Vector2(50, 60), 40.0), seen, "densities after reloading")
		DirAccess.remove_absolute(SPOT + ending)
	var copy: ScatterMask = mask.duplicate()
	check_equal(samples(copy, Vector2(50, 60), 40.0), seen, "densities of a copy")
	copy.paint(Vector2(50, 60), 25.0, 1.0, 1.0, ScatterMask.MODE_ERASE)
	check_equal(samples(mask, Vector2(50, 60), 40.0), seen, "densities of the original after painting the copy")
	check(samples(copy, Vector2(50, 60), 40.0) != seen, "painting changes the copy")


func test_layers_forward_the_signals_of_masks() -> void:
	var mask := blank(0.0)
	var layers: Array[ScatterLayer] = [make_layer(), make_layer()]
	var signals: Array[SignalLog] = []
	for layer in layers:
		layer.mask = mask
		signals.push_back(SignalLog.new(layer))
	var rect := mask.paint(Vector2(10, 10), 5.0)
	mask.clear()
	for index in 2:
		check_equal(signals[index].areas, [rect] as Array[Rect2], "the area of the dab")
		check_equal(signals[index].changes, 1, "clear emits changed")
	layers[0].mask = null
	mask.paint(Vector2(10, 10), 5.0)
	check_equal([signals[0].areas.size(), signals[1].areas.size()], [1, 2], "the first layer is disconnected")
	check_equal(signals[0].changes, 2, "clearing a layer's mask emits changed")
	layers[1].mask = mask
	check_equal(signals[1].changes, 1, "setting the same mask again emits nothing")
