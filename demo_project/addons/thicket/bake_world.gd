extends SceneTree
## Makes tiles of a scene's [TerrainScatter3D] for a driver in another program, which writes them into files: see
## [code]tools/bake[/code] in Thicket's repository, whose [code]bake.sh[/code] starts as many of these as it wants.
## [codeblock]
## godot --headless --path PROJECT --script res://addons/thicket/bake_world.gd -- scene=res://world.tscn connect=PORT token=WORD
## [/codeblock]
## Further arguments: [code]node=PATH[/code] of the scatter, where a scene has several; [code]wait=SECONDS[/code], the longest that the
## scene may take until its ground is there (120).
##
## It connects to the port of this machine, says the token, and then answers until the connection ends, with which it ends too. A
## message is a JSON object behind its length, 32 bits, little-endian; an answer's [code]bytes[/code] says how many bytes follow it. What is asked is [code]do[/code]:
## - [code]describe[/code]: the layers, the seed and so on, and the digest of the scene, for which the ground is probed in [code]rect[/code]
##   (x, z, width, depth in meters of the world), or, without one, in the rectangle where the terrain says that it lies;
## - [code]models[/code]: for each of [code]layers[/code] an answer with what its instances look like, each after the files of what has no
##   file in the project; the last answer is [code]{"end": true}[/code];
## - [code]rows[/code]: for each of [code]tiles[/code], an array of [code][layer, x, y][/code], an answer with what
##   [method ScatterTile.get_rows] gives.
## Whoever is refused gets an [code]error[/code], a sentence.
##
## Baked is the scene as it is once its ground is there: with the state that the scatter has then, and before any frame after that.

const SceneDigest := preload("res://addons/thicket/scene_digest.gd")
const ModelFiles := preload("res://addons/thicket/model_files.gd")

var _peer := StreamPeerTCP.new()
var _scatter: Node3D
var _arguments: Dictionary[String, String] = {}


func _initialize() -> void:
	for argument in OS.get_cmdline_user_args():
		var parts := argument.split("=", true, 1)
		_arguments[parts[0]] = parts[1] if parts.size() > 1 else ""
	_run.call_deferred()


func _run() -> void:
	if not _arguments.has("connect"):
		printerr("bake_world: connect=PORT is missing. The driver gives it: bash demo_project/bake.sh SCENE FOLDER bakes a world.")
		quit(2)
		return
	if not await _connect():
		printerr("bake_world: nobody listens at port '%s' of this machine" % _arguments.connect)
		quit(2)
		return
	var problem: String = await _open_scene()
	# From here on no frame passes, so that the scene stays as it is; in a physics frame, so that ground may be asked for by rays.
	await physics_frame
	while _answer(problem):
		pass
	quit()


func _connect() -> bool:
	if _peer.connect_to_host("127.0.0.1", int(_arguments.get("connect", "0"))) != OK:
		return false
	while _peer.get_status() == StreamPeerTCP.STATUS_CONNECTING:
		await process_frame
		_peer.poll()
	if _peer.get_status() != StreamPeerTCP.STATUS_CONNECTED:
		return false
	_peer.set_no_delay(true)
	return _send({"token": _arguments.get("token", "")})


## Loads the scene and waits for its ground. Returns what is wrong, in a sentence; nothing if all is there.
func _open_scene() -> String:
	var path: String = _arguments.get("scene", "")
	if not ResourceLoader.exists(path, "PackedScene"):
		return "There is no scene '%s'." % path
	var packed := load(path) as PackedScene
	var scene := packed.instantiate() if packed != null else null
	if scene == null:
		return "The scene %s cannot be loaded." % path
	_find_scatter(scene)
	root.add_child(scene)
	current_scene = scene
	var deadline := Time.get_ticks_msec() + int(1000.0 * float(_arguments.get("wait", "120")))
	var missing := "is no TerrainScatter3D"
	var frames := 0
	while frames < 3 or missing:
		await process_frame
		frames += 1
		var several := _find_scatter(scene)
		if several:
			return several
		missing = _what_is_missing()
		if missing and Time.get_ticks_msec() > deadline:
			return "In the scene %s there %s after %s s." % [path, missing, _arguments.get("wait", "120")]
	return ""


## Looks for the scatter, and lets it stream no more than the tile that it is in. Returns what is wrong, if more than one could be meant.
func _find_scatter(scene: Node) -> String:
	if _scatter != null:
		return ""
	var found: Array[Node] = []
	if _arguments.has("node"):
		found = [scene.get_node_or_null(_arguments.node)]
	else:
		found = scene.find_children("*", "TerrainScatter3D", true, false)
		if scene.is_class("TerrainScatter3D"):
			found.push_front(scene)
	if found.size() > 1:
		var paths := found.map(func(node: Node) -> String: return str(scene.get_path_to(node)))
		return "The scene has several TerrainScatter3D: choose one with --node, of %s." % ", ".join(paths)
	if found.size() == 1 and found[0] != null and found[0].is_class("TerrainScatter3D"):
		_scatter = found[0]
		_scatter.process_mode = Node.PROCESS_MODE_ALWAYS # A game may begin with a pause.
		_scatter.set(&"viewers", [^"."] as Array[NodePath])
		_scatter.set(&"viewer_distance_scales", PackedFloat32Array([0.0]))
		_scatter.set(&"interaction_group", &"")
	return ""


func _what_is_missing() -> String:
	if _scatter == null:
		return "is no TerrainScatter3D"
	if _scatter.get(&"terrain") == null:
		return "is no terrain"
	if not _scatter.call(&"is_settled"):
		return "is a scatter that still waits for its ground"
	return ""


func _send(header: Dictionary, payload := PackedByteArray()) -> bool:
	header["bytes"] = payload.size()
	var text := JSON.stringify(header, "", false, true).to_utf8_buffer()
	var length := PackedByteArray([0, 0, 0, 0])
	length.encode_u32(0, text.size())
	return _peer.put_data(length + text) == OK and (payload.is_empty() or _peer.put_data(payload) == OK)


## Waits for the next message and answers it. Returns false when the connection has ended.
func _answer(problem: String) -> bool:
	var length := _peer.get_data(4)
	if length[0] != OK:
		return false
	var text := _peer.get_data((length[1] as PackedByteArray).decode_u32(0))
	if text[0] != OK:
		return false
	var message: Variant = JSON.parse_string((text[1] as PackedByteArray).get_string_from_utf8())
	if problem:
		return _send({"error": problem})
	match (message as Dictionary).get("do") if message is Dictionary else null:
		"describe":
			return _send(_description(message.get("rect")))
		"models":
			return _send_models(message.layers)
		"rows":
			return _send_rows(message.tiles)
	return _send({"error": "'%s' cannot be asked for." % message})


func _send_rows(tiles: Array) -> bool:
	for tile: Array in tiles:
		var built: RefCounted = _scatter.call(&"build_tile", int(tile[0]), Vector2i(int(tile[1]), int(tile[2])))
		if built.call(&"get_mesh_count") == 0:
			return _send({"error": "Tile %d, %d of layer %d cannot be made; what the engine printed says why." % [tile[1], tile[2], tile[0]]})
		if not _send({}, built.call(&"get_rows")):
			return false
	return true


func _send_models(layers: Array) -> bool:
	for index: float in layers:
		var files := ModelFiles.new(_scatter.call(&"get_layer", int(index)), int(index))
		for file in files.written:
			if not _send({"file": file}, files.written[file]):
				return false
		if not _send({"error": files.problem} if files.problem else {"index": int(index), "models": files.models, "material": files.material}):
			return false
	return _send({"end": true})


## Where a terrain says it lies; an empty rectangle for one that does not say.
func _rect_of_terrain() -> Rect2:
	var rect: Variant = (_scatter.get(&"terrain") as Resource).get(&"rect")
	return rect if rect is Rect2 else Rect2()


func _description(probed: Variant) -> Dictionary:
	var layers: Array[Dictionary] = []
	for index: int in _scatter.call(&"get_layer_count"):
		var layer: Resource = _scatter.call(&"get_layer", index)
		if layer != null:
			layers.append({
				"index": index, "name": layer.resource_name, "radius": layer.get(&"radius"), "levels": layer.get(&"progressive_levels"),
				"tile_size": layer.get(&"tile_size"), "colored": layer.get(&"use_colors"), "custom_data": layer.get(&"use_custom_data"),
				"view_distance": layer.get(&"view_distance"), "cast_shadow": layer.get(&"cast_shadow"),
				"render_layers": layer.get(&"render_layers"),
			})
	var rect := _rect_of_terrain()
	var parts := SceneDigest.parts_of(_scatter, Rect2(probed[0], probed[1], probed[2], probed[3]) if probed is Array else rect)
	var offset: Vector3 = _scatter.get(&"world_offset")
	return {
		"seed": str(_scatter.get(&"seed")), "layers": layers, "parts": parts, "world_offset": [offset.x, offset.y, offset.z],
		"rect": [rect.position.x, rect.position.y, rect.size.x, rect.size.y], "problems": _scatter.call(&"get_problems"),
		"scene_digest": JSON.stringify(parts, "", true).sha256_text(), "thicket": _version(),
	}


func _version() -> String:
	var config := ConfigFile.new()
	config.load("res://addons/thicket/plugin.cfg")
	return config.get_value("plugin", "version", "")

