#pragma once

#include <godot_cpp/classes/wrapped.hpp>
#include <godot_cpp/core/border.hpp>
#include <godot_cpp/core/gdextension_interface_loader.hpp>
#include <godot_cpp/core/marshal.hpp>
#include <godot_cpp/core/property_info.hpp>
#include <godot_cpp/core/signature.hpp>

#include <concepts>
#include <type_traits>

namespace godot::internal {

/// Adds an override of a virtual engine method to the class that is being registered.
void add_override(const char *p_name, uint32_t p_hash, GDExtensionClassCallVirtual p_call);

/// Adds an override if the class implements the method itself.
template <auto Method, auto BaseMethod>
void bind_virtual(const char *p_name, uint32_t p_hash) {
	if constexpr (!std::is_same_v<decltype(Method), decltype(BaseMethod)>) {
		using Sign = Signature<decltype(Method)>;
		add_override(p_name, p_hash,
				[](GDExtensionClassInstancePtr p_instance, const GDExtensionConstTypePtr *p_args,
						GDExtensionTypePtr r_result) {
					auto *self = static_cast<typename Sign::Owner *>(static_cast<Wrapped *>(p_instance));
					at_border("a virtual method", [&] { Sign::ptrcall(self, Method, p_args, r_result); });
				});
	}
}

/// Represents a function as a type. Types can always be compared in constant expressions, but with
/// sanitizers, addresses of functions cannot.
template <auto Function>
struct FunctionTag;

/// The callbacks through which the engine uses a class. T is an engine class or one of our classes.
template <typename T>
class Class {
	using Parent = Class<typename T::parent_type>;

public:
	/// Creates an engine object with a T as its wrapper.
	static T *construct() {
		GodotObject *owner = Access::new_object(engine_class<T>());
		try {
			return wrap(owner);
		} catch (...) {
			gdextension_interface::object_destroy(owner);
			throw;
		}
	}

	/// Creates an instance for the engine (`GDExtensionClassCreationInfo4`). Returns null if memory
	/// runs out.
	static GDExtensionObjectPtr create_instance(void *, GDExtensionBool p_notify) {
		return at_border("a new object", [=] { return (p_notify ? make() : construct())->_owner; });
	}

	/// Implements `memnew`.
	static T *make() {
		T *object = construct();
		Access::post_initialize(object);
		return object;
	}

	/// Creates a new instance for `p_owner` after the library was reloaded.
	static GDExtensionClassInstancePtr recreate_instance(void *, GDExtensionObjectPtr p_owner) {
		return at_border("an object after a reload", [=] { return static_cast<Wrapped *>(wrap(p_owner)); });
	}

	static void free_instance(void *, GDExtensionClassInstancePtr p_instance) {
		Access::destroy(static_cast<Wrapped *>(p_instance));
	}

	/// Notifies base classes first or, if `p_reversed` is true, last.
	static void notification(GDExtensionClassInstancePtr p_instance, int32_t p_what, GDExtensionBool p_reversed) {
		at_border("a notification", [=] { notify(self(p_instance), p_what, p_reversed != 0); });
	}

	/// Lets `_validate_property` change a property before the inspector displays it. Calls base
	/// classes first.
	static GDExtensionBool validate_property(
			GDExtensionClassInstancePtr p_instance, GDExtensionPropertyInfo *p_property) {
		return at_border("the validation of a property", [=] {
			PropertyInfo info(p_property);
			validate(self(p_instance), info);
			info._update(p_property);
			return GDExtensionBool{true};
		});
	}

	/// Lets `_set` handle an unregistered property. Calls base classes first.
	static GDExtensionBool set(GDExtensionClassInstancePtr p_instance, GDExtensionConstStringNamePtr p_name,
			GDExtensionConstVariantPtr p_value) {
		return at_border("a property", [=] {
			return GDExtensionBool{set(self(p_instance), *static_cast<const StringName *>(p_name),
					*static_cast<const Variant *>(p_value))};
		});
	}

	/// Calls `_bind_methods`, which each of our classes must declare.
	static void bind() {
		static_assert(!std::is_same_v<FunctionTag<&T::_bind_methods>, FunctionTag<&T::parent_type::_bind_methods>>,
				"the class must declare _bind_methods");
		T::_bind_methods();
		T::template register_virtuals<T, typename T::parent_type>();
	}

	static constexpr bool is_engine_class = T::_is_engine_class;

	// These functions are callbacks for instance bindings. Objects of our classes are created
	// together with their instance, so only engine classes need bindings. Bindings do not keep
	// their objects alive, so reference_binding always lets the engine free an object.
	static void *create_binding(void *, void *p_owner) {
		if constexpr (is_engine_class) {
			return at_border("an object's wrapper", [=] { return static_cast<Wrapped *>(instance(p_owner)); });
		} else {
			return nullptr;
		}
	}
	static void free_binding(void *, void *, void *p_binding) {
		if constexpr (is_engine_class) {
			Access::destroy(static_cast<Wrapped *>(p_binding));
		}
	}
	static GDExtensionBool reference_binding(void *, void *, GDExtensionBool) { return true; }
	static constexpr GDExtensionInstanceBindingCallbacks callbacks{create_binding, free_binding, reference_binding};

private:
	/// Creates a T for an engine object without connecting the two.
	static T *instance(void *p_owner) {
		Access::expect(p_owner);
		try {
			return new T;
		} catch (...) {
			Access::expect(nullptr);
			throw;
		}
	}

	static T *wrap(GodotObject *p_owner) {
		T *object = instance(p_owner);
		Access::attach(object, extension_class(), callbacks);
		return object;
	}

	static T *self(GDExtensionClassInstancePtr p_instance) {
		return static_cast<T *>(static_cast<Wrapped *>(p_instance));
	}

	template <typename C>
	static const StringName &engine_class() {
		if constexpr (C::_is_engine_class) {
			return C::get_class_static();
		} else {
			return engine_class<typename C::parent_type>();
		}
	}

	static const StringName *extension_class() { return is_engine_class ? nullptr : &T::get_class_static(); }

	static void notify(T *p_self, int p_what, bool p_reversed) {
		if constexpr (!is_engine_class) {
			if (!p_reversed) {
				Parent::notify(p_self, p_what, p_reversed);
			}
			if constexpr (std::same_as<decltype(&T::_notification), void (T::*)(int)>) {
				p_self->_notification(p_what);
			}
			if (p_reversed) {
				Parent::notify(p_self, p_what, p_reversed);
			}
		}
	}

	static void validate(const T *p_self, PropertyInfo &r_property) {
		if constexpr (!is_engine_class) {
			Parent::validate(p_self, r_property);
			if constexpr (std::same_as<decltype(&T::_validate_property), void (T::*)(PropertyInfo &) const>) {
				p_self->_validate_property(r_property);
			}
		}
	}

	static bool set(T *p_self, const StringName &p_name, const Variant &p_value) {
		if constexpr (is_engine_class) {
			return false;
		} else {
			return Parent::set(p_self, p_name, p_value) || p_self->_set(p_name, p_value);
		}
	}

	template <typename>
	friend class Class;
};

} // namespace godot::internal
