extends Node
## One end of a world that several share over the network. Everybody makes the world from its seed; what travels is what
## has been changed: a few bytes for each felled tree. The server alone decides.
##
## A client asks what stands somewhere, and to fell. The server answers, and once a frame sends every client what is new to
## it, by [method ScatterState.diff_since]. A client that joins late gets all of it in the same way. A client that lacks a
## diff, because it was lost or the server was restarted, asks for it.

## The server's word on a question of [method ask].
signal answered(question: int, ids: PackedInt64Array)
## The world is as the server has it, for the first time or again after a change.
signal synced

## Meters that a question may reach.
const FARTHEST := 200.0
## Clients that a server takes.
const MOST_CLIENTS := 32

## The world that is shared. Its [member TerrainScatter3D.state] is not null.
@export var world: TerrainScatter3D

## For each client, the revision of the state that it knows. On the server only.
var _known: Dictionary[int, int] = {}
var _questions := 0


## Becomes the server, on a port of this machine; 0 takes a free one. See [method port].
func host(at_port: int) -> Error:
	var peer := ENetMultiplayerPeer.new()
	peer.set_bind_ip("127.0.0.1")
	var error := peer.create_server(at_port, MOST_CLIENTS)
	if error == OK:
		# Clients send wishes. Were they to send diffs, these would be small.
		world.state.diff_limits = ScatterDiffLimits.new()
		_begin(peer)
		multiplayer.peer_disconnected.connect(func(client: int) -> void: _known.erase(client))
	return error


## Joins a server. Once it has answered, [signal synced] is emitted.
func join(address: String, at_port: int) -> Error:
	var peer := ENetMultiplayerPeer.new()
	var error := peer.create_client(address, at_port)
	if error == OK:
		_begin(peer)
		multiplayer.connected_to_server.connect(func() -> void: _greet.rpc_id(1, world.seed))
	return error


## The port that a server listens on.
func port() -> int:
	return (multiplayer.multiplayer_peer as ENetMultiplayerPeer).host.get_local_port()


## Asks the server what stands around a place; [signal answered] comes with the number that is returned.
func ask(center: Vector3, radius: float, layers: PackedInt32Array) -> int:
	_questions += 1
	_ask.rpc_id(1, _questions, center, radius, layers)
	return _questions


## Asks the server to fell a tree. What comes of it is seen in the world.
func fell(id: int) -> void:
	_fell.rpc_id(1, id)


func _begin(peer: ENetMultiplayerPeer) -> void:
	# Clients have nothing to say to each other.
	(multiplayer as SceneMultiplayer).server_relay = false
	multiplayer.multiplayer_peer = peer


func _process(_delta: float) -> void:
	var revision := world.state.get_revision()
	for client in _known:
		if _known[client] != revision:
			_sync.rpc_id(client, world.state.diff_since(maxi(_known[client], 0)))
			_known[client] = revision


@rpc("any_peer", "call_remote", "reliable")
func _greet(their_seed: int) -> void:
	var client := multiplayer.get_remote_sender_id()
	if their_seed == world.seed:
		_known[client] = -1
	else:
		multiplayer.multiplayer_peer.disconnect_peer(client)


@rpc("any_peer", "call_remote", "reliable")
func _ask(question: int, center: Vector3, radius: float, layers: PackedInt32Array) -> void:
	var client := multiplayer.get_remote_sender_id()
	# What comes from outside may be anything.
	if not _known.has(client) or not center.is_finite() or not is_finite(radius):
		return
	var standing := world.query_sphere(center, clampf(radius, 0.0, FARTHEST), layers)
	_answer.rpc_id(client, question, standing.ids)


@rpc("any_peer", "call_remote", "reliable")
func _fell(id: int) -> void:
	if _known.has(multiplayer.get_remote_sender_id()):
		world.call(&"fell", id)


## The next frame sends a client all changes after a revision.
@rpc("any_peer", "call_remote", "reliable")
func _send_since(revision: int) -> void:
	var client := multiplayer.get_remote_sender_id()
	if _known.has(client):
		_known[client] = clampi(revision, 0, world.state.get_revision())


@rpc("authority", "call_remote", "reliable")
func _answer(question: int, ids: PackedInt64Array) -> void:
	answered.emit(question, ids)


@rpc("authority", "call_remote", "reliable")
func _sync(diff: PackedByteArray) -> void:
	var since := world.state.get_missing_since(diff)
	if since >= 0:
		_send_since.rpc_id(1, since)
		return
	var error := world.state.apply_diff(diff)
	if error != OK:
		push_error("the server's word cannot be applied: %s" % error_string(error))
		return
	synced.emit()
