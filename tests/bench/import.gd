extends "bench.gd"
## Measures the time to import 100,000 instances from a MultiMesh at the origin, from a rotated one, and from a table of
## positions, rotations and scales. Also measures the time to remove all of these instances. Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/import.gd [-- ROUNDS]

const ImportInstances := preload("res://addons/thicket/import_instances.gd")
const DEFAULT_ROUNDS := 5
const COUNT := 100_000
const FILE := "user://thicket_import_bench.csv"

var _floats := PackedFloat32Array()
var _layer := ScatterLayer.new()


func run() -> String:
	_make_sources()
	_layer.density = 0.0
	_layer.meshes = [BoxMesh.new()]
	make_scatter(ScatterGroundFlat.new(), [_layer], Node3D.new())
	var plain := _multimesh()
	var turned := _multimesh()
	turned.transform = Transform3D(Basis.from_euler(Vector3(0.1, 0.2, 0.3)), Vector3(1, 2, 3))
	var sources: Dictionary[String, Callable] = {
		"a MultiMesh": ImportInstances.from_node.bind(plain), "a rotated MultiMesh": ImportInstances.from_node.bind(turned),
		"a table": ImportInstances.from_csv.bind(FILE),
	}
	var removal_times := PackedFloat64Array()
	for label in sources:
		var seconds := PackedFloat64Array()
		for round in rounds_or(DEFAULT_ROUNDS):
			scatter.state = ScatterState.new()
			seconds.push_back(time_of(_import.bind(sources[label])) / 1e6)
			var ids := scatter.state.get_added()
			if ids.size() != COUNT:
				return "%s: expected %d imported instances, got %d" % [label, COUNT, ids.size()]
			removal_times.push_back(time_of(scatter.remove_instances.bind(ids)) / 1e6)
		row("import of 100,000 instances of %s" % label, seconds, "s", 2)
	row("100,000 hand-placed instances removed", removal_times, "s", 2)
	plain.free()
	turned.free()
	return ""


func _import(source: Callable) -> void:
	source.call(scatter, 0)


func _make_sources() -> void:
	var random := RandomNumberGenerator.new()
	var file := FileAccess.open(FILE, FileAccess.WRITE)
	file.store_line("x,y,z,rotation_x,rotation_y,rotation_z,scale_x,scale_y,scale_z")
	for index in COUNT:
		var numbers: Array[float] = []
		for number in 9:
			numbers.push_back(random.randf_range(-500, 500) if number < 6 else random.randf_range(0.5, 2.0))
		file.store_line(",".join(numbers.map(func(number: float) -> String: return str(number))))
		_floats.append_array([1, 0, 0, numbers[0], 0, 1, 0, numbers[1], 0, 0, 1, numbers[2]])
	file.close()


func _multimesh() -> MultiMeshInstance3D:
	var node := MultiMeshInstance3D.new()
	node.multimesh = MultiMesh.new()
	node.multimesh.transform_format = MultiMesh.TRANSFORM_3D
	node.multimesh.mesh = _layer.meshes[0]
	node.multimesh.instance_count = COUNT
	node.multimesh.buffer = _floats
	return node
