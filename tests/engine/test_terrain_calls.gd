extends "terrain_harness.gd"
## Ground that a script gives, whose script does something else while it is asked: it asks other ground, moves and frees what it
## can reach, and lets go of the terrain.

## A node that gives heights, and does something in the middle of giving one.
class Busy extends Node3D:
	var in_call := Callable() ## Called within get_height on the main thread, once, and then forgotten.
	var height := 5.0
	var mutex := Mutex.new()
	var asked := 0

	func get_height(_at: Vector3) -> float:
		mutex.lock()
		asked += 1
		mutex.unlock()
		if in_call.is_valid() and OS.get_thread_caller_id() == OS.get_main_thread_id():
			var act := in_call
			in_call = Callable()
			act.call()
		return height


## Takes its time, on whatever thread.
class Slow extends Node3D:
	func get_height(_at: Vector3) -> float:
		OS.delay_usec(100)
		return 2.0


## Asks another terrain within a call, then does what waits for calls to end. The inner call ends before the outer one.
func test_an_inner_call_does_not_end_the_outer_one() -> void:
	for thread_safe: bool in [false, true]:
		for same: bool in [false, true]:
			for act: String in ["leaves the tree", "recenters", "is freed later", "changes its path"]:
				var what := "thread_safe %s, same ground %s, %s" % [thread_safe, same, act]
				var busy := Busy.new()
				var scatter := make_on(busy, thread_safe)
				var other := scatter if same else make_on(Busy.new(), thread_safe)
				await settle(scatter)
				await settle(other)
				var ran := [0]
				busy.in_call = func() -> void:
					check_equal(other.ground.get_height(Vector3(1, 0, 1)), 5.0, what + ": the inner height")
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
				check_equal(ran[0], 1, what + ": it ran")
				check(is_nan(got) or got == 5.0, "%s: the outer height is %s" % [what, got])
				errors.take()
				scatter.free()
				if not same:
					other.free()
				if not busy.is_inside_tree():
					busy.free()
				await clean()
				errors.take()


## One object's call on this thread is none of another object: who closes that waits for its workers.
func test_a_call_of_one_object_does_not_stand_for_another() -> void:
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
			slow.free() # The engine refuses this while anybody calls it.
		scatter.ground.get_height(Vector3.ZERO)
		check(not is_instance_valid(slow), "freed while workers asked it")
		await frames(3)
		errors.take()
		working.free()
		await clean()
	errors.take()


## Within its own call the object may go as well: other threads' calls are waited for.
func test_an_object_that_goes_in_its_own_call() -> void:
	for round in 6:
		var busy := Busy.new()
		var scatter := make_on(busy, true, make_layer(1.0))
		await settle(scatter)
		scatter.regenerate()
		await frames(1 + round % 3)
		busy.in_call = func() -> void: root.remove_child(busy)
		scatter.ground.get_height(Vector3.ZERO)
		var asked := busy.asked
		OS.delay_msec(20)
		check_equal(busy.asked, asked, "nobody asks a node that has left the tree")
		scatter.free()
		busy.free()
		await clean()
		errors.take()


class Letting extends ScatterGround:
	var let_go := Callable()
	var calls := 0

	func _act() -> void:
		calls += 1
		if let_go.is_valid():
			let_go.call()

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		_act()
		var heights := PackedFloat32Array()
		heights.resize(positions.size())
		return heights


class LettingNormals extends Letting:
	func _get_normals(positions: PackedVector2Array) -> PackedVector3Array:
		_act()
		var normals := PackedVector3Array()
		normals.resize(positions.size())
		normals.fill(Vector3.UP)
		return normals


class LettingWeights extends LettingNormals:
	func _get_weights(positions: PackedVector2Array, _textures: PackedInt32Array) -> PackedFloat32Array:
		_act()
		var weights := PackedFloat32Array()
		weights.resize(positions.size())
		weights.fill(1.0)
		return weights


class LettingAtOnce extends LettingNormals:
	func _is_thread_safe() -> bool:
		if OS.get_thread_caller_id() == OS.get_main_thread_id():
			_act()
		return false


var held: ScatterGround
var holder: TerrainScatter3D


## The last reference to a terrain goes while it is asked, wherever that is.
func test_a_terrain_that_is_let_go_in_its_own_call() -> void:
	for type: GDScript in [Letting, LettingNormals, LettingWeights, LettingAtOnce]:
		for method: StringName in [&"get_height", &"get_normal"]:
			held = type.new()
			held.let_go = func() -> void: held = null
			held.call(method, Vector3.ZERO)
			check(held == null, "let go in %s" % method)
	var busy := Busy.new()
	holder = make_on(busy)
	await settle(holder)
	busy.in_call = func() -> void: holder.ground = null
	holder.ground.get_height(Vector3.ZERO)
	check(holder.ground == null, "let go of an object's ground")
	errors.take()


## The same when it is a scatter that asks: in any frame of its work, and in what scripts ask of it.
func test_a_scatter_that_loses_its_terrain_or_itself_in_a_call() -> void:
	for type: GDScript in [Letting, LettingNormals, LettingWeights, LettingAtOnce]:
		for after in [1, 2, 3, 7]:
			for act: String in ["terrain", "layers", "free later", "leave"]:
				var layer := make_layer()
				layer.ground_textures = PackedInt32Array([0])
				var terrain: ScatterGround = type.new()
				holder = make_scatter([layer], terrain, make_viewer())
				var let_go := func() -> void:
					if terrain.calls < after or not is_instance_valid(holder):
						return
					match act:
						"terrain":
							holder.ground = null
						"layers":
							holder.layers = []
						"free later":
							holder.queue_free() # A node freed within its own notification is used by the engine after that.
						"leave":
							if holder.is_inside_tree():
								root.remove_child(holder)
				terrain.let_go = let_go
				await frames(4)
				if is_instance_valid(holder):
					holder.query_sphere(Vector3(500, 0, 500), 10.0)
				if is_instance_valid(holder):
					holder.build_rect(0, Rect2(0, 0, 10, 10))
				check(terrain.calls >= mini(after, 2), "asked %d times" % terrain.calls)
				terrain.let_go = Callable()
				if is_instance_valid(holder):
					holder.free()
				await clean()
				errors.take()


## Whatever is looked for in a node may be its script's: it may free the node, or look at the ground itself.
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


func test_a_node_that_acts_while_it_is_looked_at() -> void:
	for act: String in ["free later", "leave", "ask", "other node", "free the scatter", "no terrain"]:
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
				"ask":
					terrain.get_height(Vector3.ZERO)
				"other node":
					terrain.node = ^"../Nobody"
				"free the scatter":
					scatter.free()
				"no terrain":
					scatter.ground = null
		terrain.node = NodePath("../" + map.name)
		await frames(5)
		check(ran[0] > 0 and ran[0] < 20, "%s: looked at %d times" % [act, ran[0]])
		if is_instance_valid(scatter):
			scatter.free()
		if is_instance_valid(map):
			map.free()
		await clean()
		errors.take()
