extends "picture_harness.gd"
## Base class for the draw cell tests: a forest on an island, and the multimeshes that draw it.

const TILE := 128.0
const CELL := 32.0
const REACH := 0.8660254 ## The distance in meters from the center of a 1 m cube to a corner.
const WHOLE := 32        ## The number of multimeshes without draw cells: 16 tiles with two meshes each.


## Ground in a single square. All instances on it stay visible wherever the viewer moves.
class Island extends ScatterGround:
	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(0.0 if absf(at.x) < 256.0 and absf(at.y) < 256.0 else NAN)
		return heights

	func _is_thread_safe() -> bool:
		return true


## Returns a layer with two meshes, each with a coarser LOD from 60 m on.
func make_forest() -> ScatterLayer:
	var layer := make_layer(4.0)
	layer.tile_size = TILE
	layer.view_distance = 600.0
	layer.draw_cell_size = CELL
	layer.meshes = with_lods([BoxMesh.new(), BoxMesh.new()], [[BoxMesh.new(), BoxMesh.new()]], [60.0])
	return layer


func multimeshes_of(scatter: TerrainScatter3D, tile: Vector2i) -> Array:
	var displayed_tile := scatter.get_tile(scatter.layers[0], tile)
	return range(displayed_tile.get_mesh_count()).map(displayed_tile.get_multimeshes)


func is_in_cells(scatter: TerrainScatter3D, tile: Vector2i) -> bool:
	return multimeshes_of(scatter, tile).any(func(of_mesh: Array) -> bool: return of_mesh.size() > 1)


func tiles_in_cells(scatter: TerrainScatter3D) -> Array[Vector2i]:
	return scatter.get_shown_tiles(scatter.layers[0]).filter(func(tile: Vector2i) -> bool: return is_in_cells(scatter, tile))


func multimesh_count(scatter: TerrainScatter3D) -> int:
	var count := 0
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		for of_mesh: Array in multimeshes_of(scatter, tile):
			count += of_mesh.size()
	return count


func visible_count(multimesh: RID) -> int:
	var count := RenderingServer.multimesh_get_visible_instances(multimesh)
	return RenderingServer.multimesh_get_instance_count(multimesh) if count < 0 else count


func drawn_of_all(scatter: TerrainScatter3D) -> int:
	var sum := 0
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		for of_mesh: Array in multimeshes_of(scatter, tile):
			for multimesh: RID in of_mesh:
				sum += visible_count(multimesh)
	return sum


## Returns the digests of the island's visible tiles. Skips the empty tiles around it, which change as the viewer moves.
func island_digests(scatter: TerrainScatter3D) -> Dictionary:
	var result := {}
	for tile in island_tiles():
		result[tile] = scatter.get_tile(scatter.layers[0], tile).get_digest()
	return result


func island_tiles() -> Array[Vector2i]:
	var tiles: Array[Vector2i] = []
	for x in range(-2, 2):
		for y in range(-2, 2):
			tiles.push_back(Vector2i(x, y))
	return tiles


## Returns the digests of the island's tiles as `build_rect` builds them, without drawing them.
func built_digests(scatter: TerrainScatter3D) -> Dictionary:
	var result := {}
	for tile in island_tiles():
		result[tile] = scatter.build_rect(scatter.layers[0], Rect2(Vector2(tile) * TILE, Vector2.ONE * TILE)).get_digest()
	check(result.values().all(func(digest: int) -> bool: return digest != 0), "each tile of the island has instances to compare")
	return result


## Returns a box around the instances of a buffer, enlarged by the reach of their meshes.
func box_of(buffer: PackedFloat32Array, stride: int, origin: Vector3) -> AABB:
	var box := AABB(Vector3(buffer[3], buffer[7], buffer[11]), Vector3.ZERO)
	for at in range(0, buffer.size(), stride):
		box = box.expand(Vector3(buffer[at + 3], buffer[at + 7], buffer[at + 11]))
	return AABB(box.position + origin, box.size).grow(REACH)


func distance_to(box: AABB, at: Vector3) -> float:
	return at.distance_to(at.clamp(box.position, box.end))
