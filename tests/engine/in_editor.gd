@tool
extends Node
## A node in a scene that the editor opens. Prints the number of visible tiles and instances, reloads the extension, and prints the numbers
## again.

func _ready() -> void:
	if not Engine.is_editor_hint():
		return
	var scatter := get_node("../Scatter")
	await shown(scatter)
	print("in the editor: %d tiles, %d instances" % [scatter.get_stats()["tiles"], scatter.get_stats()["instances"]])
	var children := scatter.get_child_count(true)
	print("children of the scatter: %d" % children)
	var status := GDExtensionManager.reload_extension("res://addons/thicket/thicket.gdextension")
	print("reload: %d" % status)
	await shown(scatter)
	print("after reloading: %d tiles, %d instances" % [scatter.get_stats()["tiles"], scatter.get_stats()["instances"]])
	get_tree().quit()


func shown(scatter: Node) -> void:
	var deadline := Time.get_ticks_msec() + 30000
	while Time.get_ticks_msec() < deadline and not (scatter.is_settled() and scatter.get_stats()["tiles"] > 0):
		await get_tree().process_frame
