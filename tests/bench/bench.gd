extends SceneTree
## Base of the benches that run in the engine: one scatter, rows of a Markdown table, and an end that frees what there was.

const PATIENCE_SECONDS := 120.0
const SCHEDULE := "/proc/thread-self/schedstat" ## Of Linux: nanoseconds on the processor, nanoseconds ready but without one, and more.

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


## What a bench does. Says what failed; empty if nothing did.
func run() -> String:
	return "measures nothing"


## The first argument, or what is usual.
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


## Waits until all that is wanted is shown; says so if that takes too long.
func idle() -> String:
	var limit := Time.get_ticks_msec() + int(PATIENCE_SECONDS * 1000.0)
	await process_frame
	await process_frame
	while not scatter.is_settled():
		if Time.get_ticks_msec() > limit:
			return "not idle after %.0f s" % PATIENCE_SECONDS
		await process_frame
	return ""


## Microseconds that a call takes.
func time_of(call: Callable) -> float:
	var start := Time.get_ticks_usec()
	call.call()
	return float(Time.get_ticks_usec() - start)


## Microseconds of the processor that a call of many milliseconds takes on this thread, which other programs lengthen less; where the
## system does not tell, of the clock.
func processor_time_of(call: Callable) -> float:
	if not FileAccess.file_exists(SCHEDULE):
		return time_of(call)
	var start := _processor_time()
	call.call()
	return _processor_time() - start


## Microseconds; 0 where the system does not tell. It counts what a thread has taken when that goes to sleep, or else at the next tick, of
## which there are some 250 a second.
func _processor_time() -> float:
	OS.delay_usec(1)
	return thread_times().x


## Microseconds that this thread has had a processor, and that it was ready to run but had to wait for one, so far; 0 where the system
## does not tell.
func thread_times() -> Vector2i:
	var file := FileAccess.open(SCHEDULE, FileAccess.READ)
	var words := PackedStringArray(["0", "0"]) if file == null else file.get_line().split(" ")
	@warning_ignore("integer_division")
	return Vector2i(words[0].to_int() / 1000, words[1].to_int() / 1000)


## What the parts of a frame took, in microseconds, the longest first: "upload 415, made 85".
func parts_text(parts: Dictionary) -> String:
	var names := parts.keys()
	names.sort_custom(func(a: String, b: String) -> bool: return parts[a] > parts[b])
	return ", ".join(names.map(func(part: String) -> String: return "%s %d" % [part, parts[part]]))


## The seconds that this script tells (`tell_seconds`) in an engine of its own, which gets these arguments; -1 if it tells none. On one
## core, of Linux, where that is asked for.
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


func tell_seconds(seconds: float) -> void:
	print("seconds: %.6f" % seconds)


## What was counted, not timed.
func exact_row(what: String, value: String) -> void:
	print("| %s | %s | exact | 1 |" % [what, value])


## What, the median, the lowest and the highest round, and how many.
func row(what: String, rounds: Array, unit := "", digits := 0) -> void:
	var sorted := rounds.duplicate()
	sorted.sort()
	var number := "%." + str(digits) + "f"
	var end := "" if unit == "" else " " + unit
	@warning_ignore("integer_division")
	var median: String = number % sorted[sorted.size() / 2]
	var ends := [number % sorted[0], number % sorted[-1], end]
	print("| %s | %s%s | %s to %s%s | %d |" % ([what, median, end] + ends + [sorted.size()]))
