extends TerrainScatter3D
## The world that the player, a server and its clients share: a seed, layers, and what it means to fell a tree. Whoever
## loads this scene agrees with all others on every id.

## Layers that can be felled, by name; the stumps' meshes are in this order.
const TREES: Array[String] = ["Oak", "Spruce"]
## The layer of what is left. Its density is 0, so that nothing of it grows by itself.
const STUMP := "Stump"

## Whether felling leaves a stump. Without, removals are all that peers need to tell each other.
@export var leaves_stumps := true

## Where the layers of [constant TREES] stand in [member layers].
var trees := PackedInt32Array()


func _ready() -> void:
	for layer_name in TREES:
		trees.append(place_of(layer_name))
	if state == null:
		state = ScatterState.new()


## Where a layer stands in [member layers]; -1 for none of that name.
func place_of(layer_name: String) -> int:
	for place in layers.size():
		if layers[place] != null and layers[place].resource_name == layer_name:
			return place
	return -1


## Takes a tree away and leaves a stump. Both are in [member state] from now on. False for what is no tree, or felled
## already.
func fell(id: int) -> bool:
	var tree := get_instance(id)
	if tree == null or not trees.has(tree.layer) or not remove_instance(id):
		return false
	if leaves_stumps:
		add_instance(place_of(STUMP), tree.transform, trees.find(tree.layer))
	return true


## How many stand in a rectangle, and a digest of all of them to the last bit: two peers that agree have the same.
func fingerprint(rect: Rect2) -> String:
	var standing := query_rect(rect)
	var hashing := HashingContext.new()
	hashing.start(HashingContext.HASH_SHA256)
	for part: PackedByteArray in [standing.ids.to_byte_array(), standing.transforms.to_byte_array()]:
		if not part.is_empty():
			hashing.update(part)
	return "%d %s" % [standing.ids.size(), hashing.finish().hex_encode()]
