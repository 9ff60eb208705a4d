extends "collision_harness.gd"
## Tests that changing any single property of a layer affects its snapshot and has a visible effect. The test fails for properties that the
## snapshot does not copy or that a comparison ignores, and for properties missing from `changes`.

## Keeps half of the instances.
class HalfRule extends ScatterRule:
	func _get_densities(positions: PackedVector3Array, _normals: PackedVector3Array, _slopes: PackedFloat32Array,
			_texture_weights: PackedFloat32Array) -> PackedFloat32Array:
		var densities := PackedFloat32Array()
		densities.resize(positions.size())
		densities.fill(0.5)
		return densities


const OAKS := 0
const FERNS := 1

## The effects that changing a property can have. The first three are: tiles are regenerated, tiles are redrawn without being regenerated,
## or different tiles are visible. The remaining ones are changes of bodies, scenes, ray hits and regrowth.
const MADE := "made"
const REDRAWN := "redrawn"
const TILES := "tiles"
const BODIES := "bodies"
const SCENES := "scenes"
const HITS := "hits"
const REGROWN := "regrown"

## For each property: a value that differs from the one in `make_ferns`, followed by the effects of the change.
var changes := {
	"radius": [2.5, MADE], "progressive_levels": [2, MADE], "layer_id": [77, MADE], "density": [0.5, MADE], "on_surfaces": [true, MADE],
	"tile_size": [24.0, TILES], "view_distance": [70.0, TILES],
	"min_height": [-5.0, MADE], "max_height": [50.0, MADE], "height_falloff": [2.0, MADE],
	"density_over_height": [make_line(Vector2(-9, 0), Vector2(9, 1)), MADE],
	"min_slope_degrees": [1.0, MADE], "max_slope_degrees": [40.0, MADE], "slope_falloff_degrees": [3.0, MADE],
	"density_expression": ["slope < 45", MADE], "density_rules": [[HalfRule.new()] as Array[ScatterRule], MADE],
	"density_over_slope": [make_line(Vector2(0, 0.5), Vector2(90, 1)), MADE],
	"min_water_depth": [-1.0, MADE], "max_water_depth": [2.0, MADE], "water_depth_falloff": [3.0, MADE],
	"ground_textures": [PackedInt32Array([3]), MADE],
	"noise": [FastNoiseLite.new(), MADE], "noise_curve": [make_line(Vector2(-1, 1), Vector2(1, 0)), MADE],
	"mask": [half_mask(), MADE], "mask_texture": [picture(Color.BLUE), MADE],
	"mask_texture_rect": [Rect2(0, 0, 90, 90), MADE], "mask_texture_channel": [ScatterLayer.MASK_CHANNEL_GREEN, MADE],
	"mask_texture_edge": [ScatterLayer.MASK_EDGE_NOTHING, MADE],
	"clump_size": [9.0, MADE], "clump_coverage": [0.75, MADE], "clump_softness": [0.5, MADE], "edge_feather": [2.0, MADE],
	"spacing": [{"Oaks": 2.0} as Dictionary[String, float], MADE], "proximity_layer": ["", MADE],
	"proximity_distance": [30.0, MADE], "proximity_curve": [make_line(Vector2(0, 1), Vector2(25, 0.5)), MADE],
	"min_scale": [0.5, MADE], "max_scale": [3.0, MADE], "scale_curve": [make_line(Vector2(0, 0), Vector2(1, 1)), MADE],
	"scale_value": [value_of(ScatterValueSource.SOURCE_RANK), MADE],
	"min_yaw_degrees": [-5.0, MADE], "max_yaw_degrees": [90.0, MADE],
	"min_tilt_degrees": [1.0, MADE], "max_tilt_degrees": [9.0, MADE], "align_to_normal": [0.5, MADE],
	"rows": [ScatterRows.new(), MADE], # Without a group, the rows have no instances. See test_rows.gd.
	"height_offset": [0.5, MADE], "offset_along_normal": [0.25, MADE],
	"meshes": [[SphereMesh.new(), BoxMesh.new()] as Array[Mesh], MADE],
	"mesh_weights": [PackedFloat32Array([1.0, 4.0]), MADE], "mesh_density_expressions": [PackedStringArray(["x > 0"]), MADE],
	"use_colors": [false, MADE], "use_custom_data": [false, MADE],
	"color_value": [value_of(ScatterValueSource.SOURCE_HEIGHT, to_red()), MADE], "variation_value": [value_of(ScatterValueSource.SOURCE_RANK), MADE],
	"thin_begin": [5.0, REDRAWN], "thin_end": [60.0, REDRAWN], "thin_density": [0.25, REDRAWN],
	"thin_scale_up": [true, MADE], # Scaled-up instances also enlarge the bounding boxes of tiles.
	"material_override": [StandardMaterial3D.new(), REDRAWN],
	"cast_shadow": [GeometryInstance3D.SHADOW_CASTING_SETTING_OFF, REDRAWN],
	"gi_mode": [GeometryInstance3D.GI_MODE_DYNAMIC, REDRAWN], "render_layers": [2, REDRAWN],
	"draw_cell_size": [16.0, REDRAWN], "lod_bias": [2.0, REDRAWN], "lod_fade": [0.3, REDRAWN],
	"extra_cull_margin": [3.0, REDRAWN],
	"instance_radius": [0.3, BODIES, HITS], "instance_height": [1.0, BODIES, HITS], "regrowth_time": [0.05, REGROWN],
	"collision_shape": [ScatterLayer.COLLISION_BOX, BODIES], "collision_distance": [12.0, BODIES],
	"collision_layer": [4, BODIES], "collision_mask": [8, BODIES], "physics_material": [slippery(), BODIES],
	"spacing_fills": [true], # Without spacing, this property has no effect. See test_neighbors.gd.
	"surface_layers": [["Oaks"]], # Without on_surfaces, this property has no effect. See test_layers_on_models.gd.
	# These properties are used only in place of resources that an export has stripped. See test_stripped.gd.
	"convex_hulls": [[PackedVector3Array([Vector3.UP])]], "mask_texture_image": [Image.create_empty(2, 2, false, Image.FORMAT_R8)],
	"affect_navigation_mesh": [false], # This property is used only when a navigation mesh is baked. See test_navigation.gd.
	"scene": [scene_of(Marker3D.new()), SCENES], "scene_distance": [4.0, SCENES],
}


func value_of(source: ScatterValueSource.Source, gradient: Gradient = null) -> ScatterValueSource:
	var value := ScatterValueSource.new()
	value.source = source
	value.gradient = gradient
	return value


func half_mask() -> ScatterMask:
	var mask := ScatterMask.new()
	mask.paint(Vector2.ZERO, 20.0, 1.0, 0.5, ScatterMask.MODE_ERASE)
	return mask


## Returns a texture whose channels differ, so that each one is a different mask.
func picture(color: Color) -> ImageTexture:
	var image := Image.create_empty(2, 2, false, Image.FORMAT_RGB8)
	image.fill(Color(1.0, 0.75, 0.5))
	image.set_pixel(0, 0, color)
	return ImageTexture.create_from_image(image)


func to_red() -> Gradient:
	var gradient := Gradient.new()
	gradient.set_color(1, Color.RED)
	return gradient


func slippery() -> PhysicsMaterial:
	var material := PhysicsMaterial.new()
	material.friction = 0.125
	return material


func scene_of(node: Node3D) -> PackedScene:
	var scene := PackedScene.new()
	scene.pack(node)
	node.free()
	return scene


## Returns a layer with rules, colors, LODs, bodies and scenes, so that the properties of all of these have an effect.
func make_ferns() -> ScatterLayer:
	var layer := make_layer(3.0)
	layer.resource_name = "Ferns"
	layer.view_distance = 40.0
	layer.meshes = with_lods([BoxMesh.new(), SphereMesh.new()], [[BoxMesh.new(), null]], [20.0])
	layer.thin_begin = 10.0
	layer.thin_end = 40.0
	layer.thin_density = 0.5
	layer.noise = FastNoiseLite.new()
	layer.noise.frequency = 0.25
	layer.mask_texture = picture(Color.WHITE)
	layer.mask_texture_rect = Rect2(0, 0, 50, 50)
	layer.mask_texture_edge = ScatterLayer.MASK_EDGE_REPEAT
	layer.proximity_layer = "Oaks"
	layer.proximity_distance = 25.0
	layer.max_scale = 2.0
	layer.use_colors = true
	layer.color_value = value_of(ScatterValueSource.SOURCE_DISTANCE, Gradient.new())
	layer.color_value.layer = "Oaks"
	layer.color_value.max_value = 12.0
	layer.use_custom_data = true
	layer.variation_value = value_of(ScatterValueSource.SOURCE_NOISE)
	layer.variation_value.noise = FastNoiseLite.new()
	layer.max_tilt_degrees = 5.0
	layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
	layer.collision_distance = DISTANCE
	layer.scene = scene_of(Node3D.new())
	layer.scene_distance = 8.0
	return layer


## Returns the IDs, shapes, layers, masks and friction of all bodies, sorted.
func body_data(scatter: TerrainScatter3D) -> Array:
	var result := []
	var found := bodies(scatter)
	for id in found:
		var body := found[id]
		var shape := PhysicsServer3D.body_get_shape(body, 0)
		result.push_back([id, PhysicsServer3D.shape_get_type(shape), PhysicsServer3D.shape_get_data(shape),
				PhysicsServer3D.body_get_collision_layer(body), PhysicsServer3D.body_get_collision_mask(body),
				PhysicsServer3D.body_get_param(body, PhysicsServer3D.BODY_PARAM_FRICTION)])
	result.sort()
	return result


func hits(scatter: TerrainScatter3D) -> Array:
	var result := []
	for step in 40:
		var from := Vector3(-30.0, 1.5 if step % 2 else 0.25, step - 20.0)
		var hit := scatter.query_ray(from, from + Vector3(60.0, 0.0, 0.0))
		result.push_back(hit.hit_position if hit != null else null)
	return result


func seen(scatter: TerrainScatter3D) -> Dictionary:
	var tiles := scatter.get_shown_tiles(scatter.layers[FERNS])
	tiles.sort()
	var scenes := scatter.get_children(true).map(func(child: Node) -> String: return child.get_class())
	return {
		MADE: scatter.get_stats()["tiles_made"], REDRAWN: scatter.get_stats()["redrawn"], TILES: tiles,
		BODIES: body_data(scatter), SCENES: scenes, HITS: hits(scatter),
	}


## Removes an instance and returns whether it regrows within 0.2 s.
func regrows(scatter: TerrainScatter3D) -> bool:
	var id := 0
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[FERNS]):
		for ids: PackedInt64Array in tile_ids(scatter, FERNS, tile):
			id = ids[0] if id == 0 and not ids.is_empty() else id
	check(scatter.remove_instance(id), "an instance is removed")
	await create_timer(0.2).timeout
	var back := scatter.has_instance(id)
	scatter.restore_instance(id)
	return back


func stored_properties() -> PackedStringArray:
	var result: PackedStringArray
	for property: Dictionary in ClassDB.class_get_property_list("ScatterLayer", true):
		if property["usage"] & PROPERTY_USAGE_STORAGE:
			result.push_back(property["name"])
	return result


func test_effects_of_every_property() -> void:
	var oaks := make_layer(8.0)
	oaks.resource_name = "Oaks"
	var ferns := make_ferns()
	var scatter := make_solid([oaks, ferns])
	await settle(scatter)
	check(body_data(scatter).size() > 10 and scatter.get_stats()["scenes"] > 3, "bodies and scenes are near: %s" % scatter.get_stats())
	check(not await regrows(scatter), "nothing regrows by default")
	for property in stored_properties():
		if not check(changes.has(property), "`changes` has no line for %s" % property):
			continue
		var change: Array = changes[property]
		var expected_effects := change.slice(1)
		var value: Variant = ferns.get(property)
		await settle(scatter)
		await frames(3)
		var before := seen(scatter)
		ferns.set(property, change[0])
		check(ferns.get(property) != value, "%s has a new value" % property)
		await settle(scatter)
		await frames(3)
		var after := seen(scatter)
		for effect: String in before:
			if effect in expected_effects:
				check(before[effect] != after[effect], "%s changes with %s" % [effect, property])
			elif effect == MADE and not TILES in expected_effects:
				check_equal(after[effect], before[effect], "regenerated tiles for %s" % property)
		check_equal(await regrows(scatter) if REGROWN in expected_effects else true, true, "it regrows: %s" % property)
		ferns.set(property, value)
	for property: String in changes:
		check(property in stored_properties(), "there is no property %s" % property)


## Changing a placement property does not redraw tiles that are already visible.
func test_placement_properties_redraw_nothing() -> void:
	var ferns := make_ferns()
	var scatter := make_solid([ferns])
	await settle(scatter)
	for property: String in ["max_height", "max_tilt_degrees", "edge_feather", "scene_distance", "regrowth_time"]:
		var before: int = scatter.get_stats()["redrawn"]
		ferns.set(property, changes[property][0])
		await settle(scatter)
		check_equal(scatter.get_stats()["redrawn"], before, "tiles drawn differently for a new %s" % property)
