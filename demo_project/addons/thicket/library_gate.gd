@tool
extends RefCounted
## The one way from scripts that must compile without the native library to what needs it: on a platform that the library is not built for,
## in a checkout that is not built yet, in a game that shows a baked world alone.
##
## Scripts that name the library's classes as types are in the folders [constant TYPED], and [method load_script] loads them. Each of these
## has a [code].gdignore[/code]: the editor compiles every script that it indexes, for the class reference, and prints an error for each
## unknown type. An ignored folder is no part of an exported game, so scripts that games use stay outside. They name no class of the
## library, and call its objects by the functions below.

const ADDON := "res://addons/thicket/"
## Folders of scripts that need the library, in [constant ADDON], with the folders below them.
const TYPED: PackedStringArray = ["editor", "baking"]
const SCATTER := &"TerrainScatter3D"


## True while the library is loaded.
static func is_open() -> bool:
	return ClassDB.class_exists(SCATTER)


## The script at [param path] in [constant ADDON], of a folder of [constant TYPED]; null while the library is not loaded, and where the
## script does not fit the loaded library.
static func load_script(path: String) -> GDScript:
	if not is_open():
		return null
	var script := load(ADDON + path) as GDScript
	return script if script != null and script.can_instantiate() else null


## Why [method load_script] returned null, and what to do, in sentences.
static func problem() -> String:
	if is_open():
		return "Thicket's scripts do not fit the native library that is loaded. Install the whole add-on of one version, then restart the engine."
	return "Thicket's tools are off: no native library for %s.%s is loaded. Install a release of the add-on that has one in %sbin, or " % [
			OS.get_name().to_lower(), Engine.get_architecture_name(), ADDON] + "build it with \"scons extension\"."


## True for a [code]TerrainScatter3D[/code].
static func is_scatter(node: Node) -> bool:
	return node.is_class(SCATTER)


## The layers of a [code]TerrainScatter3D[/code], those of its biomes last; null where an entry is empty.
static func layers_of(scatter: Node) -> Array[Resource]:
	var result: Array[Resource] = []
	for index: int in scatter.call(&"get_layer_count"):
		result.append(scatter.call(&"get_layer", index))
	return result


## All materials that a [code]ScatterLayer[/code] is drawn with.
static func materials_of(layer: Resource) -> Array[Material]:
	return layer.call(&"get_materials")
