#pragma once

#include <godot_cpp/core/marshal.hpp>

namespace godot::internal {

/// The wrapper of one of the engine's singletons (`global_get_singleton`). It is kept until the library is closed. Returns null if there is
/// no singleton with this name; the engine then prints an error.
Object *find_singleton(const StringName &p_name);

/// Frees the wrappers of all singletons that are still alive. No wrappers may be created afterwards.
void release_wrappers();

template <typename T>
T *singleton() {
	return static_cast<T *>(find_singleton(T::get_class_static()));
}

} // namespace godot::internal
