extends CanvasLayer
## The text on the screen: the scatter's statistics and the keys.

const HELP := """W A S D, Q E   move        mouse   look (click to catch it, Esc to free it)
Shift   faster             F   walk or fly
N B   next, previous seed  + -   more, less of everything
T   tiles                  H   this help"""

## The help for keys that only this scene has, on one line.
@export var own_keys := ""

@onready var _figures: Label = $Panel/Rows/Figures
@onready var _help: Label = $Panel/Rows/Help
@onready var _panel: Control = $Panel


func _ready() -> void:
	_help.text = HELP if own_keys.is_empty() else "%s\n%s" % [HELP, own_keys]


## Shows the statistics of a frame, and [param state], a line about the demo's settings.
func show_figures(text: String, state: String) -> void:
	_figures.text = "%s\n%s" % [text, state]


## Shows or hides the list of keys.
func toggle_help() -> void:
	_help.visible = not _help.visible
	# A panel does not shrink automatically.
	_panel.reset_size.call_deferred()


## Hides the list of keys, for screenshots.
func hide_help() -> void:
	_help.visible = false
	_panel.reset_size.call_deferred()
