@tool
extends RefCounted
## Formats numbers as text.


## Returns a number with thousands separators, such as 1,234,567.
static func grouped(number: int) -> String:
	var text := str(number)
	for position in range(text.length() - 3, 0, -3):
		text = text.insert(position, ",")
	return text
