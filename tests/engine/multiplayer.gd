extends SceneTree
## One of several processes that share a world: the server, a client that fells trees concurrently with the others, or a client that joins
## late. test_multiplayer.py starts this script with `-- server`, `-- client PORT NUMBER` or `-- late PORT`.
##
## The server and the two clients each fell one tree per frame: their own part of an area's trees, and a part that all three fell. When
## all of these trees are gone, each process prints a line "result {...}" that describes the area. The server then waits until all clients
## have left.

const AREA := Rect2(-170.0, 40.0, 220.0, 220.0)
const CLIENTS := 3
const PATIENCE := 90.0
## Of every five trees, the server and the two clients fell one each. All three fell the fourth tree, and the fifth remains.
const CIRCLE := 5
const OWN: Array[int] = [0, 1, 2]
const SHARED := 3

var arguments := OS.get_cmdline_user_args()
var world: TerrainScatter3D
var session: Node
var mine: Array[int] = []
var to_fall: Array[int] = []
var joined := 0


func _initialize() -> void:
	_run.call_deferred()


func _run() -> void:
	create_timer(PATIENCE).timeout.connect(_end.bind("not done within %.0f s" % PATIENCE))
	var role := arguments[0]
	var scene: PackedScene = load("res://gameplay/%s.tscn" % ("server" if role == "server" else "client"))
	var game := scene.instantiate()
	game.set_script(null)
	world = game.get_node(^"World")
	session = game.get_node(^"Session")
	root.add_child(game)
	# Do this before any tree is felled, while all processes have the same world. They then compute the same list of trees.
	var before: String = world.call(&"fingerprint", AREA)
	_share_out(int(arguments[2]) if role == "client" else 0)
	if role == "server":
		_host()
		await _until(func() -> bool: return joined >= CLIENTS - 1)
	else:
		session.call(&"join", "127.0.0.1", int(arguments[1]))
		await session.synced
	if role == "client":
		# The server starts felling after both clients have joined.
		await _until(func() -> bool: return world.state.get_removed_count() > 0)
	if role != "late":
		for id in mine:
			world.call(&"fell", id) if role == "server" else session.call(&"fell", id)
			await process_frame
	await _until(func() -> bool: return not to_fall.any(world.has_instance))
	# The fingerprint blocks this process for a while, so wait until its last packets have been sent.
	await create_timer(0.5).timeout
	_report(before)
	if role == "server":
		await _until(func() -> bool: return joined == CLIENTS and root.multiplayer.get_peers().is_empty())
	_end("")


func _share_out(number: int) -> void:
	var trees: PackedInt64Array = world.query_rect(AREA, world.get(&"TREES")).ids
	trees.sort()
	for index in trees.size():
		var turn := index % CIRCLE
		if turn == SHARED or OWN.has(turn):
			to_fall.append(trees[index])
		if turn == SHARED or turn == OWN[number]:
			mine.append(trees[index])


func _host() -> void:
	if session.call(&"host", 0) != OK:
		return _end("cannot listen")
	root.multiplayer.peer_connected.connect(func(_client: int) -> void: joined += 1)
	print("port %d" % session.call(&"port"))


func _report(before: String) -> void:
	var connection := (root.multiplayer.multiplayer_peer as ENetMultiplayerPeer).host
	print("result " + JSON.stringify({
		"before": before,
		"after": world.call(&"fingerprint", AREA),
		"state": str(world.state.get_digest()),
		"to_fall": to_fall.size(),
		"removed": world.state.get_removed_count(),
		"sent": connection.pop_statistic(ENetConnection.HOST_TOTAL_SENT_DATA),
		"received": connection.pop_statistic(ENetConnection.HOST_TOTAL_RECEIVED_DATA),
	}))


func _until(holds: Callable) -> void:
	while not holds.call():
		await process_frame


func _end(failure: String) -> void:
	if failure != "":
		printerr("multiplayer: " + failure)
	root.multiplayer.multiplayer_peer.close()
	quit(0 if failure == "" else 1)
