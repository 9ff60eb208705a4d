extends RefCounted
## A file of a baked world: a JSON object and bytes, preceded by the SHA-256 of both. Reading one runs no code from it.
##
## A file is never loaded with the engine's [ResourceLoader], which runs the scripts that a resource contains. It begins with 48 bytes:
## [constant MAGIC], the version (32 bits, little-endian like all numbers), the SHA-256 of everything after it (32 bytes), the length of the JSON
## text, and the size of the unpacked bytes. The text and the bytes, packed with Zstandard, follow.

const MAGIC := "THBW"
const VERSION := 1
## The extension of these files.
const EXTENSION := "baked"
## The largest size of a file, and of its unpacked bytes.
const MOST_BYTES := 1 << 30
const MOST_CHARACTERS := 1000
const _START := 48 # Where the JSON text begins.
const _HASHED_FROM := 40
const _HASHED_AT_ONCE := 1 << 16

## The error of the file, or of a field that was read from it; empty if there is none.
var problem := ""
## The JSON object.
var header: Dictionary = {}
## The unpacked bytes.
var payload := PackedByteArray()
## The SHA-256 of the text and the packed bytes.
var digest := PackedByteArray()


## The content of a file with this header and payload, as [method read] expects it.
static func packed(content: Dictionary, bytes: PackedByteArray) -> PackedByteArray:
	var text := JSON.stringify(content, "", true, true).to_utf8_buffer()
	var body := PackedByteArray()
	body.resize(8)
	body.encode_u32(0, text.size())
	body.encode_u32(4, bytes.size())
	body.append_array(text)
	if not bytes.is_empty():
		body.append_array(bytes.compress(FileAccess.COMPRESSION_ZSTD))
	var result := MAGIC.to_ascii_buffer()
	result.resize(8)
	result.encode_u32(4, VERSION)
	result.append_array(_sha256(body, 0))
	result.append_array(body)
	return result


## The SHA-256 that [method packed] wrote into a file's content.
static func digest_in(content: PackedByteArray) -> PackedByteArray:
	return content.slice(8, _HASHED_FROM)


## Reads a file and checks that it is complete and undamaged. Otherwise returns false and sets [member problem]. May be called from any thread.
func read(path: String) -> bool:
	var file := FileAccess.open(path, FileAccess.READ)
	if file == null:
		return _refuse("it cannot be opened (%s)" % error_string(FileAccess.get_open_error()))
	var length := file.get_length()
	if length < _START or length > MOST_BYTES:
		return _refuse("it must have %d to %d bytes, got %d" % [_START, MOST_BYTES, length])
	var bytes := file.get_buffer(length)
	if bytes.size() != length or bytes.slice(0, 4) != MAGIC.to_ascii_buffer():
		return _refuse("it is not a file of a baked world")
	if bytes.decode_u32(4) != VERSION:
		return _refuse("its version must be %d, got %d" % [VERSION, bytes.decode_u32(4)])
	digest = _sha256(bytes, _HASHED_FROM)
	if digest_in(bytes) != digest:
		return _refuse("it is damaged: its SHA-256 is %s, and it must be %s" % [digest.hex_encode(), digest_in(bytes).hex_encode()])
	return _unpack(bytes)


func _unpack(bytes: PackedByteArray) -> bool:
	var text_length := bytes.decode_u32(40)
	var size := bytes.decode_u32(44)
	if text_length > bytes.size() - _START or size > MOST_BYTES:
		return _refuse("its parts must fit into the file and unpack to %d bytes at most, got %d and %d" % [MOST_BYTES, text_length, size])
	var json := JSON.new()
	if json.parse(bytes.slice(_START, _START + text_length).get_string_from_utf8()) != OK or not json.data is Dictionary:
		return _refuse("its header must be a JSON object")
	header = json.data
	if size > 0:
		payload = bytes.slice(_START + text_length).decompress(size, FileAccess.COMPRESSION_ZSTD)
	return payload.size() == size or _refuse("its bytes must unpack to %d, got %d" % [size, payload.size()])


## Reads a field that must be a finite number in this range. Otherwise returns [param least] and sets [member problem].
func number(of: Dictionary, field: String, least: float, most: float) -> float:
	var value: Variant = of.get(field)
	if _is_number(value) and value >= least and value <= most:
		return value
	_refuse("%s must be a number from %s to %s, got %s" % [field, String.num(least), String.num(most), _shown(value)])
	return least


## Like [method number], for whole numbers.
func whole(of: Dictionary, field: String, least: int, most: int) -> int:
	var value := number(of, field, least, most)
	if value != floorf(value):
		_refuse("%s must be a whole number, got %s" % [field, String.num(value)])
	return int(value)


## Reads a field that must be a string. Otherwise returns an empty string and sets [member problem].
func text(of: Dictionary, field: String) -> String:
	var value: Variant = of.get(field)
	if value is String and (value as String).length() <= MOST_CHARACTERS:
		return value
	_refuse("%s must be a text of %d characters at most, got %s" % [field, MOST_CHARACTERS, _shown(value)])
	return ""


## Reads a field that must be true or false. Otherwise returns false and sets [member problem].
func flag(of: Dictionary, field: String) -> bool:
	var value: Variant = of.get(field)
	return value if value is bool else _refuse("%s must be true or false, got %s" % [field, _shown(value)])


## Reads a field that must be an array whose elements all have this type. Otherwise returns an empty array and sets [member problem].
func list(of: Dictionary, field: String, type: Variant.Type) -> Array:
	var value: Variant = of.get(field)
	if value is Array and (value as Array).all(func(element: Variant) -> bool: return typeof(element) == type):
		return value
	_refuse("%s must be an array with elements of type %s, got %s" % [field, type_string(type), _shown(value)])
	return []


## Reads a field that must be an array of [param count] finite numbers. Otherwise returns zeros and sets [member problem].
func numbers(of: Dictionary, field: String, count: int) -> PackedFloat64Array:
	var value: Variant = of.get(field)
	if value is Array and (value as Array).size() == count and (value as Array).all(_is_number):
		return PackedFloat64Array(value as Array)
	_refuse("%s must have %d finite numbers, got %s" % [field, count, _shown(value)])
	var zeros := PackedFloat64Array()
	zeros.resize(count)
	return zeros


static func _is_number(value: Variant) -> bool:
	return (value is float or value is int) and is_finite(value)


static func _shown(value: Variant) -> String:
	return JSON.stringify(value).left(80)


static func _sha256(bytes: PackedByteArray, from: int) -> PackedByteArray:
	var hashing := HashingContext.new()
	hashing.start(HashingContext.HASH_SHA256)
	while from < bytes.size():
		hashing.update(bytes.slice(from, from + _HASHED_AT_ONCE))
		from += _HASHED_AT_ONCE
	return hashing.finish()


## Keeps the first problem only.
func _refuse(why: String) -> bool:
	problem = problem if problem else why
	return false
