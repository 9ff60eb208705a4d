@tool
extends "res://tests/steps.gd"
## Tests regions of all shapes on a scatter's ground: their gizmos, and the handles that resize them.

## World x and z of the ground position at which the camera looks.
const AT := Vector2(40.0, -30.0)

var scatter: Node3D


func on_ground(x: float, z: float) -> Vector3:
	return Vector3(x, scatter.ground.get_height(Vector3(x, 0.0, z)), z)


## Adds regions of all shapes under the scatter and drags their handles, with undo.
func drag_all() -> void:
	var regions: Array[Node3D] = []
	for shape in 5:
		var region: Node3D = ClassDB.instantiate(&"ScatterRegion3D")
		region.shape = shape
		region.exclude = shape % 2 == 0
		region.falloff = 2.0
		region.radius = 7.0
		region.size = Vector3(14.0, 8.0, 10.0)
		region.polygon = PackedVector2Array([Vector2(-8, -6), Vector2(8, -8), Vector2(2, 0), Vector2(8, 8), Vector2(-8, 6)])
		scatter.add_child(region)
		region.owner = EditorInterface.get_edited_scene_root()
		region.global_position = on_ground(AT.x - 40.0 + 20.0 * shape, AT.y - 12.0 + 10.0 * (shape % 2))
		regions.append(region)
	var path := Path3D.new()
	path.curve = Curve3D.new()
	for step in 5:
		path.curve.add_point(on_ground(AT.x + 20.0 * step - 40.0, AT.y + 20.0 + 6.0 * (step % 2)))
	scatter.add_child(path)
	path.owner = EditorInterface.get_edited_scene_root()
	regions[4].path = regions[4].get_path_to(path)
	EditorInterface.get_selection().clear()
	for region in regions:
		EditorInterface.get_selection().add_node(region)
	await settle(scatter)
	await frames(30)
	await picture("gizmos")
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(regions[2])
	EditorInterface.edit_node(regions[2])
	await picture("region")
	drag(regions[0], 0, Vector3(10.0, 0.0, 0.0), &"size", Vector3(17.0, 8.0, 10.0))
	drag(regions[0], 4, Vector3(0.0, 0.0, 4.0), &"size", Vector3(14.0, 8.0, 9.0))
	drag(regions[1], 0, Vector3(5.0, 0.0, 0.0), &"radius", 5.0)
	drag(regions[2], 0, Vector3(6.0, 0.0, 0.0), &"radius", 6.0)
	drag(regions[2], 1, Vector3(0.0, 2.0, 0.0), &"height", 7.0)
	var polygon: PackedVector2Array = regions[3].polygon
	polygon[1] = Vector2(9.0, -7.0)
	drag(regions[3], 1, Vector3(9.0, 0.0, -7.0), &"polygon", polygon)
	var across := Vector3(-6.0, 0.0, 20.0).normalized()
	var start: Vector3 = regions[4].to_local(path.to_global(path.curve.get_point_position(0)))
	drag(regions[4], 0, start + across * 3.0, &"width", 6.0)
	for region in regions:
		region.queue_free()
	path.queue_free()
	await frames(2)


## Drags a region's handle to a position in the region's space, checks the property, and undoes it.
func drag(region: Node3D, handle: int, to: Vector3, property: StringName, expected: Variant) -> void:
	var gizmo := region.get_gizmos()[0] as EditorNode3DGizmo
	var gizmos := gizmo.get_plugin()
	gizmos._begin_handle_action(gizmo, handle, false)
	var before_drag: Variant = gizmos._get_handle_value(gizmo, handle, false)
	check(before_drag == region.get(property), "handle %d belongs to %s" % [handle, property])
	gizmos._set_handle(gizmo, handle, false, camera(), camera().unproject_position(region.to_global(to)))
	gizmos._commit_handle(gizmo, handle, false, before_drag, false)
	var message := "%s of shape %d: %s, dragged to %s" % [property, region.shape, region.get(property), expected]
	if expected is float:
		check(absf(region.get(property) - expected) < 0.02, message)
	elif expected is Vector3:
		check(region.get(property).distance_to(expected) < 0.02, message)
	else:
		check(region.get(property)[handle].distance_to(expected[handle]) < 0.02, message)
	history(region).undo()
	check(region.get(property) == before_drag, "%s is restored" % property)
