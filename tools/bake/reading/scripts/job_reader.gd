extends RefCounted
## Reads jobs from the standard input in the format of piped_script.py. A job consists of the length of a JSON string in
## 4 bytes, the string, which encodes a dictionary, and as many bytes as the dictionary's "bytes" field specifies.

const ANSWER := "thicket answer "
const MAX_CHUNK := 1 << 20

## The last job.
var job: Dictionary = {}
## The bytes of the last job.
var payload := PackedByteArray()


## Waits for the next job. Returns false if there are no more jobs.
func read() -> bool:
	var length := _read(4)
	if length.size() < 4:
		return false
	job = JSON.parse_string(_read(length.decode_u32(0)).get_string_from_utf8())
	payload = _read(int(job.bytes))
	return payload.size() == int(job.bytes)


## Sends the answer to the last job.
func answer(content: Dictionary) -> void:
	print(ANSWER, JSON.stringify(content))


func _read(count: int) -> PackedByteArray:
	var result := PackedByteArray()
	while result.size() < count:
		var chunk := OS.read_buffer_from_stdin(mini(count - result.size(), MAX_CHUNK))
		if chunk.is_empty():
			break
		result.append_array(chunk)
	return result
