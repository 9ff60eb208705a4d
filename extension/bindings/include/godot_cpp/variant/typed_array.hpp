#pragma once

#include <godot_cpp/core/marshal.hpp>
#include <godot_cpp/variant/array.hpp>

namespace godot {

/// An array whose elements have a single type: a number, an engine type, or an object class.
template <typename T>
class TypedArray : public Array {
public:
	TypedArray() { make_typed(); }
	/// Shares the array if its type matches. Otherwise, creates a converted copy.
	TypedArray(const Array &p_from) {
		make_typed();
		if (is_same_typed(p_from)) {
			Array::operator=(p_from);
		} else {
			assign(p_from);
		}
	}
	TypedArray(const Variant &p_from) : TypedArray(static_cast<Array>(p_from)) {}

private:
	void make_typed() {
		if constexpr (requires { T::get_class_static(); }) {
			set_typed(Variant::OBJECT, T::get_class_static(), Variant());
		} else {
			set_typed(internal::Marshal<T>::type, StringName(), Variant());
		}
	}
};

namespace internal {

template <typename T>
struct Marshal<TypedArray<T>> : DirectMarshal<Array, GDEXTENSION_VARIANT_TYPE_ARRAY> {
	static PropertyInfo info() {
		if constexpr (requires { T::get_class_static(); }) {
			return PropertyInfo(Variant::ARRAY, StringName(), PROPERTY_HINT_ARRAY_TYPE, T::get_class_static());
		} else {
			return PropertyInfo(Variant::ARRAY, StringName(), PROPERTY_HINT_ARRAY_TYPE, type_name(Marshal<T>::type));
		}
	}
	static TypedArray<T> adopt(Array &p_wire) { return TypedArray<T>(p_wire); }
	static TypedArray<T> decode(const void *p_wire) { return TypedArray<T>(*static_cast<const Array *>(p_wire)); }
};

} // namespace internal
} // namespace godot
