extends SceneTree
## Generates tiles of a scene's [code]TerrainScatter3D[/code], into a folder or for a driver. A driver is another
## program on this machine that listens at a port and sends requests to this script, such as [code]bake.sh[/code] in
## Thicket's repository:
## [codeblock]
## godot --headless --path PROJECT --script res://addons/thicket/bake_world.gd -- scene=res://world.tscn out=/FOLDER rect=-512,-512,1024,1024
## godot --headless --path PROJECT --script res://addons/thicket/bake_world.gd -- scene=res://world.tscn connect=PORT token=WORD
## [/codeblock] Without arguments, the script prints a list of its arguments. It exits with code 2 if it cannot begin, for example because the native
## library is missing, an argument is invalid, or the driver cannot be reached. Errors in the scene are sent to the driver as answers instead. With a
## folder, the exit code is 1 if requested tiles are missing at the end.

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
