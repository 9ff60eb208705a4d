extends Node
## A server's or a client's side of a world that is shared over the network. Every peer generates the world from its seed, and
## only changes are sent, a few bytes for each felled tree. Only the server makes decisions.
##
## A client sends queries and requests to fell trees, and the server answers them. Once per frame, the server sends each client the changes that the
## client does not have yet, from [method ScatterState.diff_since]. A client that joins late receives all changes in the same way. If a client misses
## a diff, because it was lost or the server was restarted, the client requests the diff again.

## Emitted with the server's answer to a query. [param question] is the number that [method ask] has returned.
signal answered(question: int, ids: PackedInt64Array)
## Emitted when the world matches the server's world, for the first time or after a change.
signal synced

## The largest radius of a query in meters.
const MAX_RADIUS := 200.0
## The largest number of clients of a server.
const MAX_CLIENTS := 32

## The shared world. Its [member TerrainScatter3D.state] is not null.
@export var world: TerrainScatter3D

## The revision of the state that each client has. Only used on the server.
var _client_revisions: Dictionary[int, int] = {}
var _question_count := 0


## Starts a server on a port of this machine, or on a free port if [param at_port] is 0. See [method port].
func host(at_port: int) -> Error:
	var peer := ENetMultiplayerPeer.new()
	peer.set_bind_ip("127.0.0.1")
	var error := peer.create_server(at_port, MAX_CLIENTS)
	if error == OK:
		# Clients send only requests, no diffs. If a client sends a diff anyway, these default limits restrict it.
		world.state.diff_limits = ScatterDiffLimits.new()
		_begin(peer)
		multiplayer.peer_disconnected.connect(func(client: int) -> void: _client_revisions.erase(client))
	return error


## Joins a server. Emits [signal synced] once the server has answered.
func join(address: String, at_port: int) -> Error:
	var peer := ENetMultiplayerPeer.new()
	var error := peer.create_client(address, at_port)
	if error == OK:
		_begin(peer)
		multiplayer.connected_to_server.connect(func() -> void: _greet.rpc_id(1, world.seed))
	return error


## Returns the port on which the server listens.
func port() -> int:
	return (multiplayer.multiplayer_peer as ENetMultiplayerPeer).host.get_local_port()


## Queries the server for the instances around a position, in the layers with these names. Returns a number. [signal answered] is emitted later with
## the same number.
func ask(center: Vector3, radius: float, layers: PackedStringArray) -> int:
	_question_count += 1
	_ask.rpc_id(1, _question_count, center, radius, layers)
	return _question_count


## Sends the server a request to fell a tree. If the server accepts it, the change arrives with a later diff.
func fell(id: int) -> void:
	_fell.rpc_id(1, id)


func _begin(peer: ENetMultiplayerPeer) -> void:
	# Clients do not send messages to each other.
	(multiplayer as SceneMultiplayer).server_relay = false
	multiplayer.multiplayer_peer = peer


func _process(_delta: float) -> void:
	var revision := world.state.get_revision()
	for client in _client_revisions:
		if _client_revisions[client] != revision:
			_sync.rpc_id(client, world.state.diff_since(maxi(_client_revisions[client], 0)))
			_client_revisions[client] = revision


@rpc("any_peer", "call_remote", "reliable")
func _greet(client_seed: int) -> void:
	var client := multiplayer.get_remote_sender_id()
	if client_seed == world.seed:
		_client_revisions[client] = -1
	else:
		multiplayer.multiplayer_peer.disconnect_peer(client)


@rpc("any_peer", "call_remote", "reliable")
func _ask(question: int, center: Vector3, radius: float, layers: PackedStringArray) -> void:
	var client := multiplayer.get_remote_sender_id()
	# Data from the network must be validated.
	if not _client_revisions.has(client) or not center.is_finite() or not is_finite(radius):
		return
	var instances := world.query_sphere(center, clampf(radius, 0.0, MAX_RADIUS), layers)
	_answer.rpc_id(client, question, instances.ids)


@rpc("any_peer", "call_remote", "reliable")
func _fell(id: int) -> void:
	if _client_revisions.has(multiplayer.get_remote_sender_id()):
		world.call(&"fell", id)


## Makes the server send the calling client all changes after a revision in the next frame.
@rpc("any_peer", "call_remote", "reliable")
func _send_since(revision: int) -> void:
	var client := multiplayer.get_remote_sender_id()
	if _client_revisions.has(client):
		_client_revisions[client] = clampi(revision, 0, world.state.get_revision())


@rpc("authority", "call_remote", "reliable")
func _answer(question: int, ids: PackedInt64Array) -> void:
	answered.emit(question, ids)


@rpc("authority", "call_remote", "reliable")
func _sync(diff: PackedByteArray) -> void:
	var missing_revision := world.state.get_missing_since(diff)
	if missing_revision >= 0:
		_send_since.rpc_id(1, missing_revision)
		return
	var error := world.state.apply_diff(diff)
	if error != OK:
		push_error("the server's diff cannot be applied: %s" % error_string(error))
		return
	synced.emit()
