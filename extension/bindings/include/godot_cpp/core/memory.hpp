#pragma once

#include <godot_cpp/classes/wrapped.hpp>
#include <godot_cpp/core/gdextension_interface_loader.hpp>

#include <concepts>
#include <type_traits>

namespace godot::internal {

/// Runs a new-expression, with what an object of the engine needs before and after it.
template <typename New>
auto memnew_with(const New &p_new) {
	using T = std::remove_pointer_t<decltype(p_new())>;
	if constexpr (std::derived_from<T, Wrapped>) {
		Class<T>::prepare(nullptr);
		T *object = p_new();
		Access::post_initialize(object);
		return object;
	} else {
		return p_new();
	}
}

} // namespace godot::internal

/// Makes an object of the engine or of ours; `m_class` may have arguments.
#define memnew(m_class) ::godot::internal::memnew_with([&] { return new m_class; })

namespace godot {

/// Frees what `memnew` made. An object of the engine takes its wrapper with it.
template <typename T>
void memdelete(T *p_object) {
	if constexpr (std::derived_from<T, Wrapped>) {
		gdextension_interface::object_destroy(p_object->_owner);
	} else {
		delete p_object;
	}
}

} // namespace godot
