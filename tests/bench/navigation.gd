extends "bench.gd"
## What trees add to the bake of a navigation mesh: some 1,300 of them on 180 by 180 meters, of which nothing is loaded, against the
## same bake with a layer that has no part in it. Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/navigation.gd [-- ROUNDS]

const DEFAULT_ROUNDS := 9
const SIDE := 180.0 ## Meters.

var _layer := ScatterLayer.new()
var _region := NavigationRegion3D.new()


func run() -> String:
	var rounds := rounds_or(DEFAULT_ROUNDS)
	_make_scene()
	await process_frame
	var trees := _count()
	var parse: Array[PackedFloat64Array] = [[], []]
	var whole: Array[PackedFloat64Array] = [[], []]
	for round in rounds:
		for with_trees in 2:
			_layer.affect_navigation_mesh = with_trees == 1
			scatter.regenerate() # Each round makes its tiles anew.
			var data := NavigationMeshSourceGeometryData3D.new()
			parse[with_trees].push_back(time_of(_parse.bind(data)) / 1000.0)
			whole[with_trees].push_back(time_of(_bake.bind(data)) / 1000.0 + parse[with_trees][-1])
	var added := PackedFloat64Array()
	var ratio := PackedFloat64Array()
	for round in rounds:
		added.push_back(whole[1][round] - whole[0][round])
		ratio.push_back(whole[1][round] / whole[0][round])
	row("navigation: parsing with %d trees" % trees, parse[1], "ms", 2)
	row("navigation: what they add to the bake", added, "ms", 2)
	row("navigation: bake with them to bake without", ratio, "", 3)
	_region.queue_free()
	return "" if trees > 1250 and trees < 1350 else "%d trees, not some 1,300" % trees


func _make_scene() -> void:
	_layer.radius = 4.2
	_layer.meshes = [BoxMesh.new()]
	_layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
	var mesh := NavigationMesh.new()
	mesh.geometry_parsed_geometry_type = NavigationMesh.PARSED_GEOMETRY_STATIC_COLLIDERS
	_region.navigation_mesh = mesh
	var shape := CollisionShape3D.new()
	var box := BoxShape3D.new()
	box.size = Vector3(SIDE, 1.0, SIDE)
	shape.shape = box
	var body := StaticBody3D.new()
	body.add_child(shape)
	body.position.y = -0.5
	_region.add_child(body)
	root.add_child(_region)
	make_scatter(ScatterTerrainFlat.new(), [_layer], Node3D.new())
	scatter.viewers = []
	scatter.reparent(_region, false)


func _count() -> int:
	return scatter.query_rect(Rect2(-SIDE / 2, -SIDE / 2, SIDE, SIDE)).size()


func _parse(data: NavigationMeshSourceGeometryData3D) -> void:
	NavigationServer3D.parse_source_geometry_data(_region.navigation_mesh, data, _region)


func _bake(data: NavigationMeshSourceGeometryData3D) -> void:
	NavigationServer3D.bake_from_source_geometry_data(_region.navigation_mesh, data)
