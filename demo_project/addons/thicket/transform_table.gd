@tool
extends RefCounted
## Reads transforms from a text table. Each line has one transform, with values separated by commas, semicolons or tabs.
##
## If there is no header, or if none of its names is known, the number of columns determines their meaning:
## [br]- 3: a position, in meters;
## [br]- 6: a position, and a rotation in degrees as in [member Node3D.rotation_degrees];
## [br]- 7: a position, a rotation and a scale;
## [br]- 9: a position, a rotation and a scale for each axis;
## [br]- 12: the rows of the basis, each followed by a coordinate of the origin, as in [member MultiMesh.buffer].
## [br]A header may name the columns, in any order: x, y, z (or position_x, ...), rotation_x, ... (or rx, ...), scale, or scale_x, ...
## (or sx, ...). The positions are required; other missing columns mean a rotation of 0 or a scale of 1. An unknown name among known ones is an
## error. Lines that are empty or begin with # are skipped.

const FLOATS := 12
const MAX_PROBLEMS := 5
## The maximum absolute value of a number. A larger number is reported as an error.
const MAX_VALUE := 1e9
const COLUMNS: PackedStringArray = [
	"position_x", "position_y", "position_z", "rotation_x", "rotation_y", "rotation_z", "scale_x", "scale_y", "scale_z",
]
const SYNONYMS: Dictionary[String, String] = {
	"x": "position_x", "y": "position_y", "z": "position_z", "rx": "rotation_x", "ry": "rotation_y", "rz": "rotation_z",
	"sx": "scale_x", "sy": "scale_y", "sz": "scale_z",
}
const UNIFORM_SCALE := "scale"
const COUNTS: Array[int] = [3, 6, 7, 9, 12]

## The transforms, 12 floats for each line, as in [member MultiMesh.buffer]. Empty if there are problems.
var transforms := PackedFloat32Array()
## The first few errors, each with the line and the value.
var problems := PackedStringArray()

var _separator := ","
var _plain_line := RegEx.new() ## Matches a line of plain numbers, the most frequent case.
## The meaning of each column: an index in COLUMNS, or -1 for the scale of all axes.
var _columns: Array[int] = []
var _names: PackedStringArray = []


func read(text: String) -> void:
	transforms = PackedFloat32Array()
	problems = PackedStringArray()
	_columns.clear()
	_names.clear()
	var lines := text.trim_prefix("\ufeff").split("\n")
	for index in lines.size():
		var line := lines[index].strip_edges()
		if line.is_empty() or line.begins_with("#"):
			continue
		if _names.is_empty():
			if _read_first_line(line, index + 1):
				continue
			if not problems.is_empty():
				break
		var values := _values_of(line, index + 1)
		if not values.is_empty():
			_append(values)
		if problems.size() >= MAX_PROBLEMS:
			break
	if not problems.is_empty():
		transforms = PackedFloat32Array()


## Determines the meaning of the columns from the first line. Returns true if the line is a header, which has no transform.
func _read_first_line(line: String, line_number: int) -> bool:
	_separator = "\t" if "\t" in line else ";" if ";" in line else ","
	var number_form := "\\s*[+-]?(\\d+\\.?\\d*|\\.\\d+)([eE][+-]?\\d+)?\\s*"
	_plain_line.compile("^%s(%s%s)*$" % [number_form, _separator, number_form])
	var fields := _fields(line)
	var is_header := fields.all(func(field: String) -> bool: return not field.is_valid_float())
	var known_count := 0
	for field in fields:
		var column: String = SYNONYMS.get(field.to_lower(), field.to_lower())
		known_count += int(COLUMNS.has(column) or column == UNIFORM_SCALE)
	if is_header and known_count > 0:
		_read_header(fields, line_number)
	elif COUNTS.has(fields.size()):
		_set_columns(fields.size())
	else:
		problems.append("line %d: the number of columns must be 3, 6, 7, 9 or 12, got %d" % [line_number, fields.size()])
	return is_header


func _read_header(fields: Array[String], line_number: int) -> void:
	for field in fields:
		var column: String = SYNONYMS.get(field.to_lower(), field.to_lower())
		if not COLUMNS.has(column) and column != UNIFORM_SCALE:
			problems.append("line %d: no column is called '%s'; known are %s and scale" % [line_number, field, ", ".join(COLUMNS)])
		elif _names.has(column):
			problems.append("line %d: '%s' appears twice; name each column once" % [line_number, field])
		_names.append(column)
		_columns.append(COLUMNS.find(column))
	for column in COLUMNS.slice(0, 3):
		if not _names.has(column):
			problems.append("line %d: there is no column '%s'; x, y and z are required" % [line_number, column])


func _set_columns(count: int) -> void:
	for index in count:
		_names.append("number %d" % (index + 1) if count == FLOATS else UNIFORM_SCALE if count == 7 and index == 6 else COLUMNS[index])
		_columns.append(-1 if _names[-1] == UNIFORM_SCALE else index)


func _fields(line: String) -> Array[String]:
	var result: Array[String] = []
	for field in line.split(_separator):
		result.append(field.strip_edges().trim_prefix("\"").trim_suffix("\""))
	return result


## Returns the numbers in a line. If the line has an error, adds a problem and returns no numbers.
func _values_of(line: String, line_number: int) -> PackedFloat64Array:
	if _plain_line.search(line) != null:
		var values := line.split_floats(_separator)
		var sorted := values.duplicate()
		sorted.sort()
		if values.size() == _columns.size() and sorted[0] >= -MAX_VALUE and sorted[-1] <= MAX_VALUE:
			return values
	return _parse_fields(line, line_number)


## Reads the values of a line that contains quotes or has an error.
func _parse_fields(line: String, line_number: int) -> PackedFloat64Array:
	var fields := _fields(line)
	if fields.size() != _columns.size():
		problems.append("line %d: the number of values must be %d, got %d" % [line_number, _columns.size(), fields.size()])
		return PackedFloat64Array()
	var values := PackedFloat64Array()
	for index in fields.size():
		if not fields[index].is_valid_float():
			problems.append("line %d: %s is '%s', which is not a number; write it with a decimal point" % [line_number, _names[index], fields[index]])
			return PackedFloat64Array()
		values.append(fields[index].to_float())
		if not absf(values[-1]) <= MAX_VALUE:
			problems.append("line %d: %s is %s, which is beyond 10^9; numbers must be between -10^9 and 10^9" % [line_number, _names[index], fields[index]])
			return PackedFloat64Array()
	return values


func _append(values: PackedFloat64Array) -> void:
	if _columns.size() == FLOATS:
		transforms.append_array(PackedFloat32Array(Array(values)))
		return
	var values_by_part := PackedFloat64Array([0, 0, 0, 0, 0, 0, 1, 1, 1])
	for index in values.size():
		if _columns[index] >= 0:
			values_by_part[_columns[index]] = values[index]
		else:
			values_by_part[6] = values[index]
			values_by_part[7] = values[index]
			values_by_part[8] = values[index]
	var rotation := Basis.from_euler(Vector3(deg_to_rad(values_by_part[3]), deg_to_rad(values_by_part[4]), deg_to_rad(values_by_part[5])))
	var x := rotation.x * values_by_part[6]
	var y := rotation.y * values_by_part[7]
	var z := rotation.z * values_by_part[8]
	transforms.append_array(PackedFloat32Array([
		x.x, y.x, z.x, values_by_part[0], x.y, y.y, z.y, values_by_part[1], x.z, y.z, z.z, values_by_part[2],
	]))
