@tool
extends "res://addons/thicket/editor/brush/brush_tool.gd"
## The biome brush, which paints and displays the scatter's biome map. Its button is visible while the scatter has biomes.

const BiomeBrush := preload("res://addons/thicket/editor/brush/biome_brush.gd")
const BiomeOverlay := preload("res://addons/thicket/editor/brush/biome_overlay.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

## The size of a biome's color swatch in the list, in pixels.
const SWATCH := 14

var brush := BiomeBrush.new()
## The overlay that shows the biomes on the ground.
var overlay := BiomeOverlay.new()

var _biomes := OptionButton.new()
var _rows: Array = []


func _init() -> void:
	needs_layer = false
	_setup("Biomes", &"Bucket", "Biomes: paint the biome map with the left mouse button.")
	button.visible = false
	_biomes.tooltip_text = "The biome to paint."
	_biomes.item_selected.connect(redraw_requested.emit.unbind(1))
	add_child(_biomes)
	_add_radius(brush.radius)
	_radius.value_changed.connect(func(value: float) -> void: brush.radius = value)


## Selects the biome with this index in the map, or land without a biome if it is -1.
func choose_biome(index: int) -> void:
	_biomes.select(_biomes.get_item_index(_id(index)))
	redraw_requested.emit()


func refresh() -> void:
	var map := _map()
	button.visible = map != null
	if map == null and is_on():
		set_on(false)
	_list(map)
	overlay.planet_radius = SurfacePlace.planet_radius(scatter) if is_instance_valid(scatter) else 0.0
	_show_painted(overlay, map)


func finish() -> void:
	brush.finish(undo_redo)


func _color() -> Color:
	var map := _map()
	var index := _index()
	return map.biomes[index].color if map != null and index >= 0 and map.biomes[index] != null else Color.WHITE


func _is_painting() -> bool:
	return brush.is_painting()


func _begin_stroke(point: Vector3, _click: InputEventMouseButton) -> String:
	if not _position_problem(point).is_empty():
		return _position_problem(point)
	return brush.begin(scatter, _index(), SceneFiles.edited_scene_path(), point)


func _move_stroke(point: Vector3) -> void:
	brush.move(point)


## Returns the map to paint, or null if there is no map with biomes.
func _map() -> ScatterBiomeMap:
	var map := scatter.biomes if is_instance_valid(scatter) else null
	return map if map != null and not map.biomes.is_empty() else null


## Returns the index of the selected biome, or -1 for land without a biome.
func _index() -> int:
	return _biomes.get_selected_id() - 1


static func _id(index: int) -> int:
	return index + 1


func _list(map: ScatterBiomeMap) -> void:
	var rows: Array = []
	if map != null:
		for index in map.biomes.size():
			if map.biomes[index] != null:
				rows.append([BiomeBrush.name_of(map, index), _id(index), map.biomes[index].color])
		rows.append([BiomeBrush.name_of(map, -1), _id(-1), Color.TRANSPARENT])
	if rows == _rows:
		return
	_rows = rows
	var selected_id := _biomes.get_selected_id()
	_biomes.clear()
	for row: Array in rows:
		var swatch := Image.create_empty(SWATCH, SWATCH, false, Image.FORMAT_RGBA8)
		swatch.fill(row[2])
		_biomes.add_icon_item(ImageTexture.create_from_image(swatch), row[0], row[1])
	_biomes.select(maxi(_biomes.get_item_index(selected_id), 0) if not rows.is_empty() else -1)
