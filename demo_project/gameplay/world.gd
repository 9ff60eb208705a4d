extends TerrainScatter3D
## The world that the player, a server and its clients share. It has a seed, layers, and the rules for felling trees.
## All peers that load this scene have the same IDs.

## The names of the layers that can be felled. The meshes of the stump layer have the same order.
const TREES: Array[String] = ["Oak", "Spruce"]
## The name of the stump layer, whose density is 0, so that no stump is generated.
const STUMP := "Stump"

## If true, felling leaves a stump. Without stumps, peers only need to send removals.
@export var leaves_stumps := true


func _ready() -> void:
	if state == null:
		state = ScatterState.new()


## Removes a tree and leaves a stump, which [member state] records. Returns false if the instance is not a tree or was already felled.
func fell(id: int) -> bool:
	var tree := get_instance(id)
	var kind := TREES.find(tree.layer.resource_name) if tree != null else -1
	if kind < 0 or not remove_instance(id):
		return false
	if leaves_stumps:
		add_instance(STUMP, tree.transform, kind)
	return true


## Returns the number of instances in a rectangle and a hash of their IDs and transforms. Two peers with the same world
## have the same fingerprint.
func fingerprint(rect: Rect2) -> String:
	var instances := query_rect(rect)
	var hashing := HashingContext.new()
	hashing.start(HashingContext.HASH_SHA256)
	for bytes: PackedByteArray in [instances.ids.to_byte_array(), instances.transforms.to_byte_array()]:
		if not bytes.is_empty():
			hashing.update(bytes)
	return "%d %s" % [instances.ids.size(), hashing.finish().hex_encode()]
