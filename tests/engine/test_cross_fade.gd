extends "picture_harness.gd"
## Tests cross-fading LODs, seen from the viewer's position, with each of the three renderers.

const FLIGHT := 60       ## The number of frames per flight.
const STEP := 0.4        ## The distance in meters between two frames.
const MOST_CHANGE := 0.2 ## The limit for the brightness change (0 to 1) of an 8 by 8 block between two frames.

var camera: Camera3D


## Returns a material that adds light, so that anything drawn twice is brighter. If `adds` is false, the material is opaque.
func material(light: float, fades := true, adds := true) -> ShaderMaterial:
	var shader := Shader.new()
	shader.code = """
		shader_type spatial;
		render_mode unshaded, cull_disabled, shadows_disabled%s;
		#include "res://addons/thicket/shaders/scatter_fade.gdshaderinc"
		uniform float light;
		varying flat vec2 fade;
		void vertex() {
			fade = scatter_fade_shares(CUSTOM3, MODEL_MATRIX[3].xyz, MAIN_CAM_INV_VIEW_MATRIX[3].xyz);
			VERTEX = scatter_fade_collapsed(VERTEX, fade);
		}
		void fragment() {
			if (scatter_fade_hides(fade, FRAGCOORD.xy)) {
				discard;
			}
			ALBEDO = vec3(light);
		}
	""" % (", blend_add, depth_draw_never" if adds else "")
	var new_material := ShaderMaterial.new()
	new_material.shader = shader
	new_material.set_shader_parameter(&"light", light)
	if not fades:
		new_material.set_shader_parameter(&"scatter_cross_fade", false)
	return new_material


func plane(of: Material, size := 3.0) -> PlaneMesh:
	var mesh := PlaneMesh.new()
	mesh.size = Vector2.ONE * size
	mesh.material = of
	return mesh


func make_wood(lods: Array[Mesh], distances: Array) -> ScatterLayer:
	var layer := make_layer(4.0)
	layer.tile_size = 64.0
	layer.draw_cell_size = 16.0
	layer.view_distance = 300.0
	layer.meshes = with_lods([lods[0]], lods.slice(1).map(func(lod: Mesh) -> Array: return [lod]), distances)
	return layer


## Moves the camera to a position on the flight path.
func fly_to(index: int) -> void:
	camera.position = Vector3(7.0 + STEP * index, 12.0, 3.0)


func stage() -> void:
	root.size = Vector2i(160, 120)
	root.msaa_3d = Viewport.MSAA_DISABLED
	var environment := Environment.new()
	environment.background_mode = Environment.BG_COLOR
	environment.background_color = Color.BLACK
	camera = Camera3D.new()
	camera.environment = environment
	camera.far = 200.0
	camera.rotation_degrees = Vector3(-22.0, -90.0, 0.0)
	root.add_child(camera)
	camera.make_current()
	fly_to(0)


func picture() -> Image:
	await frames(1)
	await RenderingServer.frame_post_draw
	var image := root.get_texture().get_image()
	image.convert(Image.FORMAT_L8)
	return image


func flight_of(layer: ScatterLayer) -> Array[Image]:
	fly_to(0)
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), camera)
	await settle(scatter)
	var pictures: Array[Image] = []
	for index in FLIGHT:
		fly_to(index)
		pictures.append(await picture())
	scatter.queue_free()
	await frames(2)
	return pictures


## Returns the largest change in an 8 by 8 block's mean between two successive frames.
func largest_change(pictures: Array[Image]) -> float:
	var largest := 0.0
	var before: Image = null
	for image in pictures:
		var blocks := image.duplicate() as Image
		for half in 3:
			blocks.shrink_x2()
		for x in 20:
			for y in 15:
				if before != null:
					largest = maxf(largest, absf(blocks.get_pixel(x, y).r - before.get_pixel(x, y).r))
		before = blocks
	return largest


func pixels_that_differ(a: Image, b: Image) -> int:
	var one := a.get_data()
	var other := b.get_data()
	var count := 0
	for index in one.size():
		count += int(absi(one[index] - other[index]) > 2)
	return count


## In every frame of a flight, three identical LODs look like one mesh, because nothing is drawn twice or missing.
func test_every_pixel_is_drawn_once() -> void:
	stage()
	var light := material(0.3)
	var alone: Array[Image] = await flight_of(make_wood([plane(light)], []))
	var lods: Array[Mesh] = [plane(light), plane(light), plane(light)]
	var fading: Array[Image] = await flight_of(make_wood(lods, [25.0, 50.0]))
	check(alone[0].get_data().count(0) < alone[0].get_data().size() * 3 / 4, "some pixels are lit")
	var worst := 0
	for index in FLIGHT:
		worst = maxi(worst, pixels_that_differ(alone[index], fading[index]))
	check(worst <= 4, "at most %d of %d pixels differ" % [worst, alone[0].get_data().size()])


func test_a_fade_prevents_popping() -> void:
	stage()
	# The planes cover the ground without gaps, so movement alone changes little. Each has a different height, so the drawing order
	# does not matter.
	var lods: Array[Mesh] = [plane(material(0.9, true, false), 12.0), plane(material(0.1, true, false), 12.0)]
	for lod: PlaneMesh in lods:
		lod.center_offset.y = 1.0
	var layer := make_wood(lods, [40.0])
	layer.min_scale = 0.8
	layer.max_scale = 1.2
	layer.lod_fade = 0.4
	var faded := largest_change(await flight_of(layer))
	layer.lod_fade = 0.0
	var sharp := largest_change(await flight_of(layer))
	check(faded < MOST_CHANGE, "a block changes by at most %.2f" % faded)
	check(sharp > 2.5 * MOST_CHANGE, "without a fade a block changes by %.2f" % sharp)


## Moves the viewer away, but not the camera, which is not a viewer. The fade depends on the distance from the viewer.
func test_instances_fade_at_the_view_distance() -> void:
	stage()
	var viewer := make_viewer()
	camera.rotation_degrees.x = -90.0
	camera.position = Vector3(0.0, 70.0, 0.0)
	var layer := make_wood([plane(material(0.5), 4.0)], [])
	layer.view_distance = 90.0
	layer.lod_fade = 0.5
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	var lit := {}
	for away: float in [0.0, 60.0, 80.0, 88.0, 110.0]:
		viewer.position.x = away
		await settle(scatter)
		var seen := (await picture()).get_region(Rect2i(75, 40, 10, 40))
		lit[away] = seen.get_data().size() - seen.get_data().count(0)
	check(lit[0.0] > 60, "%d pixels nearby" % lit[0.0])
	check(lit[60.0] < 0.8 * lit[0.0], "they fade gradually: %s" % lit)
	check(lit[80.0] < 0.5 * lit[0.0] and lit[80.0] < lit[60.0], "they fade gradually: %s" % lit)
	check(lit[88.0] < 0.25 * lit[0.0] and lit[88.0] < lit[80.0], "almost invisible: %s" % lit)
	check(lit[60.0] > 0 and lit[80.0] > 0, "they are still visible within the view distance: %s" % lit)
	check_equal(lit[110.0], 0, "pixels beyond the view distance")


## Two LODs use a second multimesh only where they cross-fade. Materials that cannot fade need none.
func test_only_fading_lods_are_drawn_twice() -> void:
	stage()
	var counts := {}
	for kind: String in ["fades", "disabled", "unsupported", "no fade"]:
		var of: Material = material(0.3, kind != "disabled")
		if kind == "unsupported":
			of = StandardMaterial3D.new()
		var layer := make_wood([plane(of), plane(of)], [40.0])
		layer.lod_fade = 0.0 if kind == "no fade" else 0.2
		layer.view_distance = 100.0
		var scatter := make_scatter([layer], ScatterGroundFlat.new(), camera)
		await settle(scatter)
		counts[kind] = scatter.get_stats()["multimeshes"]
		if kind == "fades":
			layer.lod_fade = 0.0
			await settle(scatter)
			check(scatter.get_stats()["multimeshes"] < counts[kind], "without a fade the second multimeshes are removed")
			layer.lod_fade = 0.2
			await settle(scatter)
			var again: int = scatter.get_stats()["multimeshes"] - counts[kind]
			check(absi(again) <= 8, "with a fade the second multimeshes return, except for %d at the limits of a fade" % again)
			scatter.max_multimeshes = 30
			await settle(scatter)
			check(scatter.get_stats()["multimeshes"] <= 30, "never more than max_multimeshes")
		scatter.queue_free()
		await frames(2)
	check(counts["fades"] > counts["unsupported"] + 8, "more multimeshes with a fade: %s" % counts)
	check(counts["fades"] < 2 * counts["unsupported"], "cells without a fade have no second multimesh: %s" % counts)
	check_equal(counts["disabled"], counts["unsupported"], "multimeshes if scatter_cross_fade is off")
	check_equal(counts["no fade"], counts["unsupported"], "multimeshes with lod_fade 0")


## A game's changes affect both LODs, and a hidden node draws neither.
func test_changes_reach_both_lods() -> void:
	stage()
	camera.rotation_degrees.x = -90.0
	camera.position = Vector3(0.0, 35.0, 0.0)
	var light := material(0.5)
	var layer := make_wood([plane(light), plane(light)], [40.0])
	layer.lod_fade = 0.4
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), camera)
	await settle(scatter)
	var before := await picture()
	check(before.get_data().count(0) < before.get_data().size(), "some pixels are lit")
	scatter.remove_in_sphere(Vector3.ZERO, 80.0)
	await frames(4)
	var after := await picture()
	check_equal(after.get_data().count(0), after.get_data().size(), "dark pixels after all were removed")
	scatter.state.clear()
	await settle(scatter)
	check(pixels_that_differ(await picture(), before) <= 4, "the image is the same after all were restored")
	scatter.visible = false
	await frames(2)
	var hidden := await picture()
	check_equal(hidden.get_data().count(0), hidden.get_data().size(), "dark pixels of a hidden node")
	scatter.visible = true
	await frames(2)
	check(pixels_that_differ(await picture(), before) <= 4, "the image is the same once the node is visible again")


## A mesh that uses CUSTOM3 for its own data gets no copy that fades.
func test_a_mesh_with_its_own_custom_data_does_not_fade() -> void:
	stage()
	var arrays := plane(null).get_mesh_arrays()
	var floats := PackedFloat32Array()
	floats.resize(16)
	arrays[Mesh.ARRAY_CUSTOM3] = floats
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays, [], {},
			Mesh.ARRAY_CUSTOM_RGBA_FLOAT << Mesh.ARRAY_FORMAT_CUSTOM3_SHIFT)
	mesh.surface_set_material(0, material(0.3))
	var layer := make_wood([mesh, mesh.duplicate()], [40.0])
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), camera)
	await settle(scatter)
	var drawn := {}
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		for multimesh: RID in scatter.get_tile(scatter.layers[0], tile).get_multimeshes(0):
			drawn[RenderingServer.multimesh_get_mesh(multimesh)] = true
	check_equal(drawn.size(), 2, "the meshes that are drawn")
	check(drawn.has(mesh.get_rid()), "the mesh itself")


func test_a_bad_fade_is_rejected() -> void:
	var layer := make_layer()
	layer.lod_fade = 0.3
	for bad: float in [-0.1, 0.6, NAN, INF]:
		layer.lod_fade = bad
		check_error(["lod_fade"], "lod_fade %f" % bad)
	check(absf(layer.lod_fade - 0.3) < 1e-6, "the last valid value stays")


## If a model's second LOD has a density below 1, that fraction of its instances is drawn, and the others fade out.
func test_a_lod_draws_its_density() -> void:
	stage()
	var mesh := plane(material(0.5))
	var model := ScatterModel.new()
	for density: float in [1.0, 0.25]:
		var lod := ScatterLod.new()
		lod.mesh = mesh
		lod.density = density
		lod.distance = 0.0 if density == 1.0 else 40.0
		model.lods = model.lods + ([lod] as Array[ScatterLod])
	model.lods[1].density = 1.5
	check_error(["density", "1.5"], "a density above 1")
	check_equal(model.lods[1].density, 0.25, "the last valid value")
	var layer := make_wood([mesh], [])
	layer.meshes = [model]
	layer.view_distance = 100.0
	camera.rotation_degrees.x = -90.0
	for fade: float in [0.0, 0.3]:
		layer.lod_fade = fade
		camera.position = Vector3(0.0, 20.0, 0.0)
		var scatter := make_scatter([layer], ScatterGroundFlat.new(), camera)
		await settle(scatter)
		var lit := func(image: Image) -> int: return image.get_data().size() - image.get_data().count(0)
		var near: int = lit.call(await picture())
		check(near > 1000, "%d pixels nearby" % near)
		camera.position.y = 60.0
		await settle(scatter)
		var far: float = lit.call(await picture()) * 9.0 # Scaled to the apparent size nearby.
		layer.meshes = [mesh]
		await settle(scatter)
		var all: float = lit.call(await picture()) * 9.0
		check(absf(far / all - 0.25) < 0.08, "fade %.1f: %.2f of the pixels far away" % [fade, far / all])
		layer.meshes = [model]
		await settle(scatter)
		check(scatter.get_stats()["drawn"] < 0.4 * scatter.get_stats()["instances"], "few are drawn: %s" % scatter.get_stats())
		scatter.queue_free()
		await frames(2)


## Returns the meshes of all visible multimeshes, as a set.
func drawn_meshes(scatter: TerrainScatter3D) -> Dictionary:
	var drawn := {}
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		for multimesh: RID in scatter.get_tile(scatter.layers[0], tile).get_multimeshes(0):
			drawn[RenderingServer.multimesh_get_mesh(multimesh)] = true
	return drawn


## Unrelated changes reuse the copies of meshes that fade, because making them is expensive.
func test_copies_that_fade_are_reused() -> void:
	stage()
	var light := material(0.5)
	var layer := make_wood([plane(light), plane(light)], [40.0])
	layer.lod_fade = 0.2
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), camera)
	await settle(scatter)
	var before := drawn_meshes(scatter)
	check(before.size() > 2, "%d meshes, including copies that fade" % before.size())
	layer.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	await settle(scatter)
	check_equal(drawn_meshes(scatter), before, "the same meshes after an unrelated change")
	layer.lod_fade = 0.25
	await settle(scatter)
	check(drawn_meshes(scatter) != before, "a new fade needs new copies")
	scatter.free()
