#pragma once

#include <godot_cpp/core/builtin_traits.hpp>
#include <godot_cpp/core/defs.hpp>
#include <godot_cpp/core/opaque.hpp>

#include <concepts>
#include <type_traits>

namespace godot {

class Object;

namespace internal {

/// An engine type that a Variant can contain without conversion.
template <typename T>
concept Builtin = builtin_type<T> != GDEXTENSION_VARIANT_TYPE_NIL;

template <typename T>
concept Number = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// A number for which godot-cpp's Variant has a constructor and a conversion. Excludes `long long`
/// where it is not int64_t, and enumerations.
template <typename T, typename... Numbers>
concept OneOf = (std::same_as<T, Numbers> || ...);
template <typename T>
concept VariantNumber =
		OneOf<T, bool, int8_t, uint8_t, int16_t, uint16_t, int32_t, uint32_t, int64_t, uint64_t, float, double>;

/// The engine's representation of a number. `number_type` is the corresponding Variant type.
template <Number T>
using NumberWire = std::conditional_t<std::is_same_v<T, bool>, GDExtensionBool,
		std::conditional_t<std::is_floating_point_v<T>, double, int64_t>>;

template <Number T>
inline constexpr GDExtensionVariantType number_type = std::is_same_v<T, bool> ? GDEXTENSION_VARIANT_TYPE_BOOL
		: std::is_floating_point_v<T>                                         ? GDEXTENSION_VARIANT_TYPE_FLOAT
																			  : GDEXTENSION_VARIANT_TYPE_INT;

} // namespace internal

/// A value of any engine type. Conversions follow the engine's rules: a value that cannot be
/// converted becomes the default value of the target type.
class Variant {
public:
	// clang-format off
	enum Type {
		NIL, BOOL, INT, FLOAT, STRING, VECTOR2, VECTOR2I, RECT2, RECT2I, VECTOR3, VECTOR3I, TRANSFORM2D, VECTOR4,
		VECTOR4I, PLANE, QUATERNION, AABB, BASIS, TRANSFORM3D, PROJECTION, COLOR, STRING_NAME, NODE_PATH, RID, OBJECT,
		CALLABLE, SIGNAL, DICTIONARY, ARRAY, PACKED_BYTE_ARRAY, PACKED_INT32_ARRAY, PACKED_INT64_ARRAY,
		PACKED_FLOAT32_ARRAY, PACKED_FLOAT64_ARRAY, PACKED_STRING_ARRAY, PACKED_VECTOR2_ARRAY, PACKED_VECTOR3_ARRAY,
		PACKED_COLOR_ARRAY, PACKED_VECTOR4_ARRAY, VARIANT_MAX
	};
	// clang-format on
	static_assert(int(VARIANT_MAX) == int(GDEXTENSION_VARIANT_TYPE_VARIANT_MAX));

	Variant();
	Variant(const Variant &p_from);
	Variant(Variant &&p_from) noexcept;
	Variant(const char *p_utf8);
	Variant(const Object *p_object);
	Variant(const Array &p_array);           // Typed arrays use this constructor, too.
	Variant(const Dictionary &p_dictionary); // Typed dictionaries use this constructor, too.
	~Variant();
	Variant &operator=(const Variant &p_from);
	Variant &operator=(Variant &&p_from) noexcept;

	template <internal::Number T>
		requires internal::VariantNumber<T> || std::is_convertible_v<T, int>
	Variant(T p_value) {
		auto wire = static_cast<internal::NumberWire<T>>(p_value);
		internal::builtin_functions[internal::number_type<T>].to_variant(storage_, &wire);
	}

	template <internal::Builtin T>
	Variant(const T &p_value) {
		internal::builtin_functions[internal::builtin_type<T>].to_variant(storage_, const_cast<T *>(&p_value));
	}

	template <internal::VariantNumber T>
	operator T() const {
		internal::NumberWire<T> wire{};
		internal::builtin_functions[internal::number_type<T>].from_variant(&wire, _native_ptr());
		return static_cast<T>(wire);
	}

	template <internal::Builtin T>
	operator T() const {
		if constexpr (std::constructible_from<T, internal::Uninitialized>) {
			T value{internal::Uninitialized{}};
			internal::builtin_functions[internal::builtin_type<T>].from_variant(value._native_ptr(), _native_ptr());
			return value;
		} else {
			T value;
			internal::builtin_functions[internal::builtin_type<T>].from_variant(&value, _native_ptr());
			return value;
		}
	}

	/// Returns the object, or null if it was freed or the value is not an object.
	operator Object *() const { return get_validated_object(); }
	Object *get_validated_object() const;

	Type get_type() const;

	/// Calls a method of the value. `r_error` receives the error, if any.
	void callp(const StringName &p_method, const Variant **p_args, int p_count, Variant &r_result,
			GDExtensionCallError &r_error);

	/// Returns a pointer to the value for interface functions.
	void *_native_ptr() const { return const_cast<std::byte *>(storage_); }

private:
	alignas(8) std::byte storage_[internal::builtin_size<Variant>];
};

} // namespace godot

// As in godot-cpp, this header includes all types that a Variant may hold.
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/color.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/node_path.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/packed_color_array.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_float64_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/rect2i.hpp>
#include <godot_cpp/variant/rid.hpp>
#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/vector2i.hpp>

namespace godot {

/// Replaces the placeholders in a string (%d, %s, ...) by the same rules as GDScript.
template <typename... Args>
String vformat(const String &p_text, const Args &...p_args) {
	Array values;
	(values.push_back(p_args), ...);
	return p_text % values;
}

} // namespace godot
