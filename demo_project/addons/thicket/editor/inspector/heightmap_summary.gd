@tool
extends HBoxContainer
## The top of a heightmap's inspector: a thumbnail of the heights, their number, spacing, range and format, or the
## reason why they cannot be read.

const REFRESH_SECONDS := 0.25
const PICTURE_SIDE := 96.0 ## In pixels at an editor scale of 1.

var _ground: ScatterGroundHeightmap
var _picture := TextureRect.new()
var _text := Label.new()
var _thumbnail_pixels := PackedByteArray() ## The pixels of the visible thumbnail.
var _since_refresh := 0.0


func _init(ground: ScatterGroundHeightmap = null) -> void:
	_ground = ground
	_picture.expand_mode = TextureRect.EXPAND_IGNORE_SIZE
	_picture.stretch_mode = TextureRect.STRETCH_KEEP_ASPECT_CENTERED
	_picture.custom_minimum_size = Vector2.ONE * PICTURE_SIDE * EditorInterface.get_editor_scale()
	_text.autowrap_mode = TextServer.AUTOWRAP_WORD_SMART
	_text.size_flags_horizontal = SIZE_EXPAND_FILL
	add_child(_picture)
	add_child(_text)
	refresh()


## Workers read files over several frames, so the summary is requested repeatedly.
func _process(delta: float) -> void:
	_since_refresh += delta
	if _since_refresh >= REFRESH_SECONDS and is_visible_in_tree():
		_since_refresh = 0.0
		refresh()


func refresh() -> void:
	if _ground == null:
		return
	var summary := _ground.get_summary()
	_text.text = text_of(summary)
	var thumbnail: Image = summary.get("thumbnail")
	var pixels := thumbnail.get_data() if thumbnail != null else PackedByteArray()
	_picture.visible = thumbnail != null
	if pixels != _thumbnail_pixels:
		_thumbnail_pixels = pixels
		_picture.texture = ImageTexture.create_from_image(thumbnail) if thumbnail != null else null


## Returns the lines for a summary.
static func text_of(summary: Dictionary) -> String:
	var lines := PackedStringArray()
	if summary.has("size"):
		var size: Vector2i = summary["size"]
		var spacing: Vector2 = summary["spacing"]
		lines.append("%d × %d heights, %s" % [size.x, size.y, summary["format"]])
		lines.append("%s × %s m apart" % [rounded(spacing.x), rounded(spacing.y)])
		lines.append("Lowest %s m, highest %s m" % [rounded(summary["lowest"]), rounded(summary["highest"])])
	if summary["problem"]:
		lines.append(summary["problem"])
	elif lines.is_empty():
		lines.append("Reading the heights...")
	return "\n".join(lines)


## Returns a number with at most three decimals.
static func rounded(meters: float) -> String:
	return str(snappedf(meters, 0.001))
