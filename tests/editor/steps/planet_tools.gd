@tool
extends "res://tests/steps.gd"
## Uses the tools on the top, on the side and on the underside of a planet: Why?, the brush, the rectangle of a bake, new regions, outlines of
## regions, the handles of regions and of the water, and a preset.

const RADIUS := 20.0
const CENTER := Vector3(3.0, -2.0, 5.0)
## The directions from the planet's center to the middle of the view, and the rotations of the editor's camera about x and y.
const SIDES := {
	"top": [Vector3.UP, Vector2(0.8, 0.4)],
	"side": [Vector3(1.0, 0.0, 0.0), Vector2(0.3, -1.2)],
	"underside": [Vector3.DOWN, Vector2(-0.8, 0.4)],
}

var scatter: Node3D
var stones: Resource
## The planet's up in the middle of the view.
var up: Vector3


func make_layer(title: String, on_surfaces: bool) -> Resource:
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = title
	layer.radius = 0.8
	layer.tile_size = 16.0
	layer.view_distance = 40.0
	layer.on_surfaces = on_surfaces
	var mesh := BoxMesh.new()
	mesh.size = Vector3(0.1, 0.5, 0.1)
	layer.meshes = [mesh]
	return layer


func make_scene(path: String, view: Array) -> void:
	var root := Node3D.new()
	root.name = "Field"
	scatter = ClassDB.instantiate(&"TerrainScatter3D")
	scatter.name = "Stones"
	var ground: Resource = ClassDB.instantiate(&"ScatterGroundMeshes")
	ground.set(&"group", &"ground")
	ground.set(&"planet_radius", RADIUS)
	ground.set(&"planet_center", CENTER)
	scatter.ground = ground
	scatter.layers = [make_layer("Stone", true), make_layer("Grass", false)]
	root.add_child(scatter)
	scatter.owner = root
	add_planet(root, RADIUS, CENTER, 96)
	save_scene(root, path)
	save_view(path, 14.0, CENTER + view[0] * RADIUS, view[1])


## Returns the position on the planet that is some meters to the right and downward from the middle of the view.
func spot(right: float, down: float) -> Vector3:
	var axis := camera().global_basis
	var along := (axis.x - up * up.dot(axis.x)).normalized()
	var at := RADIUS * up + along * right + along.cross(up) * -down
	return CENTER + at.normalized() * RADIUS


func altitude(at: Vector3) -> float:
	return at.distance_to(CENTER) - RADIUS


func tool_named(tool_name: String) -> Node:
	return workspace().toolbar.get(tool_name)


func rows() -> Array:
	return tool_named("why").panel.rows.map(func(row: Array) -> String: return row[1])


func regions() -> Array[Node]:
	return scatter.find_children("*", "ScatterRegion3D", true, false)


func test_tools_on_all_sides() -> void:
	EditorInterface.set_main_screen_editor("3D")
	for side: String in SIDES:
		var path := "res://%s.tscn" % side
		make_scene(path, SIDES[side])
		scatter = (await open(path)).get_node("Stones")
		up = SIDES[side][0]
		stones = scatter.layers[0]
		await select_node(scatter)
		addon().hide_bottom_panel()
		await settle(scatter)
		await frames(5)
		surface().grab_focus()
		await explain(side)
		await paint(side)
		await paint_biomes(side)
		await draw_rectangle(side)
		await add_box(side)
		await draw_polygon(side)
		await draw_path(side)
		await drag_water(side)
	await add_preset("underside")


## The tool must explain the position below the mouse.
func explain(side: String) -> void:
	var tool := tool_named("why")
	tool.set_on(true)
	workspace().toolbar.choose_layer(0)
	await frames(3)
	var reasons := {}
	for index in 5:
		var at := spot(index - 2.0, 0.3 * index)
		await click_at(on_screen(at))
		if not check(tool.pinned.is_finite() and tool.pinned.distance_to(at) < 0.05, "%s: pinned at %s, expected %s" % [side, tool.pinned, at]):
			continue
		var expected: RefCounted = scatter.explain_position(tool.pinned, [stones])[0]
		check(expected.position.distance_to(at) < 0.05 and expected.point_position.distance_to(at) < 0.8, "%s: explained at %s" % [side, expected.position])
		check(rows().any(func(row: String) -> bool: return row.ends_with("Stone: " + expected.reason)), "%s: %s is among %s" % [side, expected.reason, rows()])
		reasons[expected.reason] = true
	check(reasons.size() > 1, "%s: different positions have different explanations" % side)
	if side == "underside":
		check(rows().any(func(row: String) -> bool: return "Grass: Grows only on the top of the ground, %.1f m above" % (2.0 * (-tool.pinned.y + CENTER.y)) in row), "%s: the other layer: %s" % [side, rows()])
	await picture("planet_why_%s" % side)
	tool.choose_colors(2)
	tool.refresh()
	check(tool.overlay.is_shown(), "%s: slopes are shown" % side)
	tool.choose_colors(3)
	tool.refresh()
	check(tool.overlay.is_shown() == (side == "top"), "%s: ranks are shown only near the top" % side)
	tool.choose_colors(0)
	tool.set_on(false)


## Returns the color of the overlay at the vertex nearest to a position.
func color_at(overlay: RefCounted, at: Vector3) -> Color:
	var nearest := Color.TRANSPARENT
	var least := INF
	var mesh: ArrayMesh = overlay._meshes[0]
	for index in mesh.get_surface_count():
		var arrays := mesh.surface_get_arrays(index)
		for vertex in arrays[Mesh.ARRAY_VERTEX].size():
			var distance: float = arrays[Mesh.ARRAY_VERTEX][vertex].distance_to(at)
			if distance < least:
				least = distance
				nearest = arrays[Mesh.ARRAY_COLOR][vertex]
	check(least < 0.6, "the overlay is %f m from %s" % [least, at])
	return nearest


## The brush must erase the stones below the mouse on every side, and the colors must show it.
func paint(side: String) -> void:
	var tool := tool_named("paint")
	tool.set_on(true)
	workspace().toolbar.choose_layer(0)
	tool.choose_mode(1)
	tool.set_brush(1.5, 1.0, 1.0)
	await frames(3)
	var at := spot(0.5, 0.0)
	var beside := spot(-3.0, 0.0)
	await move_mouse(on_screen(at))
	await picture("planet_brush_%s" % side)
	await settle(scatter)
	var before := instances(scatter, 0)
	await drag_mouse(on_screen(at), on_screen(spot(1.5, 0.0)))
	check_equal(tool.problem, "", "%s: no problem" % side)
	if not check(stones.mask != null, "%s: painted" % side):
		return
	check(stones.mask.sample_on_planet(RADIUS, at - CENTER) < 0.01, "%s: erased where the mouse was" % side)
	check(stones.mask.sample_on_planet(RADIUS, CENTER - at) > 0.99, "%s: not erased on the opposite side" % side)
	tool.refresh()
	check(tool.mask_overlay.is_shown(), "%s: the mask is shown" % side)
	check(color_at(tool.mask_overlay, at).r > 0.9 and color_at(tool.mask_overlay, beside).r < 0.5, "%s: the mask's colors" % side)
	await settle(scatter)
	var after := instances(scatter, 0)
	check(not after.values().any(func(found: Vector3) -> bool: return found.distance_to(at) < 1.2), "%s: no stones there" % side)
	for id: int in before:
		if before[id].distance_to(at) > 4.0 and not check(after.has(id), "%s: a stone at %s is gone" % [side, before[id]]):
			break
	await picture("planet_brushed_%s" % side)
	tool.set_on(false)
	await show_density(side, at, beside)
	await undo()
	check(stones.mask == null, "%s: undone" % side)
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), before.size(), "%s: all stones are back" % side)
	tool.choose_mode(0)


## The colors of the density must show the erased mask.
func show_density(side: String, at: Vector3, beside: Vector3) -> void:
	var tool := tool_named("why")
	tool.set_on(true)
	tool.choose_colors(1)
	tool.refresh()
	await until(func() -> bool: return tool.overlay.is_shown() and tool.overlay.is_complete(), "%s: the density is shown" % side)
	check(color_at(tool.overlay, at).r > 0.8 and color_at(tool.overlay, beside).g > 0.8, "%s: the density's colors: %s, %s" % [side, color_at(tool.overlay, at), color_at(tool.overlay, beside)])
	await picture("planet_density_%s" % side)
	tool.choose_colors(0)
	tool.set_on(false)


## The biome brush must change the biome below the mouse.
func paint_biomes(side: String) -> void:
	var map: Resource = ClassDB.instantiate(&"ScatterBiomeMap")
	map.biomes = ["Meadow", "Desert"].map(func(title: String) -> Resource:
		var biome: Resource = ClassDB.instantiate(&"ScatterBiome")
		biome.resource_name = title
		biome.color = Color.GREEN if title == "Meadow" else Color.RED
		return biome)
	map.border_noise = 0.0
	map.border_width = 0.0
	scatter.biomes = map
	await frames(3)
	var tool := tool_named("biomes")
	tool.set_on(true)
	await until(func() -> bool: tool.refresh(); return tool._biomes.item_count == 3, "%s: the biomes are listed" % side)
	tool.choose_biome(1)
	check_equal(tool._index(), 1, "%s: the desert is selected" % side)
	tool.brush.radius = 2.0
	await frames(3)
	var at := spot(0.5, 0.0)
	await drag_mouse(on_screen(at), on_screen(spot(1.5, 0.0)))
	check_equal(tool.problem, "", "%s: no problem of the biome brush" % side)
	check(map.get_biome_on_planet(RADIUS, at - CENTER) == map.biomes[1], "%s: the biome is painted" % side)
	check(map.get_biome_on_planet(RADIUS, spot(-3.0, 0.0) - CENTER) == map.biomes[0], "%s: the biome beside is not" % side)
	check(map.get_biome_on_planet(RADIUS, CENTER - at) == map.biomes[0], "%s: nor on the opposite side" % side)
	tool.refresh()
	check(color_at(tool.overlay, at).r > 0.9, "%s: the color of the biome" % side)
	await picture("planet_biomes_%s" % side)
	await undo()
	check(map.map_image == null, "%s: the biome is undone" % side)
	tool.set_on(false)
	scatter.biomes = null
	await frames(3)


func draw_rectangle(side: String) -> void:
	var tool := tool_named("rectangle")
	var drawn: Array[Rect2] = []
	tool.set_on(true)
	await frames(3)
	var on_drawn := func(rect: Rect2) -> void: drawn.append(rect)
	tool.drawn.disconnect(workspace().bake.take_drawn)
	tool.drawn.connect(on_drawn)
	var from := spot(-2.0, -2.0)
	var to := spot(2.0, 2.0)
	await drag_mouse(on_screen(from), on_screen(to), false, false)
	await picture("planet_rectangle_%s" % side)
	await press(on_screen(to), false)
	if side == "top":
		if check(drawn.size() == 1, "%s: a rectangle: %s" % [side, tool.problem]):
			var corner := drawn[0].position.min(drawn[0].end)
			var expected := Vector2(minf(from.x, to.x), minf(from.z, to.z)).round()
			check_equal(corner, expected, "%s: its corner" % side)
	else:
		check(drawn.is_empty() and "at most 60° from the top" in tool.problem, "%s: no rectangle: %s" % [side, tool.problem])
	tool.drawn.disconnect(on_drawn)
	tool.drawn.connect(workspace().bake.take_drawn)
	tool.set_on(false)


## A region from the menu must be on the ground in the middle of the view, upright.
func add_box(side: String) -> void:
	await select_node(scatter)
	workspace().toolbar.regions._on_chosen(0)
	await frames(4)
	if not check(regions().size() == 1, "%s: a box" % side):
		return
	var region: Node3D = regions()[0]
	check(region.global_position.distance_to(CENTER + up * RADIUS) < 0.1, "%s: in the middle of the view: %s" % [side, region.global_position])
	check(region.global_basis.y.angle_to(region.global_position - CENTER) < 0.01, "%s: upright" % side)
	check_border(region, side)
	await picture("planet_box_%s" % side)
	await drag_face(region, side)
	await undo()
	check(regions().is_empty(), "%s: the box is undone" % side)


## The lines of the border must be on the ground.
func check_border(region: Node3D, context: String) -> void:
	var gizmos := (region.get_gizmos()[0] as EditorNode3DGizmo).get_plugin()
	var border: PackedVector3Array = gizmos._on_ground(region, 0.0)
	check(border.size() > 40, "%s: a border of %d positions" % [context, border.size()])
	var wrong := Array(border).filter(func(at: Vector3) -> bool: return absf(altitude(region.global_transform * at) - 0.1) > 0.05)
	check(wrong.is_empty(), "%s: %d of %d positions are not on the ground" % [context, wrong.size(), border.size()])


func start_drawing(shape: int) -> Node:
	await select_node(scatter)
	surface().grab_focus()
	workspace().toolbar.regions._on_chosen(shape)
	return tool_named("region_drawing")


func draw_polygon(side: String) -> void:
	await settle(scatter)
	var full := instances(scatter, 0)
	var tool := await start_drawing(3)
	var corners: Array[Vector3] = [spot(-2.5, -1.5), spot(2.5, -2.0), spot(2.0, 2.0), spot(-2.0, 1.5)]
	for corner in corners:
		await click_at(on_screen(corner))
	check_equal(tool.corners.size(), 4, "%s: four corners" % side)
	await key(KEY_ENTER)
	await frames(4)
	if not check(regions().size() == 1, "%s: a polygon: %s" % [side, tool.problem]):
		return
	var region: Node3D = regions()[0]
	check(region.get_problems().is_empty(), "%s: no problems: %s" % [side, region.get_problems()])
	for index in 4:
		var at: Vector3 = region.global_transform * Vector3(region.polygon[index].x, 0.0, region.polygon[index].y)
		check((at - CENTER).angle_to(corners[index] - CENTER) < 0.005, "%s: corner %d at %s" % [side, index, at])
	await settle(scatter)
	var left := instances(scatter, 0)
	var gone := full.values().filter(func(at: Vector3) -> bool: return not left.values().has(at))
	check(gone.size() > 10 and gone.all(func(at: Vector3) -> bool: return at.distance_to(CENTER + up * RADIUS) < 3.6), "%s: stones in it are gone: %s" % [side, gone])
	check(not left.values().any(func(at: Vector3) -> bool: return at.distance_to(CENTER + up * RADIUS) < 1.2), "%s: no stones are left in it" % side)
	check_border(region, side + ", polygon")
	await picture("planet_polygon_%s" % side)
	await drag_corner(region, side)
	await undo()
	check(regions().is_empty(), "%s: the polygon is undone" % side)


## Drags the handle of a polygon's corner to a position on the planet.
func drag_corner(region: Node3D, side: String) -> void:
	var before: PackedVector2Array = region.polygon
	check(absf(altitude(handle_of(region, 1)) - 0.1) < 0.05, "%s: the handle is on the ground" % side)
	var to := spot(3.5, -3.0)
	await drag_handle(region, 1, to, "planet_corner_%s" % side)
	var at: Vector3 = region.global_transform * Vector3(region.polygon[1].x, 0.0, region.polygon[1].y)
	check((at - CENTER).angle_to(to - CENTER) < 0.005, "%s: the dragged corner is at %s" % [side, at])
	await undo()
	check_equal(region.polygon, before, "%s: the drag is undone" % side)


## Returns the world position of a handle of a region.
func handle_of(region: Node3D, index: int) -> Vector3:
	var gizmos := (region.get_gizmos()[0] as EditorNode3DGizmo).get_plugin()
	return region.global_transform * (gizmos._handles(region) as PackedVector3Array)[index]


## Drags a handle of the selected region with the mouse to the pixel of a world position. Takes a picture before the button is released.
func drag_handle(region: Node3D, index: int, to: Vector3, picture_name := "") -> void:
	var from := on_screen(handle_of(region, index))
	await drag_mouse(from, on_screen(to), false, false)
	if not picture_name.is_empty():
		await picture(picture_name)
	await press(on_screen(to), false)
	await frames(2)


## The handle of a box's face changes its size, and the opposite face stays in place.
func drag_face(region: Node3D, side: String) -> void:
	var before: Transform3D = region.transform
	var size: Vector3 = region.size
	var face: Vector3 = region.to_global(Vector3(-0.5 * size.x, 0.0, 0.0))
	await drag_handle(region, 0, region.to_global(Vector3(3.0, 0.0, 0.0)), "planet_face_%s" % side)
	check(region.size.distance_to(Vector3(3.0 + 0.5 * size.x, size.y, size.z)) < 0.1, "%s: the dragged box has a size of %s" % [side, region.size])
	check(region.to_global(Vector3(-0.5 * region.size.x, 0.0, 0.0)).distance_to(face) < 0.01, "%s: the opposite face stays in place" % side)
	check_border(region, side + ", dragged box")
	await undo()
	check_equal([region.size, region.transform], [size, before], "%s: the drag is undone" % side)


## Water is a sphere around the planet's center. Its handle is in the middle of the view and changes the level along up.
func drag_water(side: String) -> void:
	scatter.water_level = -0.5
	scatter.water_enabled = true
	await select_node(scatter)
	await until(func() -> bool: return water_gizmos()._origin.distance_to(CENTER + up * RADIUS) < 0.05, "%s: the handle is in the middle of the view" % side)
	await picture("planet_water_%s" % side)
	await drag_mouse(on_screen(CENTER + up * (RADIUS - 0.5)), on_screen(CENTER + up * (RADIUS + 1.5)), false, false)
	await picture("planet_water_risen_%s" % side)
	await press(on_screen(CENTER + up * (RADIUS + 1.5)), false)
	check(absf(scatter.water_level - 1.5) < 0.05, "%s: the level after the drag: %f" % [side, scatter.water_level])
	await settle(scatter)
	check(instances(scatter, 0).is_empty(), "%s: all stones are under water" % side)
	await undo()
	check(absf(scatter.water_level + 0.5) < 1e-6, "%s: the drag is undone: %f" % [side, scatter.water_level])
	scatter.water_enabled = false
	await frames(2)


func water_gizmos() -> EditorNode3DGizmoPlugin:
	for gizmo: EditorNode3DGizmo in scatter.get_gizmos():
		if gizmo.get_plugin()._get_gizmo_name() == "TerrainScatter3D Water":
			return gizmo.get_plugin()
	return null


func draw_path(side: String) -> void:
	await settle(scatter)
	var tool := await start_drawing(4)
	var points: Array[Vector3] = [spot(-4.0, 0.0), spot(0.0, 0.5), spot(4.0, -0.5)]
	for point in points:
		await click_at(on_screen(point))
	await picture("planet_drawing_%s" % side)
	await key(KEY_ENTER)
	await frames(4)
	if not check(regions().size() == 1, "%s: a path: %s" % [side, tool.problem]):
		return
	var region: Node3D = regions()[0]
	check(region.get_problems().is_empty(), "%s: no problems: %s" % [side, region.get_problems()])
	var path: Path3D = region.get_node("Path3D")
	for index in 3:
		check((path.global_transform * path.curve.get_point_position(index)).distance_to(points[index]) < 0.05, "%s: point %d of the path" % [side, index])
	await settle(scatter)
	check(not instances(scatter, 0).values().any(func(at: Vector3) -> bool:
		var local := path.global_transform.affine_inverse() * at
		return path.curve.get_closest_point(local).distance_to(local) < 1.2), "%s: no stones on the path" % side)
	check_border(region, side + ", path")
	var gizmos := (region.get_gizmos()[0] as EditorNode3DGizmo).get_plugin()
	var handles: PackedVector3Array = gizmos._handles(region)
	if check(handles.size() == 1, "%s: a handle for the width" % side):
		var at := region.global_transform * handles[0]
		check(absf(at.distance_to(points[0]) - 1.5) < 0.05 and absf(altitude(at)) < 0.2, "%s: the handle is beside the path, on the ground: %s" % [side, at])
	await picture("planet_path_%s" % side)
	await drag_width(region, side)
	await undo()
	await select_node(scatter)


## The handle of a path's width is beside its first point.
func drag_width(region: Node3D, side: String) -> void:
	var handle := handle_of(region, 0)
	var start := spot(-4.0, 0.0)
	await drag_handle(region, 0, start + 2.0 * (handle - start))
	check(absf(region.width - 6.0) < 0.1, "%s: the dragged path has a width of %f" % [side, region.width])
	await undo()
	check_equal(region.width, 3.0, "%s: the drag of the width is undone" % side)


## A preset must grow on the underside.
func add_preset(side: String) -> void:
	workspace().toolbar.preset_chosen.emit("forest")
	check(scatter.layers.size() > 6, "%s: the preset's layers: %d" % [side, scatter.layers.size()])
	for layer: Resource in scatter.layers.slice(2):
		check(layer.on_surfaces and layer.max_slope_degrees <= 60.0 and layer.progressive_levels == 1, "%s: %s grows on surfaces" % [side, layer.resource_name])
	await settle(scatter)
	var problems: PackedStringArray = scatter.get_problems()
	check(not Array(problems).any(func(problem: String) -> bool: return "Spruce" in problem or "Fern" in problem), "%s: no problems of the preset: %s" % [side, problems])
	var near := 0
	for index in range(2, scatter.layers.size()):
		near += instances(scatter, index).values().filter(func(at: Vector3) -> bool: return at.distance_to(CENTER + up * RADIUS) < 8.0).size()
	check(near > 20, "%s: %d plants of the preset in the view" % [side, near])
	await undo()
	check_equal(scatter.layers.size(), 2, "%s: the preset is undone" % side)
