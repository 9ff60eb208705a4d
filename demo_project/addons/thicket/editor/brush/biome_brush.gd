@tool
extends RefCounted
## Paints biomes into the image of a biome map. A stroke consists of overlapping discs and is one undo step.

const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")
const StrokePlaces := preload("res://addons/thicket/editor/brush/stroke_places.gd")
const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

## The length of the longer side of a new image, in pixels, and the maximum width and height of any image.
const SIDE := 1024
const LARGEST := 8192
## The minimum number of pixels that a brush radius must span. An image with fewer pixels is enlarged.
const FINENESS := 4.0
## The minimum time between two updates of the map during a stroke, in milliseconds. After a slow update, the pause is longer, so that updates take at
## most a quarter of the time.
const PAUSE_MSEC := 60
## The minimum radius of a disc in pixels, so that every disc has at least one pixel.
const MIN_PIXEL_RADIUS := 0.75
## The value of the red channel for land without a biome.
const NO_INDEX := 255

## The radius of the brush in meters, above 0.
var radius := 16.0
## The manager of the files in which the painted images are stored.
var files: SceneFiles

var _map: ScatterBiomeMap
var _image: Image
var _old_image: Resource ## The map's image before the stroke.
var _old_pixels: Image
var _changed_rect := Rect2i() ## The pixels that may have changed.
var _color := Color.BLACK
var _title := ""
var _scatter: TerrainScatter3D
var _scene_path := ""
var _last_position := Vector3.ZERO
var _planet_radius := 0.0 ## The radius of the planet that the map covers; 0 if it is projected along the y axis.
var _next_read_msec := 0
var _is_outdated := false ## True if the map has not read the last discs yet.


## Returns true between [method begin] and [method finish].
func is_painting() -> bool:
	return _map != null


## Starts a stroke with a disc at a position on the ground. [param index] is the index of the biome, or -1 for land without a
## biome. Returns an empty string on success, or the reason for a failure.
func begin(scatter: TerrainScatter3D, index: int, scene_path: String, position: Vector3) -> String:
	finish(null)
	var map := scatter.biomes
	var color_problem := _same_color(map, index)
	if not color_problem.is_empty():
		return color_problem
	_planet_radius = SurfacePlace.planet_radius(scatter)
	if _planet_radius == 0.0 and not map.map_rect.has_point(Vector2(position.x, position.z)):
		return "The map ends here: it covers %s. Enlarge the map_rect of the biome map." % map.map_rect
	_old_image = map.map_image
	_image = _paintable(map, index)
	if _image != _old_image and not files.create(scene_path, _image, "biomes", "map"):
		return files.problem
	_map = map
	_scatter = scatter
	_scene_path = scene_path
	_color = _pixel(map, index)
	_title = "Paint Biome %s" % name_of(map, index)
	_old_pixels = _image.duplicate()
	_changed_rect = Rect2i()
	_paint_disc(_map_position(position))
	_update_map()
	return ""


## Continues the stroke to a position on the ground, and adds discs along the way.
func move(position: Vector3) -> void:
	if not is_painting():
		return
	for point in StrokePlaces.between(_last_position, _map_position(position), radius):
		_paint_disc(point)
	if _is_outdated and Time.get_ticks_msec() >= _next_read_msec:
		_update_map()


## Ends the stroke and adds an undo step, unless nothing has changed.
func finish(undo_redo: EditorUndoRedoManager) -> void:
	if not is_painting():
		return
	if _is_outdated:
		_update_map()
	var map := _map
	_map = null
	_mark(map, _image)
	var old := _old_pixels.get_region(_changed_rect)
	var new := _image.get_region(_changed_rect)
	if undo_redo != null and is_instance_valid(_scatter) and (_image != _old_image or old.get_data() != new.get_data()):
		undo_redo.create_action(_title, UndoRedo.MERGE_DISABLE, _scatter)
		undo_redo.add_do_method(self, &"restore", map, _image, new, _changed_rect.position)
		undo_redo.add_undo_method(self, &"restore", map, _image, old, _changed_rect.position)
		if _image != _old_image:
			undo_redo.add_undo_property(map, &"map_image", _old_image)
			files.add_to_undo([_image], _scene_path, undo_redo)
		undo_redo.commit_action(false)
	_old_pixels = null
	_old_image = null
	_scatter = null


## Restores pixels of the image, and the image of the map. For undo and redo.
func restore(map: ScatterBiomeMap, image: Image, pixels: Image, offset: Vector2i) -> void:
	image.blit_rect(pixels, Rect2i(Vector2i.ZERO, pixels.get_size()), offset)
	map.map_image = image
	_mark(map, image)


## Returns the name of a biome, or of land without a biome if [param index] is -1.
static func name_of(map: ScatterBiomeMap, index: int) -> String:
	if index < 0 or map.biomes[index] == null:
		return "No Biome"
	return map.biomes[index].resource_name if map.biomes[index].resource_name else "Biome %d" % index


## Returns an error message if an earlier biome has the same color as this one. Otherwise, and for a map of indices, returns an empty string.
static func _same_color(map: ScatterBiomeMap, index: int) -> String:
	if index < 0 or map.map_mode == ScatterBiomeMap.MAP_MODE_INDICES:
		return ""
	for other in index:
		if map.biomes[other] != null and map.biomes[other].color.to_rgba32() >> 8 == map.biomes[index].color.to_rgba32() >> 8:
			return "%s and %s have the same color: change the color of one of these biomes." % [name_of(map, other), name_of(map, index)]
	return ""


static func _pixel(map: ScatterBiomeMap, index: int) -> Color:
	if map.map_mode == ScatterBiomeMap.MAP_MODE_INDICES:
		return Color8(index if index >= 0 else NO_INDEX, 0, 0)
	return Color(map.biomes[index].color, 1.0) if index >= 0 else Color.TRANSPARENT


## Returns the image of the map if it can be painted. Otherwise, returns a copy, for example of an imported image, or a new image.
func _paintable(map: ScatterBiomeMap, index: int) -> Image:
	var image := map.map_image as Image
	if image == null and map.map_image is Texture2D:
		image = (map.map_image as Texture2D).get_image()
	if image == null or image.is_empty():
		var size := _map_size(map) * (SIDE / maxf(_map_size(map).x, _map_size(map).y))
		image = Image.create_empty(maxi(roundi(size.x), 1), maxi(roundi(size.y), 1), false, _formats(map, index)[0] as Image.Format)
		image.fill(_pixel(map, 0))
	var own_file := image.resource_path.is_empty() or "::" in image.resource_path or image.resource_path.get_extension() in ["res", "tres"]
	var pixel := _map_size(map) / Vector2(image.get_size())
	var factor := mini(ceili(maxf(pixel.x, pixel.y) * FINENESS / radius), floori(LARGEST / float(maxi(image.get_width(), image.get_height()))))
	if image == map.map_image and own_file and factor <= 1 and image.get_format() in _formats(map, index) and not image.has_mipmaps():
		return image
	var copy: Image = image.duplicate()
	copy.decompress()
	copy.clear_mipmaps()
	copy.convert(_formats(map, index)[0] as Image.Format)
	if factor > 1:
		copy.resize(copy.get_width() * factor, copy.get_height() * factor, Image.INTERPOLATE_NEAREST)
	return copy


## Returns the formats in which an image can be painted, the preferred one first. Land without a biome needs alpha.
static func _formats(map: ScatterBiomeMap, index: int) -> PackedInt32Array:
	if map.map_mode == ScatterBiomeMap.MAP_MODE_INDICES:
		return [Image.FORMAT_R8, Image.FORMAT_RGB8, Image.FORMAT_RGBA8]
	return [Image.FORMAT_RGBA8] if index < 0 else [Image.FORMAT_RGBA8, Image.FORMAT_RGB8]


## Marks the image and the map as changed. The map may have its own file, which refers to the image.
func _mark(map: ScatterBiomeMap, image: Image) -> void:
	files.mark(image)
	files.mark(map)


## Returns the size in meters of the area that the image covers: the map's rectangle or, on a planet, its equator and a meridian.
func _map_size(map: ScatterBiomeMap) -> Vector2:
	return Vector2(TAU, PI) * _planet_radius if _planet_radius > 0.0 else map.map_rect.size


## Returns the map's coordinates of a position: world x and z or, on a planet, the position relative to its center.
func _map_position(position: Vector3) -> Vector3:
	return _scatter._to_planet(PackedVector3Array([position]))[0] if _planet_radius > 0.0 else Vector3(position.x, 0.0, position.z)


func _fill(row: Rect2i) -> void:
	_image.fill_rect(row, _color)
	_changed_rect = row.merge(_changed_rect) if _changed_rect.has_area() else row


func _paint_disc(center: Vector3) -> void:
	_last_position = center
	_is_outdated = true
	if _planet_radius > 0.0:
		var runs := _map._planet_disc(_planet_radius, center, radius, _image.get_size())
		for index in range(0, runs.size(), 3):
			_fill(Rect2i(runs[index], runs[index + 1], runs[index + 2], 1))
		return
	var center_xz := Vector2(center.x, center.z)
	var per_meter := Vector2(_image.get_size()) / _map.map_rect.size
	var center_pixel := (center_xz - _map.map_rect.position) * per_meter
	var radii := (per_meter * radius).max(Vector2.ONE * MIN_PIXEL_RADIUS)
	var image_rect := Rect2i(Vector2i.ZERO, _image.get_size())
	for y in range(maxi(floori(center_pixel.y - radii.y), 0), mini(ceili(center_pixel.y + radii.y), image_rect.size.y)):
		var squared_fraction := 1.0 - ((y + 0.5 - center_pixel.y) / radii.y) ** 2
		if squared_fraction > 0.0:
			var half_width := radii.x * sqrt(squared_fraction)
			var first := roundi(center_pixel.x - half_width)
			var row := Rect2i(first, y, maxi(roundi(center_pixel.x + half_width) - first, 1), 1).intersection(image_rect)
			if row.has_area():
				_fill(row)


## Sets the image on the map, which then reads it.
func _update_map() -> void:
	var start_msec := Time.get_ticks_msec()
	_map.map_image = _image
	_is_outdated = false
	_next_read_msec = Time.get_ticks_msec() + maxi(PAUSE_MSEC, 3 * (Time.get_ticks_msec() - start_msec))
