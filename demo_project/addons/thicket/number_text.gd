@tool
extends RefCounted
## Numbers as text.


## 1234567 as 1,234,567.
static func grouped(number: int) -> String:
	var text := str(number)
	for at in range(text.length() - 3, 0, -3):
		text = text.insert(at, ",")
	return text
