extends SceneTree
## Generates tiles of a scene's [code]TerrainScatter3D[/code], into a folder or for a driver in a different program:
## [codeblock]
## godot --headless --path PROJECT --script res://addons/thicket/bake_world.gd -- scene=res://world.tscn out=/FOLDER rect=-512,-512,1024,1024
## godot --headless --path PROJECT --script res://addons/thicket/bake_world.gd -- scene=res://world.tscn connect=PORT token=WORD
## [/codeblock]
## Without arguments it prints a list of its arguments. Without the native library it exits with code 2.

const LibraryGate := preload("res://addons/thicket/library_gate.gd")

var _baking: RefCounted # An object of baking/world_baking.gd.


func _initialize() -> void:
	var script := LibraryGate.load_script("baking/world_baking.gd")
	if script == null:
		printerr("bake_world: ", LibraryGate.problem())
		quit(2)
		return
	_baking = script.new(self)
	_baking.run.call_deferred()
