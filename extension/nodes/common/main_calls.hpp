#pragma once

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <span>

namespace thicket {

/// Queues a call of a bound method, named as `Class.method`, for the main thread. The main thread makes the queued
/// calls in order, in the next frame of any TerrainScatter3D, and drops calls whose object has been freed. Any thread.
void call_on_main_thread(
		const godot::Object *p_object, const char *method, std::span<const godot::Variant> arguments) noexcept;

/// Makes all queued calls. Runs scripts. Main thread only.
void make_main_thread_calls();

/// Drops all queued calls, because the library is being unloaded.
void drop_main_thread_calls();

} // namespace thicket
