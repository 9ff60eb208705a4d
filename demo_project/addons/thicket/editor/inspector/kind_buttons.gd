@tool
extends HFlowContainer
## Buttons at the top of the inspector of one or more layers. Each fits the layers to a kind of mesh, as one undo step.

const NewLayers := preload("res://addons/thicket/editor/layers/new_layers.gd")

const KINDS: Dictionary[String, ScatterLayer.ModelKind] = {
	"Auto": ScatterLayer.KIND_AUTOMATIC,
	"Tree": ScatterLayer.KIND_TREE,
	"Shrub": ScatterLayer.KIND_SHRUB,
	"Grass": ScatterLayer.KIND_GRASS,
	"Rock": ScatterLayer.KIND_ROCK,
}
const TOOLTIP := "Sets radius, density, clumps, scale, tilt, height offset, instance radius and instance height to values that suit %s."
const KIND_DESCRIPTIONS: Dictionary[String, String] = {
	"Auto": "the kind that the names and sizes of the meshes suggest",
	"Tree": "trees: crowns touch, trunks are nearly upright",
	"Shrub": "shrubs: thickets with gaps between them",
	"Grass": "grass or flowers: dense, leaning with the ground",
	"Rock": "rocks: groups of large and small ones, sunk into the ground",
}

var _layers: Array[ScatterLayer] = []


func _init(layers: Array[ScatterLayer] = []) -> void:
	_layers = layers
	var label := Label.new()
	label.text = "Fit to"
	add_child(label)
	for kind in KINDS:
		var button := Button.new()
		button.text = kind
		button.tooltip_text = TOOLTIP % KIND_DESCRIPTIONS[kind]
		button.pressed.connect(_fit.bind(kind))
		add_child(button)


func _fit(kind: String) -> void:
	var undo_redo := EditorInterface.get_editor_undo_redo()
	var layers := _layers.filter(func(layer: ScatterLayer) -> bool: return not layer.meshes.is_empty())
	if layers.is_empty():
		return
	undo_redo.create_action("Fit to Meshes", UndoRedo.MERGE_DISABLE, layers[0])
	for layer: ScatterLayer in layers:
		var template := NewLayers.of_meshes(layer.meshes, KINDS[kind])
		if template != null:
			NewLayers.add_fit(layer, template, undo_redo)
	undo_redo.commit_action()
