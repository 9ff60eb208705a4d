extends Node
## A server for the gameplay scene's world, without player, camera and renderer. It generates only the tiles that
## queries need.
##   godot --headless --path demo_project res://gameplay/server.tscn -- --port=4433
##
## Arguments after [code]--[/code]: [code]--port=NUMBER[/code] sets the port (4433 by default, 0 for a free port), and
## [code]--state=FILE[/code] loads earlier changes and saves all changes whenever a client leaves.

const DEFAULT_PORT := 4433

var _file := ""

@onready var world: TerrainScatter3D = $World
@onready var session: Node = $Session


func _ready() -> void:
	var port := DEFAULT_PORT
	for argument in OS.get_cmdline_user_args():
		if argument.begins_with("--port="):
			port = argument.trim_prefix("--port=").to_int()
		elif argument.begins_with("--state="):
			_file = argument.trim_prefix("--state=")
	if _file != "" and FileAccess.file_exists(_file):
		var error := world.state.load_from_file(_file)
		if error != OK:
			return _end("cannot load %s: %s" % [_file, error_string(error)])
	var error: Error = session.call(&"host", port)
	if error != OK:
		return _end("cannot listen on port %d: %s" % [port, error_string(error)])
	multiplayer.peer_connected.connect(func(client: int) -> void: print("server: %d has joined" % client))
	multiplayer.peer_disconnected.connect(_on_client_left)
	print("server: listening on port %d, %d felled" % [session.call(&"port"), world.state.get_removed_count()])


func _on_client_left(client: int) -> void:
	if _file != "":
		world.state.save_to_file(_file) # A failed save is logged, and the next one tries again.
	print("server: %d has left, %d felled" % [client, world.state.get_removed_count()])


func _end(message: String) -> void:
	printerr("server: " + message)
	get_tree().quit(1)
