extends "res://tests/tutorial_tree.gd"
## Writes the files that a newcomer brings into an empty project: res://hills.glb, a ground, and res://oak.glb, a tree with its texture.

const Hills := preload("res://tests/hills.gd")

var _leaves: ImageTexture


func _initialize() -> void:
	var picture: Image = atlas.texture().get_image()
	picture.clear_mipmaps()
	_leaves = ImageTexture.create_from_image(picture)
	var tree := Node3D.new()
	tree.name = "Oak"
	var bark := material_of("Bark")
	var leaves := material_of("Leaves")
	for level in 3:
		var parts := parts_of(level)
		put(tree, "Trunk_LOD%d" % level, parts[0].mesh_of(0, bark))
		put(tree, "Crown_LOD%d" % level, parts[1].mesh_of(0, leaves))
	save(tree, "res://oak.glb")
	var ground := Node3D.new()
	ground.name = "Hills"
	put(ground, "Ground", Hills.mesh())
	save(ground, "res://hills.glb")
	print("written")
	quit()


func save(root_node: Node3D, file: String) -> void:
	var state := GLTFState.new()
	var document := GLTFDocument.new()
	assert(document.append_from_scene(root_node, state) == OK)
	assert(document.write_to_filesystem(state, file) == OK)
	root_node.free()


## Returns a material as in most asset packs: the texture's colors, with holes between leaves.
func material_of(title: String) -> StandardMaterial3D:
	var textured := super(title)
	textured.albedo_color = Color.WHITE
	textured.albedo_texture = _leaves
	textured.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA_SCISSOR
	textured.alpha_scissor_threshold = 0.5
	textured.cull_mode = BaseMaterial3D.CULL_DISABLED
	return textured
