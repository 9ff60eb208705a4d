extends Node
## An example of a client without rendering. The client joins a server, queries the trees around a position, fells the nearest trees, waits until its
## world has received the changes, and quits.
##   godot --headless --path demo_project res://gameplay/client.tscn -- --port=4433 --at=-20,150 --fell=5
##
## Arguments after [code]--[/code]: [code]--port=NUMBER[/code], [code]--address=ADDRESS[/code] (this machine by
## default), [code]--at=X,Z[/code] in meters, [code]--fell=COUNT[/code].

const DEFAULT_PORT := 4433
## The radius in meters within which the client queries trees.
const RADIUS := 60.0
## The maximum duration of the run in seconds.
const TIMEOUT := 30.0

@onready var world: TerrainScatter3D = $World
@onready var session: Node = $Session


func _ready() -> void:
	var arguments := {"port": str(DEFAULT_PORT), "address": "127.0.0.1", "at": "-20,150", "fell": "3"}
	for argument in OS.get_cmdline_user_args():
		var name_and_value := argument.trim_prefix("--").split("=", true, 1)
		arguments[name_and_value[0]] = name_and_value[-1]
	get_tree().create_timer(TIMEOUT).timeout.connect(_end.bind("no answer within %.0f s" % TIMEOUT))
	multiplayer.server_disconnected.connect(_end.bind("the server has disconnected"))
	var error: Error = session.call(&"join", arguments.address, int(arguments.port))
	if error != OK:
		return _end("cannot join: " + error_string(error))
	await session.synced
	var coordinates: PackedStringArray = arguments.at.split(",")
	await _fell_around(Vector3(coordinates[0].to_float(), 0.0, coordinates[-1].to_float()), int(arguments.fell))
	_end("")


func _fell_around(point: Vector3, count: int) -> void:
	point.y = world.ground.get_height(point)
	session.call(&"ask", point, RADIUS, PackedStringArray(world.get(&"TREES")))
	var answer: Array = await session.answered
	var ids: PackedInt64Array = answer[1]
	print("client: %d trees within %.0f m" % [ids.size(), RADIUS])
	var felled := Array(ids)
	felled.sort_custom(func(a: int, b: int) -> bool: return _distance(a, point) < _distance(b, point))
	felled.resize(mini(count, felled.size()))
	for id: int in felled:
		session.call(&"fell", id)
	while felled.any(world.has_instance):
		await session.synced
	print("client: felled %s" % str(felled))


func _distance(id: int, point: Vector3) -> float:
	return world.get_instance(id).position.distance_to(point)


func _end(message: String) -> void:
	if message != "":
		printerr("client: " + message)
	get_tree().quit(0 if message == "" else 1)
