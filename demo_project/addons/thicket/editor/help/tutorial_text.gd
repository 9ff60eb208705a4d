@tool
extends RefCounted
## Converts a tutorial from Markdown to BBCode for a [RichTextLabel]. Only the Markdown syntax that the tutorials use is supported.

const PICTURE := "^!\\[(?<words>[^\\]]*)\\]\\((?<file>[^)]+)\\)$"
const ITEM := "^(?<indent> *)(?<mark>-|\\d+\\.) (?<text>.*)$"
const INLINE := "`(?<code>[^`]+)`|\\*\\*(?<bold>.+?)\\*\\*|\\*(?<italic>[^*]+)\\*|\\[(?<words>[^\\]]+)\\]\\((?<link>[^)]+)\\)"

## The size of a first-level heading in pixels; a second-level heading has three quarters of this size.
var heading_size := 28

## The result. Each part is BBCode, or [constant PICTURE_MARK] followed by the file name of an image.
var parts := PackedStringArray()

const PICTURE_MARK := "picture:"

var _picture := RegEx.create_from_string(PICTURE)
var _item := RegEx.create_from_string(ITEM)
var _inline := RegEx.create_from_string(INLINE)
var _block := "" ## The text of the current paragraph or list item.
var _bullet := ""
var _indent := 0


## Returns the title of a page, which is its first line.
static func title(markdown: String) -> String:
	return markdown.get_slice("\n", 0).trim_prefix("# ").strip_edges()


## Converts a page and stores the result in [member parts].
func read(markdown: String) -> void:
	parts.clear()
	var code := PackedStringArray()
	var in_code := false
	for line in markdown.replace("\r", "").split("\n"):
		if line.begins_with("```"):
			_flush()
			if in_code:
				_add("[indent][code]%s[/code][/indent]\n\n" % _escaped("\n".join(code)))
			code.clear()
			in_code = not in_code
		elif in_code:
			code.append(line)
		else:
			_read_line(line)
	_flush()


func _read_line(line: String) -> void:
	var picture := _picture.search(line)
	var item := _item.search(line)
	if picture != null:
		_flush()
		parts.append(PICTURE_MARK + picture.get_string("file"))
	elif line.begins_with("#"):
		_flush()
		var size := heading_size if line.begins_with("# ") else heading_size * 3 / 4
		_add("[font_size=%d][b]%s[/b][/font_size]\n\n" % [size, _inline_bbcode(line.lstrip("# "))])
	elif item != null:
		_flush()
		_indent = 1 + item.get_string("indent").length() / 2
		_bullet = "•" if item.get_string("mark") == "-" else item.get_string("mark")
		_block = item.get_string("text")
	elif line.strip_edges().is_empty():
		_flush()
	else:
		_block += ("" if _block.is_empty() else " ") + line.strip_edges()


## Ends the current paragraph or list item.
func _flush() -> void:
	if not _block.is_empty():
		var text := _inline_bbcode(_block)
		if _bullet.is_empty():
			_add(text + "\n\n")
		else:
			_add("%s%s %s%s\n\n" % ["[indent]".repeat(_indent), _bullet, text, "[/indent]".repeat(_indent)])
	_block = ""
	_bullet = ""
	_indent = 0


func _add(bbcode: String) -> void:
	if parts.is_empty() or parts[-1].begins_with(PICTURE_MARK):
		parts.append(bbcode)
	else:
		parts[-1] += bbcode


func _inline_bbcode(text: String) -> String:
	var result := ""
	var position := 0
	for element in _inline.search_all(text):
		result += _escaped(text.substr(position, element.get_start() - position))
		position = element.get_end()
		if not element.get_string("code").is_empty():
			result += "[code]%s[/code]" % _escaped(element.get_string("code"))
		elif not element.get_string("bold").is_empty():
			result += "[b]%s[/b]" % _inline_bbcode(element.get_string("bold"))
		elif not element.get_string("italic").is_empty():
			result += "[i]%s[/i]" % _inline_bbcode(element.get_string("italic"))
		else:
			result += "[url=%s]%s[/url]" % [element.get_string("link"), _inline_bbcode(element.get_string("words"))]
	return result + _escaped(text.substr(position))


static func _escaped(text: String) -> String:
	return text.replace("[", "[lb]")
