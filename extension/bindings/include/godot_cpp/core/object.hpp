#pragma once

#include <godot_cpp/classes/object.hpp>

namespace godot {

template <typename T>
T *Object::cast_to(Object *p_object) {
	return dynamic_cast<T *>(p_object);
}

template <typename T>
const T *Object::cast_to(const Object *p_object) {
	return dynamic_cast<const T *>(p_object);
}

} // namespace godot
