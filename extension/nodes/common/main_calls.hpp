#pragma once

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <span>

namespace thicket {

/// Queues a call to a bound method for the main thread; `method` has the form `Class.method`.
/// Queued calls run in order in the next frame of any TerrainScatter3D. Calls whose object has been
/// freed by then are dropped. Any thread may call this function.
void call_on_main_thread(
		const godot::Object *p_object, const char *method, std::span<const godot::Variant> arguments) noexcept;

/// Runs all queued calls, which may run scripts. Call it only on the main thread.
void make_main_thread_calls();

/// Drops all queued calls. Called when the library is unloaded.
void drop_main_thread_calls();

} // namespace thicket
