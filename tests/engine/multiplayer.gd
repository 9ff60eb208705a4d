extends SceneTree
## One of several processes that share a world: the server, a client that fells together with the others, or one that
## comes late. Started by tests/test_multiplayer.py; `-- server`, `-- client PORT NUMBER` and `-- late PORT`.
##
## Each fells its share of the trees of an area, one a frame, and a share that all of them want. When everything that was
## to fall has fallen, it prints a line "result {...}" with what the area is now; the server waits until all have left.

const AREA := Rect2(-170.0, 40.0, 220.0, 220.0)
const CLIENTS := 3
const PATIENCE := 90.0
## Of each five trees, the server and two clients fell one, all three another one, and one stays.
const CIRCLE := 5
const OWN: Array[int] = [0, 1, 2]
const SHARED := 3

var arguments := OS.get_cmdline_user_args()
var world: TerrainScatter3D
var session: Node
var mine: Array[int] = []
var to_fall: Array[int] = []
var come := 0


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
	# Counted before anything has fallen: everybody has the same list, for everybody has the same world.
	var before: String = world.call(&"fingerprint", AREA)
	_share_out(int(arguments[2]) if role == "client" else 0)
	if role == "server":
		_host()
		await _until(func() -> bool: return come >= CLIENTS - 1)
	else:
		session.call(&"join", "127.0.0.1", int(arguments[1]))
		await session.synced
	if role == "client":
		# The server begins when both have come.
		await _until(func() -> bool: return world.state.get_removed_count() > 0)
	if role != "late":
		for id in mine:
			world.call(&"fell", id) if role == "server" else session.call(&"fell", id)
			await process_frame
	await _until(func() -> bool: return not to_fall.any(world.has_instance))
	# To look at everything takes a while, in which nothing is sent: the others are to know before that.
	await create_timer(0.5).timeout
	_report(before)
	if role == "server":
		await _until(func() -> bool: return come == CLIENTS and root.multiplayer.get_peers().is_empty())
	_end("")


func _share_out(number: int) -> void:
	var trees: PackedInt64Array = world.query_rect(AREA, world.get(&"trees")).ids
	trees.sort()
	for place in trees.size():
		var turn := place % CIRCLE
		if turn == SHARED or OWN.has(turn):
			to_fall.append(trees[place])
		if turn == SHARED or turn == OWN[number]:
			mine.append(trees[place])


func _host() -> void:
	if session.call(&"host", 0) != OK:
		return _end("cannot listen")
	root.multiplayer.peer_connected.connect(func(_client: int) -> void: come += 1)
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
