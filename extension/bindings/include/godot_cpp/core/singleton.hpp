#pragma once

#include <godot_cpp/core/marshal.hpp>

namespace godot::internal {

/// The wrapper of a singleton of the engine (`global_get_singleton`), remembered until the library is closed. Null, and
/// an error of the engine, if there is none of the name.
Object *find_singleton(const StringName &p_name);

/// Gives back the wrappers of all singletons that still live, and makes no more of any kind.
void release_wrappers();

template <typename T>
T *singleton() {
	return static_cast<T *>(find_singleton(T::get_class_static()));
}

} // namespace godot::internal
