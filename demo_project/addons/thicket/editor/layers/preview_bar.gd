@tool
extends PanelContainer
## The bar below the 3D view. It asks for confirmation before many more instances are shown, and shows a note while the
## view shows fewer instances than the game.

const NumberText := preload("res://addons/thicket/number_text.gd")
const Steps := preload("res://addons/thicket/editor/layers/preview_steps.gd")

var steps: Steps

var _watch: Steps.Watch
var _message := Label.new()
var _icon := TextureRect.new()
var _show := Button.new()
var _keep := Button.new()


func _init(preview_steps: Steps) -> void:
	steps = preview_steps
	steps.limits_changed.connect(update)
	var row := HBoxContainer.new()
	add_child(row)
	_icon.stretch_mode = TextureRect.STRETCH_KEEP_CENTERED
	row.add_child(_icon)
	_message.size_flags_horizontal = SIZE_EXPAND_FILL
	_message.text_overrun_behavior = TextServer.OVERRUN_TRIM_ELLIPSIS
	_message.mouse_filter = Control.MOUSE_FILTER_PASS
	row.add_child(_message)
	_show.tooltip_text = "Show more instances in steps until all are visible. Press Stop to interrupt."
	_show.pressed.connect(_on_show)
	row.add_child(_show)
	_keep.tooltip_text = "Only the view is limited: the layer has its new values, and the game shows all instances."
	_keep.pressed.connect(_on_keep)
	row.add_child(_keep)
	hide()


## Updates the text and the buttons.
func update() -> void:
	var limited := steps.limited()
	_watch = limited[0] if not limited.is_empty() else null
	visible = _watch != null
	if _watch == null:
		return
	var title := _watch.layer.resource_name if _watch.layer.resource_name else "The layer"
	var shown_text := rounded(_watch.count)
	var total_text := rounded(_watch.estimate())
	match _watch.state:
		Steps.State.ASKING:
			_message.text = "%s would show about %s instances instead of %s." % [title, total_text, shown_text]
		Steps.State.KEPT:
			_message.text = "The view shows %s of about %s instances of %s; the game shows all." % [shown_text, total_text, title]
		Steps.State.GROWING:
			_message.text = "%s: %s of about %s instances visible." % [title, shown_text, total_text]
	_message.tooltip_text = _message.text
	_show.text = "Show Them" if _watch.state == Steps.State.ASKING else "Show All"
	_show.visible = _watch.state != Steps.State.GROWING
	_keep.text = "Stop" if _watch.state == Steps.State.GROWING else "Keep %s" % shown_text
	_keep.visible = _watch.state != Steps.State.KEPT


## Returns a number as text, rounded to two significant digits, with thousands separators.
static func rounded(number: float) -> String:
	var digits := maxi(0, floori(log(maxf(number, 1.0)) / log(10.0)) - 1)
	return NumberText.grouped(roundi(snappedf(number, pow(10.0, digits))))


func _notification(what: int) -> void:
	if what == NOTIFICATION_THEME_CHANGED and has_theme_icon(&"StatusWarning", &"EditorIcons"):
		_icon.texture = get_theme_icon(&"StatusWarning", &"EditorIcons")


func _on_show() -> void:
	if _watch != null:
		steps.grow(_watch)


func _on_keep() -> void:
	if _watch != null:
		steps.keep(_watch)
