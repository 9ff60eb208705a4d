#pragma once

#include <godot_cpp/core/marshal.hpp>

namespace godot::internal {

/// Returns the wrapper of an engine singleton (`global_get_singleton`), which exists until the
/// library is unloaded. If there is no singleton with this name, the engine prints an error and the
/// function returns null.
Object *find_singleton(const StringName &p_name);

/// Frees the wrappers of all singletons that still exist. No wrappers may be created afterward.
void release_wrappers();

template <typename T>
T *singleton() {
	return static_cast<T *>(find_singleton(T::get_class_static()));
}

} // namespace godot::internal
