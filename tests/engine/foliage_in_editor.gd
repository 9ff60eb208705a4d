@tool
extends Node
## A node in a scene that the editor opens. Prints the wind strengths that a ScatterFoliageWorld shows and those in the materials.

func _ready() -> void:
	if not Engine.is_editor_hint():
		return
	var scatter := get_node("../Scatter")
	var world := get_node("../World")
	var found: ShaderMaterial = scatter.layers[0].material_override
	var listed: ShaderMaterial = world.materials[0]
	for frame in 5:
		await get_tree().process_frame
	print("shown: %s" % [[found, listed].map(shown_strength)])
	print("kept: %s" % [[found, listed].map(func(one: ShaderMaterial) -> Variant:
		return one.get_shader_parameter(&"wind_strength"))])
	world.get_parent().remove_child(world)
	print("without the world: %s" % [[found, listed].map(shown_strength)])
	world.free()
	get_tree().quit()


func shown_strength(of: ShaderMaterial) -> Variant:
	return RenderingServer.material_get_param(of.get_rid(), "wind_strength")
