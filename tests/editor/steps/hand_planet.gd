@tool
extends "res://tests/steps.gd"
## Plants, moves and rotates instances with the hand tool on the side of a planet, where up is horizontal.

const SCENE := "res://planet.tscn"
const RADIUS := 20.0
## The camera of a new scene looks at the origin from +x, +y and +z. The planet's equator is at the origin.
const CENTER := Vector3(0.0, 0.0, -RADIUS)

var scatter: Node3D
var hand: Node
var layer: Resource


func make_scene() -> void:
	var root := Node3D.new()
	root.name = "Field"
	scatter = ClassDB.instantiate(&"TerrainScatter3D")
	scatter.name = "Rocks"
	var ground: Resource = ClassDB.instantiate(&"ScatterGroundMeshes")
	ground.set(&"group", &"ground")
	ground.set(&"planet_radius", RADIUS)
	ground.set(&"planet_center", CENTER)
	scatter.set(&"ground", ground)
	layer = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = "Rock"
	layer.set(&"view_distance", 30.0)
	layer.set(&"tile_size", 16.0)
	layer.set(&"on_surfaces", true)
	layer.set(&"density", 0.0)
	layer.set(&"height_offset", 0.1)
	var mesh := BoxMesh.new()
	mesh.size = Vector3(0.3, 0.4, 0.5)
	layer.set(&"meshes", [mesh])
	layer.set(&"instance_radius", 0.25)
	layer.set(&"instance_height", 0.4)
	scatter.set(&"layers", [layer])
	root.add_child(scatter)
	scatter.owner = root
	add_planet(root, RADIUS, CENTER, 256)
	save_scene(root, SCENE)


## Returns the position on the planet at these x and y.
func on_planet(x: float, y: float) -> Vector3:
	return CENTER + Vector3(x, y, sqrt(RADIUS * RADIUS - x * x - y * y))


func placed() -> PackedInt64Array:
	return scatter.get(&"state").get_added() if scatter.get(&"state") != null else PackedInt64Array()


func transform_of(id: int) -> Transform3D:
	var instance: RefCounted = scatter.get_instance(id)
	return instance.transform if instance != null else Transform3D()


func check_upright(id: int, at: Vector3, context: String) -> void:
	var found := transform_of(id)
	var up := (at - CENTER).normalized()
	check(found.origin.distance_to(at + 0.1 * up) < 0.05, "%s: at %s, expected %s" % [context, found.origin, at + 0.1 * up])
	check(found.basis.y.normalized().angle_to(up) < 0.01, "%s: upright: %s, expected %s" % [context, found.basis.y, up])


func test_prepare() -> void:
	make_scene()
	scatter = (await open(SCENE)).get_node("Rocks")
	layer = scatter.layers[0]
	EditorInterface.set_main_screen_editor("3D")
	await select_node(scatter)
	await settle(scatter)
	hand = await turn_on_hand()


func test_plant_and_move() -> void:
	var at := on_planet(0.6, 0.4)
	await move_mouse(on_screen(at))
	check(hand._ghost.is_shown(), "the preview is visible on the side of the planet")
	await click_at(on_screen(at))
	check_equal(hand.problem, "", "planting reports no problem")
	if not check(placed().size() == 1, "one instance: %s" % placed()):
		return
	var id := placed()[0]
	check_upright(id, at, "planted")
	await picture("hand_planet")
	var start := transform_of(id)
	var to := on_planet(-0.5, 1.0)
	await drag_mouse(on_screen(start.origin), on_screen(start.origin + (to - at)))
	check(transform_of(id).origin.distance_to(start.origin) > 1.0, "the instance moves")
	var moved := transform_of(id).origin
	check(absf(moved.distance_to(CENTER) - RADIUS - 0.1) < 0.01, "it keeps its height above the ground: %f" % (moved.distance_to(CENTER) - RADIUS))
	check(moved.distance_to(to) < 0.3, "it moved to %s, expected near %s" % [moved, to])
	check(transform_of(id).basis.y.angle_to(moved - CENTER) < 0.01, "it stays upright")
	await undo()
	check(transform_of(id) == start, "undo restores the transform bit for bit")


func test_rotate_and_align() -> void:
	var id := placed()[0]
	await key(KEY_ESCAPE)
	await click_at(on_screen(transform_of(id).origin))
	check_equal(hand.selected, id, "a click selects the instance")
	var start := transform_of(id)
	await key(KEY_R)
	var turned := transform_of(id)
	check(turned.basis.y.distance_to(start.basis.y) < 1e-4, "R rotates about the planet's up direction")
	check(absf(turned.basis.z.angle_to(start.basis.z) - deg_to_rad(15.0)) < 1e-3, "R rotates by one step")
	var knob: Vector3 = hand._frame.handle_position(1)
	var up := start.basis.y.normalized()
	await drag_mouse(on_screen(knob), on_screen(start.origin + (knob - start.origin).rotated(up, PI * 0.5)))
	check(transform_of(id).basis.y.distance_to(start.basis.y) < 1e-4, "the handle rotates about the up direction, too")
	check(absf(transform_of(id).basis.z.angle_to(turned.basis.z) - PI * 0.5) < 0.05, "the handle rotates by a quarter turn")
	await key(KEY_ESCAPE)
	hand.planting.choose(true, true, false, false)
	var at := on_planet(-0.6, -0.4)
	await click_at(on_screen(at))
	check_equal(placed().size(), 2, "a second instance is planted with Snap and Align")
	check_upright(hand.selected, at, "aligned")
