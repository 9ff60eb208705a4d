extends SceneTree
## Base of the benches that run in the engine: one scatter, rows of a Markdown table, and a cleanup at the end.

const PATIENCE_SECONDS := 120.0
const SCHEDULE := "/proc/thread-self/schedstat" ## On Linux: nanoseconds on the processor, nanoseconds ready but waiting for one, and more.

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


## The bench itself. Returns the failure, or an empty string.
func run() -> String:
	return "measures nothing"


## The first argument, or the default.
func rounds_or(usual: int) -> int:
	var arguments := OS.get_cmdline_user_args()
	return maxi(1, arguments[0].to_int()) if arguments.size() > 0 else usual


## The ground of the demo's first scene.
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


## Waits until all requested tiles are visible. Returns an error if that takes too long.
func idle() -> String:
	var limit := Time.get_ticks_msec() + int(PATIENCE_SECONDS * 1000.0)
	await process_frame
	await process_frame
	while not scatter.is_settled():
		if Time.get_ticks_msec() > limit:
			return "not idle after %.0f s" % PATIENCE_SECONDS
		await process_frame
	return ""


## The duration of a call in microseconds.
func time_of(call: Callable) -> float:
	var start := Time.get_ticks_usec()
	call.call()
	return float(Time.get_ticks_usec() - start)


## Microseconds of processor time that a call of many milliseconds takes on this thread. Other programs affect it less than wall time, which
## is used if the system does not report processor time.
func processor_time_of(call: Callable) -> float:
	if not FileAccess.file_exists(SCHEDULE):
		return time_of(call)
	var start := _processor_time()
	call.call()
	return _processor_time() - start


## In microseconds; 0 if the system does not report it. The system updates the value when a thread goes to sleep, or else at the next tick, about 250
## times per second.
func _processor_time() -> float:
	OS.delay_usec(1)
	return thread_times().x


## Microseconds that this thread has run so far, and microseconds that it was ready but had to wait for a processor. 0 if the system does not report
## them.
func thread_times() -> Vector2i:
	var file := FileAccess.open(SCHEDULE, FileAccess.READ)
	var words := PackedStringArray(["0", "0"]) if file == null else file.get_line().split(" ")
	@warning_ignore("integer_division")
	return Vector2i(words[0].to_int() / 1000, words[1].to_int() / 1000)


## The parts of a frame in microseconds, the longest first: "upload 415, made 85".
func parts_text(parts: Dictionary) -> String:
	var names := parts.keys()
	names.sort_custom(func(a: String, b: String) -> bool: return parts[a] > parts[b])
	return ", ".join(names.map(func(part: String) -> String: return "%s %d" % [part, parts[part]]))


## Runs this script in a separate engine with these arguments, and returns the seconds that it prints with `print_seconds`; -1 if it prints
## none. With `one_core`, the engine is limited to one core (Linux only).
func seconds_in_another_engine(user_arguments: Array[String], one_core := false) -> float:
	var command: Array[String] = [OS.get_executable_path(), "--headless", "--path", ProjectSettings.globalize_path("res://"), "--script",
		(get_script() as Script).resource_path, "--"]
	command.append_array(user_arguments)
	if one_core:
		command = (["taskset", "-c", "0"] as Array[String]) + command
	var output := []
	OS.execute(command[0], command.slice(1), output)
	var found := RegEx.create_from_string("seconds: ([0-9.]+)").search("".join(output))
	return found.get_string(1).to_float() if found != null else -1.0


func print_seconds(seconds: float) -> void:
	print("seconds: %.6f" % seconds)


## Prints a figure that is counted, not timed.
func exact_row(what: String, value: String) -> void:
	print("| %s | %s | exact | 1 |" % [what, value])


## Prints the name, the median, the lowest and the highest round, and the number of rounds.
func row(what: String, rounds: Array, unit := "", digits := 0) -> void:
	var sorted := rounds.duplicate()
	sorted.sort()
	var number := "%." + str(digits) + "f"
	var end := "" if unit == "" else " " + unit
	@warning_ignore("integer_division")
	var median: String = number % sorted[sorted.size() / 2]
	var ends := [number % sorted[0], number % sorted[-1], end]
	print("| %s | %s%s | %s to %s%s | %d |" % ([what, median, end] + ends + [sorted.size()]))
