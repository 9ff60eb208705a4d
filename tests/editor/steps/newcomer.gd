@tool
extends "res://tests/newcomer_steps.gd"
## Follows README.md, takes the picture of each step, and prints the numbers of clicks, drags and key presses.


func step_done(title: String) -> void:
	hide_test_files()
	await picture("newcomer_" + title)


func test_enable_the_plugin() -> void:
	await enable_the_plugin()


func test_open_a_scene() -> void:
	await open_a_scene()


func test_create_a_forest() -> void:
	await create_a_forest()
	check(scatter.get_shown_count(scatter.layers[0]) > 100, "%d trees" % scatter.get_shown_count(scatter.layers[0]))
	check(scatter.get_problems().is_empty(), "no problems: %s" % scatter.get_problems())


func test_play() -> void:
	await play()
	print("newcomer: %d clicks, %d drags, %d keys" % [clicks, drags, key_presses])
