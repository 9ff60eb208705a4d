@tool
extends RefCounted
## Loads scripts that need the native library, for scripts that must compile without it. The library may be missing on an unsupported platform, in a
## checkout that is not built yet, or in a game that only shows a baked world.
##
## Scripts that use the library's classes as types are in the folders [constant TYPED], and [method load_script] loads them. Each of these folders has
## a [code].gdignore[/code]. Otherwise the editor would compile their scripts for the class reference and print an error for each unknown type.
## Ignored folders are not exported, so scripts for games are outside of them. Those scripts do not use the library's classes as types. They access
## its objects with the functions below.

const ADDON := "res://addons/thicket/"
## The folders in [constant ADDON] whose scripts need the library, including their subfolders.
const TYPED: PackedStringArray = ["editor", "baking"]
const SCATTER := &"TerrainScatter3D"


## Returns true if the library is loaded.
static func is_open() -> bool:
	return ClassDB.class_exists(SCATTER)


## Returns the script at [param path], which is relative to [constant ADDON] and in a folder of [constant TYPED]. Returns null if the library
## is not loaded, or if the script does not match the version of the loaded library.
static func load_script(path: String) -> GDScript:
	if not is_open():
		return null
	var script := load(ADDON + path) as GDScript
	return script if script != null and script.can_instantiate() else null


## Returns the reason why [method load_script] returned null, and how to fix it.
static func problem() -> String:
	if is_open():
		return "Thicket's scripts and the loaded native library have different versions. Install all files of one version of the add-on, then restart the engine."
	return "Thicket's tools are disabled: no native library for %s.%s is loaded. Install a release of the add-on that includes one in %sbin, or " % [
			OS.get_name().to_lower(), Engine.get_architecture_name(), ADDON] + "build it with \"scons extension\"."


## Returns true if [param node] is a [code]TerrainScatter3D[/code].
static func is_scatter(node: Node) -> bool:
	return node.is_class(SCATTER)


## Returns the layers of a [code]TerrainScatter3D[/code], followed by the layers of its biomes. Empty entries are null.
static func layers_of(scatter: Node) -> Array[Resource]:
	var result: Array[Resource] = []
	result.assign(scatter.call(&"get_all_layers"))
	return result


## Returns all materials with which a [code]ScatterLayer[/code] is drawn.
static func materials_of(layer: Resource) -> Array[Material]:
	return layer.call(&"get_materials")
