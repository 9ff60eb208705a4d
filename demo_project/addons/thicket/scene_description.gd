extends RefCounted
## What a scattered scene is, for whoever bakes it.

const SceneDigest := preload("res://addons/thicket/scene_digest.gd")


## The layers, the seed and so on as plain values, and the digest of the scene, for which the ground is probed in [param probed]
## (x, z, width, depth in meters of the world), or, if that is null, in [code]rect[/code]: where the terrain says that it lies, which is
## empty for one that does not say.
static func of(scatter: Node3D, probed: Variant) -> Dictionary:
	var layers: Array[Dictionary] = []
	for index: int in scatter.call(&"get_layer_count"):
		var layer: Resource = scatter.call(&"get_layer", index)
		if layer != null:
			layers.append({
				"index": index, "name": layer.resource_name, "radius": layer.get(&"radius"), "levels": layer.get(&"progressive_levels"),
				"tile_size": layer.get(&"tile_size"), "colored": layer.get(&"use_colors"), "custom_data": layer.get(&"use_custom_data"),
				"view_distance": layer.get(&"view_distance"), "cast_shadow": layer.get(&"cast_shadow"),
				"render_layers": layer.get(&"render_layers"),
			})
	var rect := _rect_of_terrain(scatter)
	var parts := SceneDigest.parts_of(scatter, Rect2(probed[0], probed[1], probed[2], probed[3]) if probed is Array else rect)
	var offset: Vector3 = scatter.get(&"world_offset")
	return {
		"seed": str(scatter.get(&"seed")), "layers": layers, "parts": parts, "world_offset": [offset.x, offset.y, offset.z],
		"rect": [rect.position.x, rect.position.y, rect.size.x, rect.size.y], "problems": scatter.call(&"get_problems"),
		"scene_digest": JSON.stringify(parts, "", true).sha256_text(), "thicket": SceneDigest.version(),
	}


static func _rect_of_terrain(scatter: Node3D) -> Rect2:
	var rect: Variant = (scatter.get(&"terrain") as Resource).get(&"rect")
	return rect if rect is Rect2 else Rect2()
