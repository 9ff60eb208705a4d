extends "terrain_harness.gd"
## Tests ground scripts with side effects during a call: they query other ground, move or free nodes, or release the ground.

## A node that returns heights and runs an action during a call.
class Busy extends Node3D:
	var in_call := Callable() ## The next call to get_height() on the main thread runs this once.
	var height := 5.0
	var mutex := Mutex.new()
	var call_count := 0

	func get_height(_at: Vector3) -> float:
		mutex.lock()
		call_count += 1
		mutex.unlock()
		if in_call.is_valid() and OS.get_thread_caller_id() == OS.get_main_thread_id():
			var act := in_call
			in_call = Callable()
			act.call()
		return height


## A node that returns heights slowly, on any thread.
class Slow extends Node3D:
	func get_height(_at: Vector3) -> float:
		OS.delay_usec(100)
		return 2.0


## During a call, queries a second ground and then makes a change that waits until calls end. The end of the inner call must not count as
## the end of the outer one.
func test_an_inner_call_does_not_end_the_outer_one() -> void:
	for thread_safe: bool in [false, true]:
		for same: bool in [false, true]:
			for act: String in ["leaves the tree", "recenters", "is freed later", "changes its path"]:
				var context := "thread_safe %s, same ground %s, %s" % [thread_safe, same, act]
				var busy := Busy.new()
				var scatter := make_on(busy, thread_safe)
				var other := scatter if same else make_on(Busy.new(), thread_safe)
				await settle(scatter)
				await settle(other)
				var ran := [0]
				busy.in_call = func() -> void:
					check_equal(other.ground.get_height(Vector3(1, 0, 1)), 5.0, context + ": the inner height")
					match act:
						"leaves the tree":
							root.remove_child(busy)
						"recenters":
							scatter.world_offset = Vector3(64, 0, 0)
						"is freed later":
							busy.queue_free()
						"changes its path":
							(scatter.ground as ScatterGroundNode).node = ^"../Nobody"
					ran[0] += 1
				var got := scatter.ground.get_height(Vector3.ZERO)
				check_equal(ran[0], 1, context + ": the action ran")
				check(is_nan(got) or got == 5.0, "%s: the outer height is %s" % [context, got])
				errors.take()
				scatter.free()
				if not same:
					other.free()
				if not busy.is_inside_tree():
					busy.free()
				await clean()
				errors.take()


## While this thread calls one node, removing a second node must still wait until workers have finished their calls to it.
func test_a_call_to_one_object_does_not_affect_a_second_one() -> void:
	for round in 6:
		var slow := Slow.new()
		var working := make_on(slow, true)
		var busy := Busy.new()
		var scatter := make_on(busy)
		await settle(scatter)
		working.regenerate()
		await frames(2 + round)
		busy.in_call = func() -> void:
			root.remove_child(slow)
			slow.free() # The engine refuses this while a thread is calling the node.
		scatter.ground.get_height(Vector3.ZERO)
		check(not is_instance_valid(slow), "the node is freed although workers were calling it")
		await frames(3)
		errors.take()
		working.free()
		await clean()
	errors.take()


## A node may leave the tree during its own call. Leaving waits for the calls on other threads.
func test_an_object_that_leaves_the_tree_in_its_own_call() -> void:
	for round in 6:
		var busy := Busy.new()
		var scatter := make_on(busy, true, make_layer(1.0))
		await settle(scatter)
		scatter.regenerate()
		await frames(1 + round % 3)
		busy.in_call = func() -> void: root.remove_child(busy)
		scatter.ground.get_height(Vector3.ZERO)
		var call_count := busy.call_count
		OS.delay_msec(20)
		check_equal(busy.call_count, call_count, "a node outside of the tree is not called")
		scatter.free()
		busy.free()
		await clean()
		errors.take()


class Releasing extends ScatterGround:
	var release := Callable()
	var calls := 0

	func _act() -> void:
		calls += 1
		if release.is_valid():
			release.call()

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		_act()
		var heights := PackedFloat32Array()
		heights.resize(positions.size())
		return heights


class ReleasingNormals extends Releasing:
	func _get_normals(positions: PackedVector2Array) -> PackedVector3Array:
		_act()
		var normals := PackedVector3Array()
		normals.resize(positions.size())
		normals.fill(Vector3.UP)
		return normals


class ReleasingWeights extends ReleasingNormals:
	func _get_weights(positions: PackedVector2Array, _textures: PackedInt32Array) -> PackedFloat32Array:
		_act()
		var weights := PackedFloat32Array()
		weights.resize(positions.size())
		weights.fill(1.0)
		return weights


class ReleasingAtOnce extends ReleasingNormals:
	func _is_thread_safe() -> bool:
		if OS.get_thread_caller_id() == OS.get_main_thread_id():
			_act()
		return false


var held: ScatterGround
var holder: TerrainScatter3D


## A method of the ground releases the last reference to the ground.
func test_a_ground_that_is_released_in_its_own_call() -> void:
	for type: GDScript in [Releasing, ReleasingNormals, ReleasingWeights, ReleasingAtOnce]:
		for method: StringName in [&"get_height", &"get_normal"]:
			held = type.new()
			held.release = func() -> void: held = null
			held.call(method, Vector3.ZERO)
			check(held == null, "the ground is released in %s" % method)
	var busy := Busy.new()
	holder = make_on(busy)
	await settle(holder)
	busy.in_call = func() -> void: holder.ground = null
	holder.ground.get_height(Vector3.ZERO)
	check(holder.ground == null, "a ground node is released")
	errors.take()


## The last reference to a ground is released while a scatter calls it, either in a frame or in a method that a script calls.
func test_a_scatter_whose_ground_is_released_in_a_call() -> void:
	for type: GDScript in [Releasing, ReleasingNormals, ReleasingWeights, ReleasingAtOnce]:
		for after in [1, 2, 3, 7]:
			for act: String in ["terrain", "layers", "free later", "leave"]:
				var layer := make_layer()
				layer.ground_textures = PackedInt32Array([0])
				var terrain: ScatterGround = type.new()
				holder = make_scatter([layer], terrain, make_viewer())
				var release := func() -> void:
					if terrain.calls < after or not is_instance_valid(holder):
						return
					match act:
						"terrain":
							holder.ground = null
						"layers":
							holder.layers = []
						"free later":
							holder.queue_free() # The engine would use the freed node if its own notification freed it immediately.
						"leave":
							if holder.is_inside_tree():
								root.remove_child(holder)
				terrain.release = release
				await frames(4)
				if is_instance_valid(holder):
					holder.query_sphere(Vector3(500, 0, 500), 10.0)
				if is_instance_valid(holder):
					holder.build_rect(layer, Rect2(0, 0, 10, 10))
				check(terrain.calls >= mini(after, 2), "%d calls" % terrain.calls)
				terrain.release = Callable()
				if is_instance_valid(holder):
					holder.free()
				await clean()
				errors.take()


## A terrain node whose methods run an action. A script's methods may free the node or query the ground.
class Map extends Node3D:
	var act := Callable()

	func get_data() -> Object:
		if act.is_valid():
			act.call()
		return self

	func get_internal_transform() -> Transform3D:
		return Transform3D.IDENTITY

	func get_resolution() -> int:
		return 65

	func get_interpolated_height_at(_at: Vector3) -> float:
		return 1.0


func test_a_node_that_runs_an_action_while_it_is_read() -> void:
	for act: String in ["free later", "leave", "query", "other node", "free the scatter", "no terrain"]:
		var map := Map.new()
		root.add_child(map)
		var terrain := ScatterGroundNode.new()
		var scatter := make_scatter([make_layer()], terrain, make_viewer())
		var ran := [0]
		map.act = func() -> void:
			ran[0] += 1
			if ran[0] > 3:
				return
			match act:
				"free later":
					map.queue_free()
				"leave":
					root.remove_child(map)
				"query":
					terrain.get_height(Vector3.ZERO)
				"other node":
					terrain.node = ^"../Nobody"
				"free the scatter":
					scatter.free()
				"no terrain":
					scatter.ground = null
		terrain.node = NodePath("../" + map.name)
		await frames(5)
		check(ran[0] > 0 and ran[0] < 20, "%s: the node is read %d times" % [act, ran[0]])
		if is_instance_valid(scatter):
			scatter.free()
		if is_instance_valid(map):
			map.free()
		await clean()
		errors.take()
