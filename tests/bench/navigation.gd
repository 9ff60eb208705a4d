extends "bench.gd"
## Measures the cost of trees in the bake of a navigation mesh: about 1,300 trees on 180 by 180 meters, with no tiles loaded.
## Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/navigation.gd [-- ROUNDS]
##
## Bakes are measured in CPU time. Contenders take turns in each round, and differences are computed within a round.
## Thicket's part of the cost is to find the trees and to pass them to the engine, which reads them. It is measured as the
## added cost of trees that are above all ground, because these leave no holes. The remaining cost is the engine's, for a
## mesh with so many holes, regardless of their origin. It is compared with the cost of the smallest possible holes, of one
## cell, and of the same trees as bodies in the scene.

enum { NONE, TREES, ABOVE, CELLS, BODIES }

const DEFAULT_ROUNDS := 9
const SIDE := 180.0 ## Edge length of the baked area in meters.

var _layer := ScatterLayer.new()
var _region := NavigationRegion3D.new()
var _bodies := Node3D.new()


func run() -> String:
	var rounds := rounds_or(DEFAULT_ROUNDS)
	_make_scene()
	await process_frame
	var trees := _make_bodies()
	var parse: Array[Array] = []
	var joined: Array[Array] = []
	for kind in BODIES + 1:
		parse.push_back([])
		joined.push_back([])
	for round in rounds:
		for kind in BODIES + 1:
			_measure(NONE, [], []) # A run that is not counted: memory that earlier work has freed would favor the first kind.
			_measure(kind, parse[kind], joined[kind])
	row("navigation: parsing with %d trees" % trees, parse[TREES], "ms", 2)
	row("navigation: time that the trees add to the bake", _added(joined, TREES), "ms", 2)
	row("navigation: Thicket's fraction of it, without holes", _added(joined, ABOVE), "ms", 2)
	row("navigation: time added by the same number of one-cell holes", _added(joined, CELLS), "ms", 2)
	row("navigation: time added by the same trees as bodies in the scene", _added(joined, BODIES), "ms", 2)
	_bodies.free()
	_region.queue_free()
	return "" if trees > 1250 and trees < 1350 else "there must be 1,251 to 1,349 trees, got %d" % trees


func _make_scene() -> void:
	_layer.radius = 4.2
	_layer.meshes = [BoxMesh.new()]
	_layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
	var mesh := NavigationMesh.new()
	mesh.geometry_parsed_geometry_type = NavigationMesh.PARSED_GEOMETRY_STATIC_COLLIDERS
	_region.navigation_mesh = mesh
	var box := BoxShape3D.new()
	box.size = Vector3(SIDE, 1.0, SIDE)
	_region.add_child(_body(box, Vector3(0.0, -0.5, 0.0)))
	root.add_child(_region)
	make_scatter(ScatterGroundFlat.new(), [_layer], Node3D.new())
	scatter.viewers = []
	scatter.reparent(_region, false)


func _body(shape: Shape3D, at: Vector3) -> StaticBody3D:
	var collision := CollisionShape3D.new()
	collision.shape = shape
	var body := StaticBody3D.new()
	body.add_child(collision)
	body.position = at
	return body


## Creates the same trees as bodies, and returns their number.
func _make_bodies() -> int:
	var trees := scatter.query_rect(Rect2(-SIDE / 2, -SIDE / 2, SIDE, SIDE))
	var shape := CylinderShape3D.new()
	shape.radius = _layer.instance_radius
	shape.height = _layer.instance_height
	for index in trees.size():
		_bodies.add_child(_body(shape, trees.get_position(index) + Vector3.UP * shape.height / 2))
	return trees.size()


func _measure(kind: int, r_parse: Array, r_whole: Array) -> void:
	_layer.affect_navigation_mesh = kind != NONE and kind != BODIES
	scatter.regenerate() # Each round must regenerate its tiles.
	if kind == BODIES:
		_region.add_child(_bodies)
	var data := NavigationMeshSourceGeometryData3D.new()
	r_parse.push_back(time_of(_parse.bind(data)) / 1000.0)
	if kind == ABOVE:
		_change(data, func(tree: Dictionary) -> void: tree.elevation += 1000.0)
	elif kind == CELLS:
		_change(data, _shrink)
	r_whole.push_back(processor_time_of(_bake.bind(data)) / 1000.0 + r_parse[-1])
	if kind == BODIES:
		_region.remove_child(_bodies)


func _change(data: NavigationMeshSourceGeometryData3D, change: Callable) -> void:
	var trees := data.get_projected_obstructions()
	for tree: Dictionary in trees:
		change.call(tree)
	data.set_projected_obstructions(trees)


## Shrinks an outline to one cell around its center, or sometimes two. The agent's radius does not apply, because the
## outline is carved.
func _shrink(tree: Dictionary) -> void:
	var outline: PackedFloat32Array = tree.vertices
	@warning_ignore("integer_division")
	var column_count := outline.size() / 2
	var middle := Vector2((outline[0] + outline[column_count]) / 2.0, (outline[2] + outline[column_count + 2]) / 2.0)
	var half := 0.51 * _region.navigation_mesh.cell_size
	tree.vertices = PackedFloat32Array([middle.x - half, 0, middle.y - half, middle.x + half, 0, middle.y - half,
			middle.x + half, 0, middle.y + half, middle.x - half, 0, middle.y + half])
	tree.carve = true


func _added(joined: Array[Array], kind: int) -> PackedFloat64Array:
	var added := PackedFloat64Array()
	for round in joined[kind].size():
		added.push_back(joined[kind][round] - joined[NONE][round])
	return added


func _parse(data: NavigationMeshSourceGeometryData3D) -> void:
	NavigationServer3D.parse_source_geometry_data(_region.navigation_mesh, data, _region)


func _bake(data: NavigationMeshSourceGeometryData3D) -> void:
	NavigationServer3D.bake_from_source_geometry_data(_region.navigation_mesh, data)
