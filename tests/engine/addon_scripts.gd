extends SceneTree
## Checks the add-on's scripts against the library's classes: `godot --headless --path PROJECT --script addon_scripts.gd -- PART`. PART is
## `compile`, `names` or `renamed`. Prints a line that starts with "WRONG" for each error. The last line is
## "addon scripts: N looked at, M wrong".

const ADDON := "res://addons/thicket/"
const GATE := ADDON + "library_gate.gd"
## Variables that hold objects of the library in scripts that must compile without it. These scripts may access members only by name, and
## only through these variables. Maps each variable to the class of its value.
const UNTYPED: Dictionary[String, StringName] = {
	"scatter": &"TerrainScatter3D", "_scatter": &"TerrainScatter3D",
	"layer": &"ScatterLayer", "_layer": &"ScatterLayer", "target_layer": &"ScatterLayer",
	"model": &"ScatterModel", "tile_instances": &"ScatterTile", "grid": &"ScatterTileGrid", "lod": &"ScatterLod",
	"_baker": &"ScatterImpostorBaker", "ground": &"ScatterGround", "combined": &"ScatterGroundCombined", "explanation": &"ScatterExplanation",
}
## Variables, by script, that this test does not check. They hold objects of Terrain3D or no objects, but use names that members of the
## library also have.
const FOREIGN: Dictionary[String, PackedStringArray] = {
	"import_instances.gd": ["node", "terrain", "data", "region", "asset", "Object", "appearance"],
}
## Members that gated scripts may access by name, because only some of the possible objects have them: the rect of some ground classes,
## a path's curve, the virtual method that a rule's script may have, and the members of other plugins' terrains.
const DYNAMIC: Dictionary[String, PackedStringArray] = {
	"scene_description.gd": ["rect"], "scene_digest.gd": ["curve", "_get_densities"],
	"ground_buttons.gd": ["generate_collisions", "collision_layer", "data", "getHeightAtPosition", "get_internal_transform", "get_data",
		"get_height", "get_voxel_tool", "is_area_meshed"],
}
## Matches calls that take a member's name as a string.
const BY_NAME := "(\\w+|\\])\\)?\\.(?:[gs]et(?:_deferred|_indexed)?|callv?(?:_deferred)?|has_(?:method|signal)|(?:dis)?connect|emit_signal)" \
		+ "\\(&?\"(\\w+)\""
const UNDO := "add_(?:do|undo)_(property|method)\\((\\w+), &\"(\\w+)\""
const STRING_NAME := "&\"([a-z_]\\w*)\""
const CONSTANT := "&\"([A-Z][A-Z0-9_]+)\""
const CLASS_NAME := "\"((?:TerrainScatter3D|Scatter|Poisson|Impostor)[A-Z]\\w*|TerrainScatter3D)\""
const MEMBER := "\\.([a-z_]\\w*)\\b"
const NO_CLASSES: PackedStringArray = ["ScatterOutput"] ## A node class of ProtonScatter.
## Names that are not members of any class, such as metadata and theme items.
const WORDS: PackedStringArray = ["icon", "index", "hidden", "locked", "color", "source", "mono_font", "prop_subsection", "font_color",
	"h_separation", "script"]

var _own: Dictionary[String, bool] = {} ## The members of the library's classes, as a set.
var _constants: Dictionary[String, bool] = {}
var _looked := 0
var _wrong := 0


func _initialize() -> void:
	for type in ClassDB.get_class_list():
		if ClassDB.class_get_api_type(type) in [ClassDB.API_EXTENSION, ClassDB.API_EDITOR_EXTENSION]:
			for list: Array[Dictionary] in [ClassDB.class_get_property_list(type, true), ClassDB.class_get_method_list(type, true),
					ClassDB.class_get_signal_list(type, true)]:
				for member in list:
					_own[member.name] = true
			for constant in ClassDB.class_get_integer_constant_list(type, true):
				_constants[constant] = true
	var part: String = OS.get_cmdline_user_args()[0]
	for path in _scripts(ADDON):
		match part:
			"compile": _compile(path)
			"names": _check_names(path, _without_comments(FileAccess.get_file_as_string(path)))
			"renamed": _rename_members(path)
	if part == "names":
		for folder in _typed_folders():
			_check(FileAccess.file_exists(ADDON + folder + "/.gdignore"), folder, "the editor indexes this folder, because it has no .gdignore file")
	print("addon scripts: %d looked at, %d wrong" % [_looked, _wrong])
	quit()


func _scripts(folder: String) -> PackedStringArray:
	var result := PackedStringArray()
	for file in DirAccess.get_files_at(folder):
		if file.get_extension() == "gd":
			result.append(folder + file)
	for inner in DirAccess.get_directories_at(folder):
		result.append_array(_scripts(folder + inner + "/"))
	return result


## Returns true if the library gate (library_gate.gd) loads a script. Such a script may use the library's classes as types.
static func _is_typed(path: String) -> bool:
	return path.trim_prefix(ADDON).get_slice("/", 0) in _typed_folders()


static func _typed_folders() -> PackedStringArray:
	return (load(GATE) as GDScript).get_script_constant_map()["TYPED"]


func _compile(path: String) -> void:
	_looked += 1
	var script := load(path) as GDScript
	_check(script != null and script.can_instantiate(), path, "it does not compile")


func _check_names(path: String, code: String) -> void:
	_looked += 1
	var seen: Dictionary[int, bool] = {} # Start positions of the names that were already checked.
	for found in RegEx.create_from_string(BY_NAME).search_all(code):
		seen[found.get_start(2)] = true
		if found.get_string(1) == "EditorInterface": # Its methods depend on the engine version.
			_check(ClassDB.class_has_method(&"EditorInterface", found.get_string(2)), path, "EditorInterface has no " + found.get_string(2))
		elif _is_typed(path):
			var name := found.get_string(2)
			_check(_is_dictionary(code, found.get_string(1)) or name in DYNAMIC.get(path.get_file(), []) or not _own.has(name)
					and code[found.get_start(2) - 2] != "&", path, "%s is accessed by name. Access it through a typed variable instead" % name)
		elif not found.get_string(1) in UNTYPED:
			_check(not _own.has(found.get_string(2)) or found.get_string(1) in FOREIGN.get(path.get_file(), []), path,
					"the class of %s, whose member %s is accessed by name, is unknown. Add the variable to UNTYPED" % [found.get_string(1), found.get_string(2)])
	for found in RegEx.create_from_string(UNDO).search_all(code):
		seen[found.get_start(3)] = true
		_check(_has_member(code, found.get_string(2), found.get_string(3)), path, "%s has no %s" % [found.get_string(2), found.get_string(3)])
	if _is_typed(path):
		for found in RegEx.create_from_string(STRING_NAME).search_all(code):
			var name := found.get_string(1)
			_check(seen.has(found.get_start(1)) or _own.has(name) or name in WORDS or _has_function(code, name)
					or _class_has(&"Resource", name) or ClassDB.class_has_method(&"EditorUndoRedoManager", name), path,
					"%s is not a member of a class of the library" % name)
	else:
		_check_untyped(path, code)
	for found in RegEx.create_from_string(CONSTANT).search_all(code):
		_check(_constants.has(found.get_string(1)), path, "no class of the library has a constant " + found.get_string(1))
	for found in RegEx.create_from_string(CLASS_NAME).search_all(code):
		_check(ClassDB.class_exists(found.get_string(1)) or found.get_string(1) in NO_CLASSES, path, "there is no class " + found.get_string(1))


## Checks that every member that an untyped script accesses through a variable in UNTYPED exists.
func _check_untyped(path: String, code: String) -> void:
	for variable in UNTYPED:
		var by_name := "\\b%s\\)?\\.(?:get|set|call)\\(&?\"(\\w+)\"" % variable
		var by_dot := "\\b%s\\.(\\w+)" % variable
		for found in RegEx.create_from_string(by_name).search_all(code) + RegEx.create_from_string(by_dot).search_all(code):
			_check(_class_has(UNTYPED[variable], found.get_string(1)), path, "%s has no %s" % [UNTYPED[variable], found.get_string(1)])


## Returns true if a script declares a variable as a Dictionary, or if the name is "Dictionary", which ends a cast.
static func _is_dictionary(code: String, variable: String) -> bool:
	return variable == "Dictionary" or RegEx.create_from_string("\\b%s: Dictionary\\b" % variable).search(code) != null


## Returns true if the declared type of a script's variable, a class or a preloaded script, has a member.
func _has_member(code: String, variable: String, member: String) -> bool:
	if variable == "self":
		return _has_function(code, member)
	var types := PackedStringArray(["Node"])
	for found in RegEx.create_from_string("\\b%s(?:: | := (?:.* as )?)([A-Z]\\w+)" % variable).search_all(code):
		types.append(found.get_string(1))
	for type in types:
		var loaded := RegEx.create_from_string("const %s := preload\\(\"(res://[^\"]+)\"\\)" % type).search(code)
		if loaded != null and _has_function(FileAccess.get_file_as_string(loaded.get_string(1)), member):
			return true
		if ClassDB.class_exists(type) and _class_has(type, member):
			return true
	return false


static func _class_has(type: StringName, member: String) -> bool:
	return ClassDB.class_has_method(type, member) or ClassDB.class_has_signal(type, member) \
			or ClassDB.class_get_property_list(type).any(func(property: Dictionary) -> bool: return property.name == member)


static func _has_function(code: String, name: String) -> bool:
	return RegEx.create_from_string("(?m)^(?:static )?func %s\\(" % name).search(code) != null


## Renames each use of a library member, one at a time, and compiles the script. Compilation must fail. If it succeeds, the use is untyped,
## and a renamed member would only fail at run time.
func _rename_members(path: String) -> void:
	if not _is_typed(path):
		return
	var source := FileAccess.get_file_as_string(path)
	for found in RegEx.create_from_string(MEMBER).search_all(_without_strings(_without_comments(source))):
		if _own.has(found.get_string(1)):
			_looked += 1
			var script := GDScript.new()
			script.source_code = source.insert(found.get_end(), "_renamed")
			script.take_over_path(path.get_base_dir() + "/renamed_%d.gd" % _looked) # The warning settings depend on the path.
			var line := source.count("\n", 0, found.get_start()) + 1
			_check(script.reload() != OK, path, "line %d compiles although %s was renamed" % [line, found.get_string(1)])


func _check(condition: bool, path: String, message: String) -> void:
	if not condition:
		_wrong += 1
		print("WRONG %s: %s" % [path.trim_prefix(ADDON), message])


static func _without_comments(source: String) -> String:
	return _blanked(source, "(\"(?:[^\"\\\\]|\\\\.)*\")|#[^\\n]*")


static func _without_strings(code: String) -> String:
	return _blanked(code, "()\"(?:[^\"\\\\]|\\\\.)*\"")


## Replaces each match of a pattern with spaces, unless the pattern's first group matched.
static func _blanked(text: String, pattern: String) -> String:
	var result := ""
	var end := 0
	for found in RegEx.create_from_string(pattern).search_all(text):
		result += text.substr(end, found.get_start() - end)
		result += found.get_string() if found.get_string(1) else " ".repeat(found.get_string().length())
		end = found.get_end()
	return result + text.substr(end)
