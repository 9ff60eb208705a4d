#pragma once

#include <godot_cpp/core/class_hooks.hpp>

/// Creates an object of one of our registered classes.
#define memnew(m_class) (::godot::internal::Class<m_class>::make())

namespace godot {

/// Frees an object that is not reference-counted.
template <typename T>
void memdelete(T *p_object) {
	gdextension_interface::object_destroy(p_object->_owner); // The engine also frees the wrapper.
}

} // namespace godot
