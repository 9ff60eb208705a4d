extends SceneTree
## The base class of benchmarks that run in the engine. It provides a scatter, prints rows of a Markdown table, and cleans up at
## the end.

const PATIENCE_SECONDS := 120.0
## On Linux, the file starts with the nanoseconds that this thread spent on a CPU and the nanoseconds that it waited for one.
const SCHEDULE := "/proc/thread-self/schedstat"

var scatter: TerrainScatter3D


func _initialize() -> void:
	_begin.call_deferred()


func _begin() -> void:
	var failure := await run()
	if failure != "":
		printerr("%s: %s" % [(get_script() as Script).resource_path.get_file().get_basename(), failure])
	if scatter != null:
		scatter.queue_free()
	quit(0 if failure == "" else 1)


## Runs the benchmark. Returns an error message, or an empty string.
func run() -> String:
	return "the benchmark does not override run()"


## Returns the first argument, or [param default_rounds] if there is none.
func rounds_or(default_rounds: int) -> int:
	var arguments := OS.get_cmdline_user_args()
	return maxi(1, arguments[0].to_int()) if arguments.size() > 0 else default_rounds


## Returns the ground of the demo's first scene.
func demo_terrain() -> ScatterGround:
	var demo := (load(ProjectSettings.get_setting("application/run/main_scene")) as PackedScene).instantiate()
	var terrain: ScatterGround
	for node in demo.find_children("*", "TerrainScatter3D", true, false):
		terrain = node.get(&"ground")
	demo.free()
	return terrain


func make_scatter(terrain: ScatterGround, layers: Array[ScatterLayer], viewer: Node3D) -> void:
	scatter = TerrainScatter3D.new()
	scatter.ground = terrain
	scatter.layers = layers
	root.add_child(viewer)
	root.add_child(scatter)
	scatter.viewers = [scatter.get_path_to(viewer)]


## Waits until all requested tiles are visible. Returns an error message if that takes too long, otherwise an empty
## string.
func idle() -> String:
	var limit := Time.get_ticks_msec() + int(PATIENCE_SECONDS * 1000.0)
	await process_frame
	await process_frame
	while not scatter.is_settled():
		if Time.get_ticks_msec() > limit:
			return "some tiles were not visible after %.0f s" % PATIENCE_SECONDS
		await process_frame
	return ""


## Returns the wall time of a call in microseconds.
func time_of(call: Callable) -> float:
	var start := Time.get_ticks_usec()
	call.call()
	return float(Time.get_ticks_usec() - start)


## Returns the CPU time in microseconds that a call of many milliseconds takes on this thread. Other programs affect it
## less than wall time. If the system does not report CPU time, returns wall time.
func processor_time_of(call: Callable) -> float:
	if not FileAccess.file_exists(SCHEDULE):
		return time_of(call)
	var start := _processor_time()
	call.call()
	return _processor_time() - start


## Returns this thread's CPU time in microseconds, or 0 if the system does not report it. The thread sleeps briefly first,
## because the system updates the value only when a thread goes to sleep, and about 250 times per second.
func _processor_time() -> float:
	OS.delay_usec(1)
	return thread_times().x


## Returns the microseconds that this thread has run so far, and the microseconds that it was ready but had to wait for
## a CPU. Both are 0 if the system does not report them.
func thread_times() -> Vector2i:
	var file := FileAccess.open(SCHEDULE, FileAccess.READ)
	var words := PackedStringArray(["0", "0"]) if file == null else file.get_line().split(" ")
	@warning_ignore("integer_division")
	return Vector2i(words[0].to_int() / 1000, words[1].to_int() / 1000)


## Formats the parts of a frame in microseconds, longest first: "upload 415, made 85".
func parts_text(parts: Dictionary) -> String:
	var names := parts.keys()
	names.sort_custom(func(a: String, b: String) -> bool: return parts[a] > parts[b])
	return ", ".join(names.map(func(part: String) -> String: return "%s %d" % [part, parts[part]]))


## Runs this script in a separate engine with these arguments and returns the seconds that it prints with
## `print_seconds`; -1 if it does not print any. If `one_core` is true, limits the engine to one core (Linux only).
func seconds_in_another_engine(user_arguments: Array[String], one_core := false) -> float:
	var command: Array[String] = [OS.get_executable_path(), "--headless", "--path", ProjectSettings.globalize_path("res://"), "--script",
		(get_script() as Script).resource_path, "--"]
	command.append_array(user_arguments)
	if one_core:
		command = (["taskset", "-c", "0"] as Array[String]) + command
	var output := []
	OS.execute(command[0], command.slice(1), output)
	var result := RegEx.create_from_string("seconds: ([0-9.]+)").search("".join(output))
	return result.get_string(1).to_float() if result != null else -1.0


func print_seconds(seconds: float) -> void:
	print("seconds: %.6f" % seconds)


## Prints a row for a value that is counted, not timed.
func exact_row(label: String, value: String) -> void:
	print("| %s | %s | exact | 1 |" % [label, value])


## Prints a row with the name, the median, the lowest and the highest round, and the number of rounds.
func row(label: String, rounds: Array, unit := "", digits := 0) -> void:
	var sorted := rounds.duplicate()
	sorted.sort()
	var number_format := "%." + str(digits) + "f"
	var end := "" if unit == "" else " " + unit
	@warning_ignore("integer_division")
	var median: String = number_format % sorted[sorted.size() / 2]
	var extremes := [number_format % sorted[0], number_format % sorted[-1], end]
	print("| %s | %s%s | %s to %s%s | %d |" % ([label, median, end] + extremes + [sorted.size()]))
