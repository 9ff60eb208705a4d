@tool
extends RefCounted
## Requests thumbnails of layers, like those in the FileSystem dock.

const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")

## Emitted when the thumbnail of a layer is ready.
signal made(layer: ScatterLayer, picture: Texture2D)

var _requested: Dictionary[int, int] = {} ## A hash of the resource whose thumbnail was last requested, by the layer's instance ID.


## Requests a thumbnail of the first mesh, scene or model of a layer, unless this layer's last request was for the same
## resource. [signal made] is emitted later, unless there is no thumbnail.
func ask(scatter: TerrainScatter3D, layer: ScatterLayer) -> void:
	var first: Resource = null
	for mesh: Resource in layer.meshes:
		first = first if first != null else mesh
	var resource_hash := hash([first.get_instance_id() if first != null else 0])
	if _requested.get(layer.get_instance_id(), 0) == resource_hash or first == null:
		return
	_requested[layer.get_instance_id()] = resource_hash
	var previewer := EditorInterface.get_resource_previewer()
	if first is Mesh:
		previewer.queue_edited_resource_preview(first, self, &"_on_preview", [layer, scatter])
	elif not first.resource_path.is_empty():
		previewer.queue_resource_preview(first.resource_path, self, &"_on_preview", [layer, scatter, first])


func _on_preview(_path: String, preview: Texture2D, small_preview: Texture2D, context: Array) -> void:
	var layer: ScatterLayer = context[0]
	var picture := preview if preview != null else small_preview
	if picture != null:
		made.emit(layer, picture)
	elif context.size() > 2 and is_instance_valid(context[1]):
		_request_drawn(context[1], layer)


## Requests a thumbnail of the mesh that is drawn for a scene, because a scene that was never saved in this editor has no thumbnail.
func _request_drawn(scatter: TerrainScatter3D, layer: ScatterLayer) -> void:
	if not layer in ScatterLayers.of(scatter):
		return
	for tile in scatter.get_shown_tiles(layer):
		var displayed_tile := scatter.get_tile(layer, tile)
		if displayed_tile.get_mesh_count() > 0 and displayed_tile.get_mesh(0) != null:
			EditorInterface.get_resource_previewer().queue_edited_resource_preview(
					displayed_tile.get_mesh(0), self, &"_on_preview", [layer, scatter])
			return
	_requested.erase(layer.get_instance_id()) # There are no tiles yet, so a later call must try again.
