#pragma once

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/core/class_hooks.hpp>
#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/core/method_bind.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/typed_dictionary.hpp>

#include <initializer_list>

namespace godot {

namespace internal {

/// Enables wrappers of an engine class. Parents must be registered first.
void register_engine_class(LazyName &p_name, const GDExtensionInstanceBindingCallbacks &p_callbacks);

template <typename T>
void register_engine_class() {
	register_engine_class(T::_class_name(), Class<T>::callbacks);
}

/// Calls register_engine_class for all classes in used_api.toml. The generator writes this
/// function.
void register_engine_classes();

/// The description of one of our classes, as `classdb_register_extension_class4` needs it.
struct ClassDescription {
	const StringName &name;
	const StringName &parent;
	GDExtensionClassCreationInfo4 info;
	void (*bind)();
};

} // namespace internal

/// Registers our classes with the engine.
class ClassDB {
public:
	/// Registers a class. If `p_virtual` is true, the editor does not offer to create its objects,
	/// but files may contain them and scripts may extend it.
	template <typename T>
	static void register_class(bool p_virtual = false) {
		add_class(describe<T>(p_virtual));
	}

	/// Registers a method. `p_defaults` are the default values of the last arguments, each wrapped
	/// in DEFVAL.
	template <typename M, typename... Defaults>
	static void bind_method(const MethodDefinition &p_definition, M p_method, const Defaults &...p_defaults) {
		using Sign = internal::Signature<M>;
		using OfWrapped = typename Sign::OfWrapped;
		add_method(Sign::Owner::get_class_static(), p_definition, internal::MethodCalls<OfWrapped>::describe(),
				internal::MethodPointer(static_cast<OfWrapped>(p_method)), {Variant(p_defaults)...});
	}

	/// Registers a constant of an enumeration. The name of the enumeration has the form
	/// "Class.Enum".
	static void bind_integer_constant(
			const StringName &p_class, const StringName &p_enum, const StringName &p_constant, GDExtensionInt p_value);

	static void add_property(const StringName &p_class, const PropertyInfo &p_property, const StringName &p_setter,
			const StringName &p_getter);
	static void add_property_group(const StringName &p_class, const String &p_name, const String &p_prefix);
	static void add_property_subgroup(const StringName &p_class, const String &p_name, const String &p_prefix);
	static void add_signal(const StringName &p_class, const MethodInfo &p_signal);
	static void add_virtual_method(
			const StringName &p_class, MethodInfo p_method, const std::vector<StringName> &p_arguments);

	/// Unregisters all classes in reverse order.
	static void unregister_classes();

private:
	template <typename T>
	static internal::ClassDescription describe(bool p_virtual) {
		using Hooks = internal::Class<T>;
		GDExtensionClassCreationInfo4 info{};
		info.is_virtual = p_virtual;
		info.is_exposed = true;
		info.set_func = Hooks::set;
		info.validate_property_func = Hooks::validate_property;
		info.notification_func = Hooks::notification;
		info.create_instance_func = Hooks::create_instance;
		info.free_instance_func = Hooks::free_instance;
		info.recreate_instance_func = Hooks::recreate_instance;
		return {T::get_class_static(), T::parent_type::get_class_static(), info, Hooks::bind};
	}

	static void add_class(const internal::ClassDescription &p_class);
	static void add_method(const StringName &p_class, const MethodDefinition &p_definition,
			const internal::MethodDescription &p_method, const internal::MethodPointer &p_pointer,
			std::initializer_list<Variant> p_defaults);
};

} // namespace godot

#define GDREGISTER_CLASS(m_class) ::godot::ClassDB::register_class<m_class>()
#define GDREGISTER_VIRTUAL_CLASS(m_class) ::godot::ClassDB::register_class<m_class>(true)

#define DEFVAL(m_defval) (m_defval)
#define BIND_ENUM_CONSTANT(m_constant) \
	::godot::ClassDB::bind_integer_constant(get_class_static(), \
			::godot::internal::enum_class_name(::godot::internal::enum_name<decltype(m_constant)>), #m_constant, \
			m_constant)
#define ADD_PROPERTY(m_property, m_setter, m_getter) \
	::godot::ClassDB::add_property(get_class_static(), m_property, m_setter, m_getter)
#define ADD_GROUP(m_name, m_prefix) ::godot::ClassDB::add_property_group(get_class_static(), m_name, m_prefix)
#define ADD_SUBGROUP(m_name, m_prefix) ::godot::ClassDB::add_property_subgroup(get_class_static(), m_name, m_prefix)
#define ADD_SIGNAL(m_signal) ::godot::ClassDB::add_signal(get_class_static(), m_signal)
