#pragma once

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <span>

namespace thicket {

/// Has the main thread call a bound method, named as `Class.method`, in the next frame of any TerrainScatter3D. Calls are made in
/// their order; one for an object that is freed by then is dropped. Any thread.
void call_on_main_thread(
		const godot::Object *p_object, const char *method, std::span<const godot::Variant> arguments) noexcept;

/// Makes the calls that were left so far. Runs scripts. Main thread only.
void make_main_thread_calls();

/// Drops them: the library goes.
void drop_main_thread_calls();

} // namespace thicket
