#pragma once

#include <godot_cpp/core/defs.hpp>
#include <godot_cpp/core/lazy_name.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <type_traits>

namespace godot {

class ClassDB;
struct PropertyInfo;
class Wrapped;

namespace internal {

class Access;
template <typename T>
class Class;

} // namespace internal

/// The C++ side of an engine object, owned by that object. For engine classes, it is an instance
/// binding that is created when the bindings first encounter the object
/// (`object_get_instance_binding`). For our classes, it is also the instance
/// (`object_set_instance`).
class Wrapped {
public:
	Wrapped(const Wrapped &) = delete;
	Wrapped &operator=(const Wrapped &) = delete;

	GodotObject *_owner = nullptr;

protected:
	Wrapped();
	virtual ~Wrapped() = default;

	/// These hooks do nothing. Our classes may override them with the same signatures as in
	/// godot-cpp.
	static void _bind_methods() {}
	void _notification(int) {}
	bool _set(const StringName &, const Variant &) { return false; }
	void _validate_property(PropertyInfo &) const {}

	template <typename T, typename B>
	static void register_virtuals() {}

private:
	template <typename T>
	friend class internal::Class;
	friend class internal::Access;
	friend class ClassDB;
};

namespace internal {

/// Internal operations on objects. Only the bindings use them.
class Access {
public:
	/// Sends NOTIFICATION_POSTINITIALIZE to a complete object.
	static void post_initialize(Object *p_object);
	/// Creates an object of an engine class. Throws std::bad_alloc if the engine fails to create
	/// it.
	static GodotObject *new_object(const StringName &p_engine_class);
	/// Sets the object that the next Wrapped on this thread will wrap. The constructor of Wrapped
	/// takes no arguments, so derived classes need not pass any.
	static void expect(GodotObject *p_owner);
	/// Connects a complete wrapper to the object that it wraps. `p_extension_class` is null for
	/// engine classes.
	static void attach(Wrapped *p_wrapped, const StringName *p_extension_class,
			const GDExtensionInstanceBindingCallbacks &p_callbacks);
	static void destroy(Wrapped *p_wrapped) { delete p_wrapped; }
};

} // namespace internal
} // namespace godot

#define GDCLASS_COMMON(m_class, m_inherits) \
	template <typename T> \
	friend class ::godot::internal::Class; \
	friend class ::godot::ClassDB; \
\
public: \
	using self_type = m_class; \
	using parent_type = m_inherits; \
	static ::godot::internal::LazyName &_class_name() { \
		static constinit ::godot::internal::LazyName name(#m_class); \
		return name; \
	} \
	static const ::godot::StringName &get_class_static() { return _class_name().get(); }

/// Declares the members that the bindings need in a class. Must be at the top of each of our
/// classes.
#define GDCLASS(m_class, m_inherits) \
	GDCLASS_COMMON(m_class, m_inherits) \
	static constexpr bool _is_engine_class = false; \
\
protected: \
	template <typename T, typename B> \
	static void register_virtuals() { \
		m_inherits::register_virtuals<T, B>(); \
	} \
\
private:

/// Like GDCLASS, for engine classes. The generator puts it at the top of each engine class.
#define GDEXTENSION_CLASS(m_class, m_inherits) \
	GDCLASS_COMMON(m_class, m_inherits) \
	static constexpr bool _is_engine_class = true; \
\
private:
