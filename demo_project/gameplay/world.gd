extends TerrainScatter3D
## The world that the player, a server and its clients share: a seed, layers, and the rules for felling trees. All
## peers that load this scene have the same ids.

## Layers that can be felled, by name. The stumps' meshes are in this order.
const TREES: Array[String] = ["Oak", "Spruce"]
## The layer of stumps. Its density is 0, so that no stump is generated.
const STUMP := "Stump"

## Whether felling leaves a stump. Without stumps, peers need to send each other only removals.
@export var leaves_stumps := true


func _ready() -> void:
	if state == null:
		state = ScatterState.new()


## Removes a tree and leaves a stump. [member state] keeps both. Returns false if the instance is not a tree or was already felled.
func fell(id: int) -> bool:
	var tree := get_instance(id)
	var kind := TREES.find(tree.layer.resource_name) if tree != null else -1
	if kind < 0 or not remove_instance(id):
		return false
	if leaves_stumps:
		add_instance(STUMP, tree.transform, kind)
	return true


## The number of instances in a rectangle, and a digest of them bit for bit. Two peers with the same world have the
## same fingerprint.
func fingerprint(rect: Rect2) -> String:
	var standing := query_rect(rect)
	var hashing := HashingContext.new()
	hashing.start(HashingContext.HASH_SHA256)
	for part: PackedByteArray in [standing.ids.to_byte_array(), standing.transforms.to_byte_array()]:
		if not part.is_empty():
			hashing.update(part)
	return "%d %s" % [standing.ids.size(), hashing.finish().hex_encode()]
