extends RefCounted
## Generates tiles of a scene's [TerrainScatter3D], into a folder or for a driver, which is another program. This is the
## implementation of [code]bake_world.gd[/code]. [constant USAGE] lists its arguments. [code]bake_to_folder.gd[/code]
## describes the folder, from which [code]bake.sh[/code] in Thicket's repository builds a bake. [code]bake.sh[/code] can
## also act as a driver, which starts as many engines as it needs.
##
## For a driver, the script connects to a port of this machine, sends the token, and answers requests until the
## connection ends. It then exits. A message is a JSON object, preceded by its length (32 bits, little-endian). The
## [code]bytes[/code] field of an answer is the number of bytes that follow it. The [code]do[/code] field of a request
## is one of the following:
## - [code]describe[/code]: returns the description from [code]scene_description.gd[/code] for a [code]rect[/code], a
##   [code]tile_size[/code] and [code]layers[/code], each a string as on the command line. Missing values are chosen automatically;
## - [code]models[/code]: for each of [code]layers[/code], returns new files for models that have no file in the project, and then an
##   answer with the models. The last answer is [code]{"end": true}[/code];
## - [code]rows[/code]: for each game tile in [code]tile[/code] (an array of column and row), returns an answer as
##   [code]bake_grid.gd[/code] describes it, with the rows from [method ScatterTile.get_rows]. The last answer is [code]{"end": true}[/code].
## If a request fails, the answer has [code]error[/code], a message.
##
## The scene is baked in the state that it has when its ground becomes ready, including the state of the scatter. No
## further frame is processed.

const BakeToFolder := preload("res://addons/thicket/baking/bake_to_folder.gd")
const SceneDescription := preload("res://addons/thicket/baking/scene_description.gd")
const ModelFiles := preload("res://addons/thicket/baking/model_files.gd")

const USAGE := """Generates tiles of a scene's TerrainScatter3D into a folder, from which bake.sh builds a bake on any machine. Existing tiles are kept.
  godot --headless --path PROJECT --script res://addons/thicket/bake_world.gd -- scene=res://world.tscn out=/FOLDER [ARGUMENT=VALUE ...]
    scene=res://...              the scene
    out=/FOLDER                  the absolute path of the folder
    rect=X,Z,WIDTH,DEPTH         the area to bake, in meters; by default the entire ground
    tile_size=METERS             the edge length of a tile; by default a length that fits the layers
    layers=NAME,NAME             names or indices of layers; by default all
    tiles='I,J I,J'              generate only these tiles; by default all tiles in the rectangle
    share=K/N                    generate part K of the tiles in N parts, for N engines that run in parallel
    node=PATH                    the TerrainScatter3D, if the scene has several
    wait=SECONDS                 the maximum time to wait for the scene's ground (120)
The exit code is 0 if all requested tiles exist, 1 if some are missing, and 2 if the script could not begin.
For a driver, use connect=PORT and token=WORD instead of the arguments that apply to a folder (out, rect, tile_size, layers, tiles, share)."""
const NO_SCATTER := "is no TerrainScatter3D"
const NO_GROUND := "is no ground"
const NOT_SETTLED := "is a scatter that still waits for its ground"
## How to fix each of these problems.
const FIXES: Dictionary[String, String] = {
	NO_SCATTER: "Add one, or set node to its path.", NO_GROUND: "Set TerrainScatter3D.ground.",
	NOT_SETTLED: "Increase wait, or check that the ground has heights.",
}
const FOR_ALL: Array[String] = ["scene", "node", "wait"]
const FOR_FOLDER: Array[String] = ["out", "rect", "tile_size", "layers", "tiles", "share"]
const FOR_DRIVER: Array[String] = ["connect", "token"]

var _tree: SceneTree
var _peer := StreamPeerTCP.new()
var _scatter: TerrainScatter3D
var _description: SceneDescription
var _arguments: Dictionary[String, String] = {}


## Reads the arguments from the command line.
func _init(tree: SceneTree) -> void:
	_tree = tree
	for argument in OS.get_cmdline_user_args():
		var key_and_value := argument.split("=", true, 1)
		_arguments[key_and_value[0]] = key_and_value[1] if key_and_value.size() > 1 else ""


## Serves all requests, over many frames, and then ends the program.
func run() -> void:
	var fatal_problem := _arguments_problem()
	var folder := BakeToFolder.new(_arguments) if not fatal_problem and _arguments.has("out") else null
	if folder != null:
		fatal_problem = folder.problem
	elif not fatal_problem and not await _connect():
		fatal_problem = "connect is '%s', but no driver listens at this port of this machine. Start the driver first, or use out." % _arguments.connect
	var problem: String = await _open_scene() if not fatal_problem else ""
	if folder != null and problem:
		fatal_problem = problem
	if fatal_problem:
		printerr("bake_world: ", fatal_problem)
		_tree.quit(2)
		return
	# No frame is processed from here on, so that the scene does not change. The bake runs in a physics frame, because the ground may use ray queries.
	await _tree.physics_frame
	if folder != null:
		_tree.quit(folder.make(_scatter, _arguments["scene"]))
		return
	while _answer(problem):
		pass
	_tree.quit()


## Returns the error in the arguments, or an empty string if there is none.
func _arguments_problem() -> String:
	if not (_arguments.has("out") or _arguments.has("connect")):
		return "out is missing.\n" + USAGE
	var allowed := FOR_ALL + (FOR_FOLDER if _arguments.has("out") else FOR_DRIVER)
	for name in _arguments:
		if not name in allowed:
			return "%s is '%s', which is not an argument. The arguments are: %s." % [name, _arguments[name], ", ".join(allowed)]
	if _arguments.has("wait") and not (_arguments["wait"].is_valid_float() and _arguments["wait"].to_float() >= 0.0):
		return "wait must be at least 0 seconds, got '%s'." % _arguments["wait"]
	return ""


func _connect() -> bool:
	if _peer.connect_to_host("127.0.0.1", int(_arguments.get("connect", "0"))) != OK:
		return false
	while _peer.get_status() == StreamPeerTCP.STATUS_CONNECTING:
		await _tree.process_frame
		_peer.poll()
	if _peer.get_status() != StreamPeerTCP.STATUS_CONNECTED:
		return false
	_peer.set_no_delay(true)
	return _send({"token": _arguments.get("token", "")})


## Loads the scene and waits for its ground. Returns an error message, or an empty string if everything is ready.
func _open_scene() -> String:
	var path: String = _arguments.get("scene", "")
	if not ResourceLoader.exists(path, "PackedScene"):
		return "There is no scene '%s'. Set scene to the res:// path of one in the project." % path
	var packed := load(path) as PackedScene
	var scene := packed.instantiate() if packed != null else null
	if scene == null:
		return "The scene %s cannot be loaded. See the printed error for details." % path
	_find_scatter(scene)
	_tree.root.add_child(scene)
	_tree.current_scene = scene
	var deadline := Time.get_ticks_msec() + int(1000.0 * float(_arguments.get("wait", "120")))
	var missing := NO_SCATTER
	var frames := 0
	while frames < 3 or missing:
		await _tree.process_frame
		frames += 1
		var ambiguity := _find_scatter(scene)
		if ambiguity:
			return ambiguity
		missing = _scene_problem()
		if missing and Time.get_ticks_msec() > deadline:
			var location: String = " at node '%s'" % _arguments["node"] if _arguments.has("node") else ""
			return "In the scene %s there %s after %s s%s. %s" % [path, missing, _arguments.get("wait", "120"), location, FIXES[missing]]
	return ""


## Finds the scatter and limits its streaming to the tile at its position. Returns an error if there are several scatters to choose from.
func _find_scatter(scene: Node) -> String:
	if _scatter != null:
		return ""
	var scatters: Array[Node] = []
	if _arguments.has("node"):
		scatters = [scene.get_node_or_null(_arguments["node"])]
	else:
		scatters = scene.find_children("*", "TerrainScatter3D", true, false)
		if scene is TerrainScatter3D:
			scatters.push_front(scene)
	if scatters.size() > 1:
		var paths := scatters.map(func(node: Node) -> String: return str(scene.get_path_to(node)))
		return "The scene has several TerrainScatter3D nodes: set node (--node) to the path of one of them: %s." % ", ".join(paths)
	if scatters.size() == 1 and scatters[0] is TerrainScatter3D:
		_scatter = scatters[0]
		_scatter.process_mode = Node.PROCESS_MODE_ALWAYS # The scene may pause the game at the start.
		_scatter.viewers = [^"."] as Array[NodePath]
		_scatter.viewer_distance_scales = PackedFloat32Array([0.0])
		_scatter.interaction_group = &""
	return ""


func _scene_problem() -> String:
	if _scatter == null:
		return NO_SCATTER
	if _scatter.ground == null:
		return NO_GROUND
	if not _scatter.is_settled():
		return NOT_SETTLED
	return ""


func _send(header: Dictionary, payload := PackedByteArray()) -> bool:
	header["bytes"] = payload.size()
	return _peer.put_data(BakeToFolder.message(header)) == OK and (payload.is_empty() or _peer.put_data(payload) == OK)


## Waits for the next request and answers it. Returns false when the connection has ended.
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
			return _send_description(message)
		"models":
			return _send_models(message["layers"])
		"rows":
			return _send_rows(message.tile)
	return _send({"error": "'%s' is not a request: do must be describe, models or rows." % message})


func _send_description(request: Dictionary) -> bool:
	_description = SceneDescription.new(request)
	var is_valid := _description.problem.is_empty() and _description.describe(_scatter)
	return _send(_description.values if is_valid else {"error": _description.problem})


## Sends the rows of a tile of the most recent description.
func _send_rows(tile: Array) -> bool:
	if _description == null or _description.grid == null or _description.problem:
		return _send({"error": "Rows were requested before describe succeeded: send the request describe first."})
	for game_tile in _description.grid.parts_of(Vector2i(int(tile[0]), int(tile[1]))):
		var rows := BakeToFolder.rows_of(_scatter, game_tile)
		if rows.is_empty():
			return _send({"error": BakeToFolder.generation_error(game_tile)})
		if not _send(game_tile, rows):
			return false
	return _send({"end": true})


func _send_models(layers: Array) -> bool:
	var all_layers := _scatter.get_all_layers()
	for index: float in layers:
		var files := ModelFiles.new(all_layers[int(index)], int(index))
		for file in files.new_files:
			if not _send({"file": file}, files.new_files[file]):
				return false
		if not _send({"error": files.problem} if files.problem else {"index": int(index), "models": files.models, "material": files.material}):
			return false
	return _send({"end": true})
