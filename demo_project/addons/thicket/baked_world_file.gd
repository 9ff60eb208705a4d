extends RefCounted
## A file of a baked world: a JSON object and bytes, preceded by the SHA-256 of both. Reading a file runs no code.
##
## The engine's [ResourceLoader] never loads these files, because it would run scripts that a resource contains. A file
## begins with 48 bytes: [constant MAGIC], the version (32 bits, little-endian like all numbers), the SHA-256 of
## everything after the hash (32 bytes), the length of the JSON text, and the size of the uncompressed bytes. The JSON
## text and the bytes, compressed with Zstandard, follow.

const MAGIC := "THBW"
const VERSION := 1
## The extension of these files.
const EXTENSION := "baked"
## The largest size of a file, and of its uncompressed payload.
const MOST_BYTES := 1 << 30
const MOST_CHARACTERS := 1000
const _START := 48 # The offset of the JSON text.
const _HASHED_FROM := 40
const _HASHED_AT_ONCE := 1 << 16

## The first error in the file or in a field that was read from it; empty if there is none.
var problem := ""
## The JSON object.
var header: Dictionary = {}
## The uncompressed bytes.
var payload := PackedByteArray()
## The SHA-256 of the file from byte 40 on: the two lengths, the text and the compressed bytes.
var digest := PackedByteArray()


## Returns the content of a file with this header and payload, as [method read] expects it.
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


## Returns the SHA-256 that is stored in a file's content.
static func digest_in(content: PackedByteArray) -> PackedByteArray:
	return content.slice(8, _HASHED_FROM)


## Reads a file and checks that it is complete and undamaged. Returns true on success. Otherwise, sets [member problem]. May be called on any thread.
func read(path: String) -> bool:
	var file := FileAccess.open(path, FileAccess.READ)
	if file == null:
		return _fail("it cannot be opened (%s)" % error_string(FileAccess.get_open_error()))
	var length := file.get_length()
	if length < _START or length > MOST_BYTES:
		return _fail("it must have %d to %d bytes, got %d" % [_START, MOST_BYTES, length])
	var bytes := file.get_buffer(length)
	if bytes.size() != length or bytes.slice(0, 4) != MAGIC.to_ascii_buffer():
		return _fail("it is not a file of a baked world")
	if bytes.decode_u32(4) != VERSION:
		return _fail("its version must be %d, got %d" % [VERSION, bytes.decode_u32(4)])
	digest = _sha256(bytes, _HASHED_FROM)
	if digest_in(bytes) != digest:
		return _fail("it is damaged: its SHA-256 must be %s, got %s" % [digest_in(bytes).hex_encode(), digest.hex_encode()])
	return _unpack(bytes)


func _unpack(bytes: PackedByteArray) -> bool:
	var text_length := bytes.decode_u32(40)
	var payload_size := bytes.decode_u32(44)
	if text_length > bytes.size() - _START or payload_size > MOST_BYTES:
		return _fail("its header must fit into the file, and its payload must unpack to at most %d bytes, got %d and %d bytes" % [
			MOST_BYTES, text_length, payload_size])
	var json := JSON.new()
	if json.parse(bytes.slice(_START, _START + text_length).get_string_from_utf8()) != OK or not json.data is Dictionary:
		return _fail("its header must be a JSON object")
	header = json.data
	if payload_size > 0:
		payload = bytes.slice(_START + text_length).decompress(payload_size, FileAccess.COMPRESSION_ZSTD)
	return payload.size() == payload_size or _fail("its payload must unpack to %d bytes, got %d" % [payload_size, payload.size()])


## Returns a field that must be a finite number from [param least] to [param most]. Otherwise, sets [member problem] and returns [param least].
func number(object: Dictionary, field: String, least: float, most: float) -> float:
	var value: Variant = object.get(field)
	if _is_number(value) and value >= least and value <= most:
		return value
	_fail("%s must be a number from %s to %s, got %s" % [field, String.num(least), String.num(most), _as_text(value)])
	return least


## Returns a field that must be an integer from [param least] to [param most]. Otherwise, sets [member problem] and returns an integer in this range.
func whole(object: Dictionary, field: String, least: int, most: int) -> int:
	var value := number(object, field, least, most)
	if value != floorf(value):
		_fail("%s must be a whole number, got %s" % [field, String.num(value)])
	return int(value)


## Returns a field that must be a string of at most [constant MOST_CHARACTERS]. Otherwise, sets [member problem] and returns an empty string.
func text(object: Dictionary, field: String) -> String:
	var value: Variant = object.get(field)
	if value is String and (value as String).length() <= MOST_CHARACTERS:
		return value
	_fail("%s must be a string of at most %d characters, got %s" % [field, MOST_CHARACTERS, _as_text(value)])
	return ""


## Returns a field that must be true or false. Otherwise, sets [member problem] and returns false.
func flag(object: Dictionary, field: String) -> bool:
	var value: Variant = object.get(field)
	return value if value is bool else _fail("%s must be true or false, got %s" % [field, _as_text(value)])


## Returns a field that must be an array whose elements all have this type. Otherwise, sets [member problem] and returns an empty array.
func list(object: Dictionary, field: String, type: Variant.Type) -> Array:
	var value: Variant = object.get(field)
	if value is Array and (value as Array).all(func(element: Variant) -> bool: return typeof(element) == type):
		return value
	_fail("%s must be an array with elements of type %s, got %s" % [field, type_string(type), _as_text(value)])
	return []


## Returns a field that must be an array of [param count] finite numbers. Otherwise, sets [member problem] and returns zeros.
func numbers(object: Dictionary, field: String, count: int) -> PackedFloat64Array:
	var value: Variant = object.get(field)
	if value is Array and (value as Array).size() == count and (value as Array).all(_is_number):
		return PackedFloat64Array(value as Array)
	_fail("%s must have %d finite numbers, got %s" % [field, count, _as_text(value)])
	var zeros := PackedFloat64Array()
	zeros.resize(count)
	return zeros


static func _is_number(value: Variant) -> bool:
	return (value is float or value is int) and is_finite(value)


static func _as_text(value: Variant) -> String:
	return JSON.stringify(value).left(80)


static func _sha256(bytes: PackedByteArray, from: int) -> PackedByteArray:
	var hashing := HashingContext.new()
	hashing.start(HashingContext.HASH_SHA256)
	while from < bytes.size():
		hashing.update(bytes.slice(from, from + _HASHED_AT_ONCE))
		from += _HASHED_AT_ONCE
	return hashing.finish()


## Sets [member problem], unless an earlier one is set, and returns false.
func _fail(message: String) -> bool:
	problem = problem if problem else message
	return false
