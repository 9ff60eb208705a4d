#pragma once

#include <godot_cpp/core/enum_cast.hpp>
#include <godot_cpp/core/property_info.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <concepts>
#include <type_traits>

namespace godot {

template <typename T>
class Ref;

namespace internal {

class Access;

/// Returns the wrapper of an engine object, which is created on first use. Returns null for null.
/// Throws std::bad_alloc.
Object *wrapper_of(GodotObject *p_object);
/// Returns the engine object of a wrapper, or null for null.
GodotObject *owner_of(const Object *p_object);

/// Converts the C++ name of an enumeration, with any number of scopes, to "Class.Enum".
StringName enum_class_name(std::string_view p_cpp_name);

/// Converts values of a C++ type to and from the engine's representation. Every specialization has:
/// - `type`, `metadata` and `info()`, which describe the type for scripts;
/// - `Wire`, the representation in pointer calls (`object_method_bind_ptrcall`);
/// - `wire(value)` for an argument to the engine, and `adopt(wire)` for a result from the engine;
/// - `decode(pointer)` for an argument from the engine, and `encode(value, pointer)` for a result to the engine;
/// - `fits(variant)`, whether `static_cast<T>(variant)` is lossless.
template <typename T>
struct Marshal;

/// Returns the engine's name of a Variant type.
String type_name(GDExtensionVariantType p_type);

/// Returns true if the engine can convert a value to a type without loss
/// (`variant_can_convert_strict`).
bool can_convert(const Variant &p_value, GDExtensionVariantType p_type);

/// A Marshal for types with a trivial conversion.
template <typename T, typename W, GDExtensionVariantType Type>
struct CopyMarshal {
	using Wire = W;
	static constexpr GDExtensionVariantType type = Type;
	static constexpr GDExtensionClassMethodArgumentMetadata metadata = GDEXTENSION_METHOD_ARGUMENT_METADATA_NONE;

	static PropertyInfo info() { return PropertyInfo(static_cast<Variant::Type>(Type), StringName()); }
	static bool fits(const Variant &p_value) { return can_convert(p_value, Type); }
	static W wire(const T &p_value) { return static_cast<W>(p_value); }
	static T adopt(W &p_wire) { return static_cast<T>(p_wire); }
	static T decode(const void *p_wire) { return static_cast<T>(*static_cast<const W *>(p_wire)); }
	static void encode(const T &p_value, void *r_wire) { *static_cast<W *>(r_wire) = static_cast<W>(p_value); }
};

/// Like CopyMarshal, but passes arguments to the engine without a copy.
template <typename T, GDExtensionVariantType Type>
struct DirectMarshal : CopyMarshal<T, T, Type> {
	static const T &wire(const T &p_value) { return p_value; }
	static T adopt(T &p_wire) { return std::move(p_wire); }
};

template <Builtin T>
struct Marshal<T> : DirectMarshal<T, builtin_type<T>> {};

template <>
struct Marshal<Variant> : DirectMarshal<Variant, GDEXTENSION_VARIANT_TYPE_NIL> {
	static PropertyInfo info() {
		return PropertyInfo(Variant::NIL, StringName(), PROPERTY_HINT_NONE, String(),
				PROPERTY_USAGE_DEFAULT | PROPERTY_USAGE_NIL_IS_VARIANT);
	}
	static bool fits(const Variant &) { return true; }
};

template <>
struct Marshal<bool> : CopyMarshal<bool, GDExtensionBool, GDEXTENSION_VARIANT_TYPE_BOOL> {};

template <typename T>
	requires std::is_arithmetic_v<T>
struct Marshal<T> : CopyMarshal<T, NumberWire<T>, number_type<T>> {
	static constexpr GDExtensionClassMethodArgumentMetadata metadata =
			static_cast<GDExtensionClassMethodArgumentMetadata>(std::is_floating_point_v<T>
							? (sizeof(T) == 4 ? GDEXTENSION_METHOD_ARGUMENT_METADATA_REAL_IS_FLOAT
											  : GDEXTENSION_METHOD_ARGUMENT_METADATA_REAL_IS_DOUBLE)
							: (std::is_signed_v<T> ? GDEXTENSION_METHOD_ARGUMENT_METADATA_INT_IS_INT8
												   : GDEXTENSION_METHOD_ARGUMENT_METADATA_INT_IS_UINT8) +
									// Maps 1, 2, 4 and 8 bytes to 0, 1, 2 and 3.
									(sizeof(T) == 8 ? 3 : sizeof(T) / 2));
};

template <typename T>
	requires std::is_enum_v<T>
struct Marshal<T> : CopyMarshal<T, int64_t, GDEXTENSION_VARIANT_TYPE_INT> {
	static PropertyInfo info() {
		static_assert(!enum_name<T>.empty(), "VARIANT_ENUM_CAST is missing");
		return PropertyInfo(Variant::INT, StringName(), PROPERTY_HINT_NONE, String(),
				PROPERTY_USAGE_DEFAULT | PROPERTY_USAGE_CLASS_IS_ENUM, enum_class_name(enum_name<T>));
	}
};

template <typename T>
struct Marshal<T *> {
	using Wire = GodotObject *;
	static constexpr GDExtensionVariantType type = GDEXTENSION_VARIANT_TYPE_OBJECT;
	static constexpr GDExtensionClassMethodArgumentMetadata metadata = GDEXTENSION_METHOD_ARGUMENT_METADATA_NONE;

	static PropertyInfo info() {
		return PropertyInfo(Variant::OBJECT, StringName(), PROPERTY_HINT_NONE, String(), PROPERTY_USAGE_DEFAULT,
				T::get_class_static());
	}
	/// Accepts null and objects of the class.
	static bool fits(const Variant &p_value) {
		return p_value.get_type() == Variant::NIL ||
				(p_value.get_type() == Variant::OBJECT && (is_null(p_value) || from(p_value) != nullptr));
	}
	static T *from(Object *p_object) { return dynamic_cast<T *>(p_object); }
	static GodotObject *wire(const T *p_value) { return owner_of(p_value); }
	static T *adopt(GodotObject *p_wire) { return from(wrapper_of(p_wire)); }
	static T *decode(const void *p_wire) { return adopt(*static_cast<GodotObject *const *>(p_wire)); }
	static void encode(T *p_value, void *r_wire) { *static_cast<GodotObject **>(r_wire) = owner_of(p_value); }

private:
	static bool is_null(const Variant &p_value) { return p_value.get_validated_object() == nullptr; }
};

template <typename T>
struct Marshal<const T *> : Marshal<T *> {};

/// Converts a Variant to a parameter of type T.
template <typename T>
T from_variant(const Variant &p_value) {
	if constexpr (std::is_pointer_v<T>) {
		return Marshal<T>::from(p_value.get_validated_object());
	} else if constexpr (std::is_enum_v<T>) {
		return static_cast<T>(static_cast<int64_t>(p_value));
	} else {
		return static_cast<T>(p_value);
	}
}

} // namespace internal
} // namespace godot
