@tool
extends RefCounted
## Converts instances of a scene or a file to hand-placed instances of a scatter. It reads [MultiMeshInstance3D]s, including the output of
## ProtonScatter and of this add-on's bakes. It also reads the scene copies that ProtonScatter creates without instancing, the instances of a
## Terrain3D, and tables of transforms. Transforms are converted to world space in single precision. Those of nodes at the origin keep their exact
## values. The imported nodes are not changed: hide or free them afterward.
##
## It also works without the editor:
## [codeblock]
## const ImportInstances := preload("res://addons/thicket/import_instances.gd")
## ImportInstances.from_node($TerrainScatter3D, null, $OldTrees)
## ImportInstances.from_csv($TerrainScatter3D, "Rocks", "res://rocks.csv")
## [/codeblock]
## An import either succeeds completely or leaves the scatter unchanged. An error names the part that cannot be imported.

const Table := preload("res://addons/thicket/transform_table.gd")

## The number of floats in a transform: the rows of its basis, each followed by a coordinate of the origin, as in [member MultiMesh.buffer].
const FLOATS := 12
## The name of the node under which ProtonScatter puts its output.
const PROTON_OUTPUT := "ScatterOutput"
## The minimum radius of a new layer, in meters. Such a layer contains only hand-placed instances, and all of its generated points are discarded. A
## larger radius means fewer points to discard.
const LEAST_RADIUS := 2.0


## Instances of one mesh or scene.
class Batch:
	var mesh: Resource ## The mesh or scene to place; null for the first mesh of the target layer.
	var name := ""
	var appearance: Dictionary[StringName, Variant] = {} ## The values of the layer properties with which the instances are drawn.
	var transforms := PackedFloat32Array()

	func size() -> int:
		@warning_ignore("integer_division")
		return transforms.size() / FLOATS


## The instances of a node or a file, and a message for each part that cannot be imported.
class Reading:
	var batches: Array[Batch] = []
	var problems := PackedStringArray()

	func size() -> int:
		var sum := 0
		for batch in batches:
			sum += batch.size()
		return sum

	## Returns the batch for a mesh with these layer properties, adding it if necessary.
	func batch_of(mesh: Resource, name: String, appearance: Dictionary[StringName, Variant]) -> Batch:
		for batch in batches:
			if batch.mesh == mesh and batch.appearance == appearance:
				return batch
		var batch := Batch.new()
		batch.mesh = mesh
		batch.name = name
		batch.appearance = appearance
		batches.append(batch)
		return batch


## Imports the instances of a node and of all its descendants into [param layer], a [ScatterLayer] or its name. Instances whose mesh the layer does not
## have get its first mesh. If [param layer] is [code]null[/code], the instances of each mesh are added to the layer that has the mesh and the same
## material override. If there is none, a new layer is created. Returns the number of placed instances. On failure, prints errors and returns 0.
static func from_node(scatter: Node3D, layer: Variant, node: Node) -> int:
	return _import(scatter, layer, read_node(node))


## Imports a table with a line for each instance into [param layer], which must not be [code]null[/code]. All instances get the layer's first
## mesh. [code]transform_table.gd[/code] describes the columns. Returns the number of placed instances. On failure, prints errors and returns 0.
static func from_csv(scatter: Node3D, layer: Variant, path: String) -> int:
	return _import(scatter, layer, read_csv(path))


## Returns the instances of a node and of all its descendants. Errors are in [member Reading.problems].
static func read_node(node: Node) -> Reading:
	var reading := Reading.new()
	if node == null:
		reading.problems.append("There is no node to import from: node is null.")
		return reading
	_read_tree(node, reading)
	reading.batches = reading.batches.filter(func(batch: Batch) -> bool: return batch.size() > 0)
	if reading.size() == 0 and reading.problems.is_empty():
		reading.problems.append(("%s has no instances: it has no MultiMeshInstance3D, no output of ProtonScatter and no Terrain3D. "
				+ "Choose a node that has one, or build its instances first.") % node.name)
	return reading


## Returns the instances in a table. Errors are in [member Reading.problems].
static func read_csv(path: String) -> Reading:
	var reading := Reading.new()
	var file := FileAccess.open(path, FileAccess.READ)
	if file == null:
		reading.problems.append("%s cannot be opened: %s. Check its path." % [path, error_string(FileAccess.get_open_error())])
		return reading
	var table := Table.new()
	table.read(file.get_as_text())
	for problem in table.problems:
		reading.problems.append("%s, %s" % [path, problem])
	var batch := reading.batch_of(null, path.get_file().get_basename(), {})
	batch.transforms = table.transforms
	if table.problems.is_empty() and batch.size() == 0:
		reading.problems.append("%s has no transforms: it needs a line of 3, 6, 7, 9 or 12 numbers for each instance." % path)
	return reading


## Places the instances that were read and adds missing layers. Returns the IDs of the instances. On an error, leaves
## the scatter unchanged and returns no IDs.
static func place(scatter: Node3D, layer: Variant, reading: Reading) -> PackedInt64Array:
	var old_layers: Array = scatter.get(&"layers")
	var layers := old_layers.duplicate()
	var targets: Array[Variant] = []
	for batch in reading.batches:
		targets.append(layer if layer != null else _layer_for(batch, layers))
	if layers != old_layers:
		scatter.set(&"layers", layers)
	var ids := PackedInt64Array()
	for index in reading.batches.size():
		var batch := reading.batches[index]
		var meshes := PackedInt32Array()
		meshes.resize(batch.size())
		meshes.fill(_mesh_index(scatter, targets[index], batch.mesh))
		var new_ids: PackedInt64Array = scatter.call(&"add_instances", targets[index], batch.transforms, meshes)
		ids.append_array(new_ids)
		if new_ids.size() < batch.size():
			scatter.call(&"remove_instances", ids)
			scatter.set(&"layers", old_layers)
			return PackedInt64Array()
	return ids


## Returns the layer in a list that has the batch's mesh and material override. If there is none, appends a new layer and returns it.
static func _layer_for(batch: Batch, r_layers: Array) -> Resource:
	for layer: Resource in r_layers:
		if layer != null and (layer.get(&"meshes") as Array).has(batch.mesh) and \
				layer.get(&"material_override") == batch.appearance.get(&"material_override"):
			return layer
	var layer := ClassDB.instantiate(&"ScatterLayer") as Resource
	var taken := PackedStringArray()
	for other: Resource in r_layers:
		if other != null:
			taken.append(other.resource_name)
	layer.resource_name = layer.call(&"find_free_name", batch.name, taken)
	layer.set(&"meshes", [batch.mesh])
	for property: StringName in batch.appearance:
		layer.set(property, batch.appearance[property])
	layer.call(&"fit_to_meshes")
	layer.set(&"radius", maxf(layer.get(&"radius"), LEAST_RADIUS))
	layer.set(&"density", 0.0)
	r_layers.append(layer)
	return layer


## Returns the index of a mesh in a layer, or 0 if the layer does not have it.
static func _mesh_index(scatter: Node3D, layer: Variant, mesh: Resource) -> int:
	var layers: Array = scatter.get(&"layers")
	var target_layer: Resource = null
	if layer is Resource:
		target_layer = layer
	else:
		for candidate: Resource in layers:
			target_layer = candidate if target_layer == null and candidate != null and candidate.resource_name == str(layer) else target_layer
	return maxi((target_layer.get(&"meshes") as Array).find(mesh), 0) if target_layer != null else 0


static func _import(scatter: Node3D, layer: Variant, reading: Reading) -> int:
	if layer == null and reading.batches.any(func(batch: Batch) -> bool: return batch.mesh == null):
		reading.problems.append("A table does not name meshes: set layer to the layer for its instances, as an object or a name.")
	for problem in reading.problems:
		push_error("Import of instances: " + problem)
	return place(scatter, layer, reading).size() if reading.problems.is_empty() else 0


static func _read_tree(node: Node, r_reading: Reading) -> void:
	if node is MultiMeshInstance3D:
		_read_multimesh(node as MultiMeshInstance3D, r_reading)
	if is_terrain_3d(node):
		_read_terrain_3d(node, r_reading)
		return # The node's children draw the same instances.
	for child in node.get_children():
		if node.name == PROTON_OUTPUT and not child is MultiMeshInstance3D:
			_read_proton_item(child, r_reading)
		else:
			_read_tree(child, r_reading)


static func _read_multimesh(node: MultiMeshInstance3D, r_reading: Reading) -> void:
	var multimesh := node.multimesh
	if multimesh == null or multimesh.instance_count == 0 or multimesh.visible_instance_count == 0:
		return
	if multimesh.mesh == null:
		r_reading.problems.append("%s has no mesh: set the mesh of its multimesh." % node.name)
	elif multimesh.transform_format != MultiMesh.TRANSFORM_3D:
		r_reading.problems.append("%s has transforms in two dimensions: its multimesh must have the transform_format TRANSFORM_3D." % node.name)
	else:
		var name := _name_of(multimesh.mesh, node)
		_append(node, _buffer_of(multimesh), r_reading.batch_of(multimesh.mesh, name, _appearance_of(node)))


## Returns the name for a new layer: the name of the mesh's file, otherwise of the mesh, otherwise of the node. A
## generated name is replaced by the name of the node's parent.
static func _name_of(mesh: Resource, node: Node) -> String:
	if not mesh.resource_path.is_empty() and not "::" in mesh.resource_path:
		return mesh.resource_path.get_file().get_basename()
	var name := mesh.resource_name if not mesh.resource_name.is_empty() else String(node.name)
	# Nodes with a generated name, such as ProtonScatter's, all have the same name, but the names of their parents differ.
	var nameless := name.begins_with(node.get_class()) or name.begins_with("@" + node.get_class())
	return String(node.get_parent().name) if nameless and node.get_parent() != null else name


## Returns the geometry properties that differ from their defaults. Keys are the names of the layer's properties.
static func _appearance_of(node: GeometryInstance3D) -> Dictionary[StringName, Variant]:
	var appearance: Dictionary[StringName, Variant] = {}
	var layer := ClassDB.instantiate(&"ScatterLayer") as Resource
	var properties: Dictionary = layer.call(&"get_geometry_properties")
	for property: StringName in properties:
		var value: Variant = node.get(properties[property])
		if value != ClassDB.class_get_property_default_value(node.get_class(), properties[property]):
			appearance[property] = value
	return appearance


## Returns the transforms of a multimesh, without colors and custom data.
static func _buffer_of(multimesh: MultiMesh) -> PackedFloat32Array:
	var count := multimesh.visible_instance_count if multimesh.visible_instance_count >= 0 else multimesh.instance_count
	var stride := FLOATS + 4 * int(multimesh.use_colors) + 4 * int(multimesh.use_custom_data)
	var buffer := multimesh.buffer
	var result := PackedFloat32Array()
	if buffer.size() < count * stride: # The dummy renderer does not keep the buffer.
		for index in count:
			_append_transform(multimesh.get_instance_transform(index), result)
	elif stride == FLOATS:
		result = buffer.slice(0, count * FLOATS)
	else:
		for index in count:
			result.append_array(buffer.slice(index * stride, index * stride + FLOATS))
	return result


## Adds transforms to a batch, converted from a node's space to world space.
static func _append(node: Node3D, transforms: PackedFloat32Array, r_batch: Batch) -> void:
	var space := _space_of(node)
	if space == Transform3D.IDENTITY:
		r_batch.transforms.append_array(transforms)
		return
	for offset in range(0, transforms.size(), FLOATS):
		_append_transform(space * Transform3D(
				Vector3(transforms[offset], transforms[offset + 4], transforms[offset + 8]),
				Vector3(transforms[offset + 1], transforms[offset + 5], transforms[offset + 9]),
				Vector3(transforms[offset + 2], transforms[offset + 6], transforms[offset + 10]),
				Vector3(transforms[offset + 3], transforms[offset + 7], transforms[offset + 11])), r_batch.transforms)


static func _append_transform(transform: Transform3D, r_floats: PackedFloat32Array) -> void:
	var x := transform.basis.x
	var y := transform.basis.y
	var z := transform.basis.z
	var origin := transform.origin
	r_floats.append_array(PackedFloat32Array([
		x.x, y.x, z.x, origin.x, x.y, y.y, z.y, origin.y, x.z, y.z, z.z, origin.z,
	]))


## Returns the transform from a node's space to world space. The node may be outside of the tree.
static func _space_of(node: Node) -> Transform3D:
	if not node is Node3D:
		return Transform3D.IDENTITY
	var node_3d := node as Node3D
	if node_3d.is_inside_tree():
		return node_3d.global_transform
	var parent := node_3d.get_parent()
	return node_3d.transform if parent == null or node_3d.top_level else _space_of(parent) * node_3d.transform


## Reads an item of ProtonScatter: multimeshes, possibly with bodies, or copies of a scene.
static func _read_proton_item(item: Node, r_reading: Reading) -> void:
	var has_multimesh := false
	for child in item.get_children():
		has_multimesh = has_multimesh or child is MultiMeshInstance3D
		if child is GPUParticles3D:
			r_reading.problems.append("%s is made of particles, which do not keep transforms: set its render mode in ProtonScatter to Use Instancing, and rebuild." % item.name)
			return
	for child in item.get_children():
		if has_multimesh:
			_read_tree(child, r_reading)
		elif child is Node3D:
			_read_scene_copy(child as Node3D, item.name, r_reading)


## Reads a node as one instance of its scene. If the node is not an instanced scene, reads each mesh in it as an instance.
static func _read_scene_copy(node: Node3D, item_name: String, r_reading: Reading) -> void:
	if not node.scene_file_path.is_empty():
		var scene := load(node.scene_file_path) as PackedScene
		if scene == null:
			r_reading.problems.append("%s cannot be loaded. See the Output panel for details." % node.scene_file_path)
			return
		_append_transform(_space_of(node), r_reading.batch_of(scene, item_name, {}).transforms)
		return
	var meshes := node.find_children("*", "MeshInstance3D", true, false)
	if node is MeshInstance3D:
		meshes.push_front(node)
	for instance: MeshInstance3D in meshes:
		if instance.mesh != null:
			_append_transform(_space_of(instance), r_reading.batch_of(instance.mesh, item_name, _appearance_of(instance)).transforms)


## Returns true if a node stores instances like Terrain3D does.
static func is_terrain_3d(node: Node) -> bool:
	var data: Variant = node.get(&"data")
	var assets: Variant = node.get(&"assets")
	return data is Object and is_instance_valid(data) and data.has_method(&"get_region_locations") and data.has_method(&"get_region") \
			and assets is Object and is_instance_valid(assets) and assets.has_method(&"get_mesh_asset")


## Reads the instances of a Terrain3D. Each of its regions stores transforms relative to the region's corner, colors,
## and a change flag for each mesh and cell.
static func _read_terrain_3d(terrain: Node, r_reading: Reading) -> void:
	var data: Object = terrain.get(&"data")
	var spacing: Variant = terrain.get(&"vertex_spacing")
	for location: Vector2i in data.call(&"get_region_locations"):
		var region: Object = data.call(&"get_region", location)
		if region == null:
			continue
		var region_size: float = float(region.get(&"region_size")) * (float(spacing) if spacing is float else 1.0)
		var corner := Vector3(location.x * region_size, 0.0, location.y * region_size)
		var instances: Dictionary = region.get(&"instances")
		for mesh_id: int in instances:
			var batch := _terrain_3d_batch(terrain, mesh_id, r_reading)
			if batch == null:
				return
			var cells: Dictionary = instances[mesh_id]
			for cell: Variant in cells:
				for transform: Transform3D in cells[cell][0]:
					_append_transform(Transform3D(transform.basis, transform.origin + corner), batch.transforms)


static func _terrain_3d_batch(terrain: Node, mesh_id: int, r_reading: Reading) -> Batch:
	var asset: Object = (terrain.get(&"assets") as Object).call(&"get_mesh_asset", mesh_id)
	var mesh: Mesh = asset.call(&"get_mesh", 0) if asset != null else null
	if mesh == null:
		r_reading.problems.append("%s has instances of mesh %d, which its assets do not contain: add the mesh, or clear its instances." % [terrain.name, mesh_id])
		return null
	var appearance: Dictionary[StringName, Variant] = {}
	if asset.get(&"material_override") != null:
		appearance[&"material_override"] = asset.get(&"material_override")
	var name: Variant = asset.get(&"name")
	return r_reading.batch_of(mesh, str(name) if name else _name_of(mesh, terrain), appearance)
