@tool
extends Node
## A node in a scene that the editor opens. Prints the number of visible tiles and instances, limits the preview, summarizes a heightmap,
## reloads the extension, and prints the numbers of visible tiles and instances again.

func _ready() -> void:
	if not Engine.is_editor_hint():
		return
	var scatter := get_node("../Scatter")
	await shown(scatter)
	print("in the editor: %d tiles, %d instances" % [scatter.get_stats()["tiles"], scatter.get_stats()["instances"]])
	var children := scatter.get_child_count(true)
	print("children of the scatter: %d" % children)
	var limit: int = scatter.preview_instances
	scatter.preview_instances = 1000
	await shown(scatter)
	var maximum := 0
	for frame in 30:
		await get_tree().process_frame
		maximum = maxi(maximum, scatter.get_draw_stats(null)["instances"])
	print("most of a limited preview: %d instances" % maximum)
	print("limited preview: %d instances" % scatter.get_draw_stats(null)["instances"])
	scatter.preview_instances = limit
	await print_summary(scatter)
	var status := GDExtensionManager.reload_extension("res://addons/thicket/thicket.gdextension")
	print("reload: %d" % status)
	await shown(scatter)
	print("after reloading: %d tiles, %d instances" % [scatter.get_stats()["tiles"], scatter.get_stats()["instances"]])
	get_tree().quit()


func shown(scatter: Node) -> void:
	var deadline := Time.get_ticks_msec() + 30000
	while Time.get_ticks_msec() < deadline and not (scatter.is_settled() and scatter.get_stats()["tiles"] > 0):
		await get_tree().process_frame


## Uses a heightmap as ground for a while, so a worker reads it and computes its summary.
func print_summary(scatter: Node) -> void:
	var image := Image.create_empty(5, 5, false, Image.FORMAT_RF)
	image.fill(Color(3.0, 0.0, 0.0))
	image.set_pixel(2, 2, Color(9.0, 0.0, 0.0))
	var terrain: Resource = ClassDB.instantiate("ScatterGroundHeightmap")
	terrain.image = image
	terrain.heights_in_meters = true
	var before: Resource = scatter.ground
	scatter.ground = terrain
	await shown(scatter)
	var summary: Dictionary = terrain.get_summary()
	print("heightmap: %s, %s to %s m" % [summary["size"], summary["lowest"], summary["highest"]])
	scatter.ground = before
	await shown(scatter)
