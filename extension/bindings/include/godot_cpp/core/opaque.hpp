#pragma once

#include <godot_cpp/core/builtin_traits.hpp>
#include <godot_cpp/core/defs.hpp>

#include <algorithm>
#include <cstddef>

namespace godot::internal {

template <typename T>
struct Marshal;

/// Selects the constructor that leaves the storage uninitialized. The engine must then initialize
/// the storage.
struct Uninitialized {};

/// The engine's functions for a Variant type. Null if the type has no such function.
struct BuiltinFunctions {
	GDExtensionPtrConstructor construct = nullptr;
	GDExtensionPtrConstructor copy = nullptr;
	GDExtensionPtrDestructor destroy = nullptr;
	GDExtensionPtrOperatorEvaluator equal = nullptr;
	GDExtensionVariantFromTypeConstructorFunc to_variant = nullptr;
	GDExtensionTypeFromVariantConstructorFunc from_variant = nullptr;
};

extern BuiltinFunctions builtin_functions[GDEXTENSION_VARIANT_TYPE_VARIANT_MAX];

/// Fills `builtin_functions`. Requires a previous call to load_interface().
void load_builtin_functions();

/// A value whose representation only the engine knows. All such types can be moved bytewise.
template <typename Self>
class Opaque {
public:
	Opaque() { functions().construct(storage_, nullptr); }
	explicit Opaque(Uninitialized) {}
	Opaque(const Opaque &p_from) {
		const GDExtensionConstTypePtr from = p_from.storage_;
		functions().copy(storage_, &from);
	}
	Opaque(Opaque &&p_from) noexcept : Opaque() { swap(p_from); }
	~Opaque() { functions().destroy(storage_); }

	Opaque &operator=(const Opaque &p_from) {
		Opaque copy(p_from);
		swap(copy);
		return *this;
	}
	Opaque &operator=(Opaque &&p_from) noexcept {
		swap(p_from);
		return *this;
	}

	friend bool operator==(const Self &p_left, const Self &p_right) {
		GDExtensionBool equal = 0;
		functions().equal(p_left._native_ptr(), p_right._native_ptr(), &equal);
		return equal != 0;
	}

	/// Returns a pointer to the value for interface functions.
	void *_native_ptr() const { return const_cast<std::byte *>(storage_); }

private:
	static const BuiltinFunctions &functions() { return builtin_functions[builtin_type<Self>]; }

	void swap(Opaque &r_other) noexcept { std::swap_ranges(storage_, storage_ + sizeof(storage_), r_other.storage_); }

	// Exactly as large as the engine's type, so that elements of packed arrays are adjacent.
	alignas(std::min<std::size_t>(8, builtin_size<Self>)) std::byte storage_[builtin_size<Self>];
};

/// An iterator over a packed array. As in godot-cpp, it suits range-based for loops but not the
/// standard library's algorithms.
template <typename T>
class PackedIterator {
public:
	explicit PackedIterator(const T *p_element) : element_(p_element) {}
	const T &operator*() const { return *element_; }
	PackedIterator &operator++() {
		++element_;
		return *this;
	}
	bool operator==(const PackedIterator &) const = default;

private:
	const T *element_;
};

} // namespace godot::internal
