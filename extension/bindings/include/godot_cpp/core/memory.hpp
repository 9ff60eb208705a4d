#pragma once

#include <godot_cpp/core/class_hooks.hpp>

/// A new object of a class of ours that is registered, with its defaults.
#define memnew(m_class) (::godot::internal::Class<m_class>::make())

namespace godot {

/// Frees an object that is not counted.
template <typename T>
void memdelete(T *p_object) {
	gdextension_interface::object_destroy(p_object->_owner); // Its wrapper goes with it.
}

} // namespace godot
