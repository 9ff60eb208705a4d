extends "queries_harness.gd"
## Base class for the thread tests. Runs calls on worker threads, and reads the threading rules that the class reference states.

const ANY := "Any number of threads may call this method"
const MAIN := "Only the main thread may call this method"
const OWNER := "One thread at a time may call this method"


## Runs a callable on a new thread, blocks until it has finished, and returns its result.
func on_thread(work: Callable) -> Variant:
	var thread := Thread.new()
	thread.start(work)
	return thread.wait_to_finish()


## Runs each callable repeatedly on its own thread, and `meanwhile` on the main thread in each frame, until the time is over and each thread has
## made a call. Returns the total number of calls on the threads.
func on_threads_for(milliseconds: int, works: Array[Callable], meanwhile := Callable()) -> int:
	var stop: Array[bool] = [false]
	var threads: Array[Thread] = []
	var has_called: Array[bool] = []
	has_called.resize(works.size())
	for index in works.size():
		var thread := Thread.new()
		thread.start(func() -> int:
			var calls := 0
			while not stop[0]:
				works[index].call()
				calls += 1
				has_called[index] = true
			return calls)
		threads.push_back(thread)
	var start := Time.get_ticks_msec()
	while Time.get_ticks_msec() - start < (IDLE_TIMEOUT_MSEC if has_called.has(false) else milliseconds):
		await process_frame
		if meanwhile.is_valid():
			meanwhile.call()
	stop[0] = true
	var sum := 0
	for thread in threads:
		sum += thread.wait_to_finish() as int
	return sum


## Returns the distinct errors since the last check.
func take_kinds() -> PackedStringArray:
	var kinds := PackedStringArray()
	for message in errors.take():
		if not kinds.has(message):
			kinds.push_back(message)
	return kinds


## Checks that errors were printed since the last check, and that each contains at least one of these words.
func check_only_errors(words: Array, context: String) -> void:
	var kinds := take_kinds()
	check(not kinds.is_empty(), context + ": rejected")
	for message in kinds:
		check(words.any(func(word: String) -> bool: return word in message), "%s: %s" % [context, message])


## Reads the class reference. Returns {class: {method: description}}, with the description of the class under "".
func read_pages() -> Dictionary[String, Dictionary]:
	var pages: Dictionary[String, Dictionary] = {}
	var folder := (get_script() as Script).resource_path.get_base_dir().path_join("../../extension/doc_classes")
	for file in DirAccess.get_files_at(folder):
		pages[file.get_basename()] = read_page(folder.path_join(file))
	return pages


func read_page(path: String) -> Dictionary:
	var texts := {}
	var parser := XMLParser.new()
	parser.open(path)
	var method := ""
	var tag := ""
	while parser.read() == OK:
		match parser.get_node_type():
			XMLParser.NODE_ELEMENT:
				tag = parser.get_node_name()
				if tag == "method":
					method = parser.get_named_attribute_value("name")
				elif tag == "signal" or tag == "member":
					method = "-"
			XMLParser.NODE_ELEMENT_END:
				tag = ""
				if parser.get_node_name() == "methods":
					method = "-"
			XMLParser.NODE_TEXT:
				if tag == "description":
					texts[method] = texts.get(method, "") + parser.get_node_data()
	texts.erase("-")
	return texts
