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

/// The C++ side of an object of the engine, which owns it. For the engine's own classes it is an instance binding, created when
/// we first see the object (`object_get_instance_binding`). For our classes it is also the instance (`object_set_instance`).
class Wrapped {
public:
	Wrapped(const Wrapped &) = delete;
	Wrapped &operator=(const Wrapped &) = delete;

	GodotObject *_owner = nullptr;

protected:
	Wrapped();
	virtual ~Wrapped() = default;

	/// Hooks that our classes may override, with the same signatures as in godot-cpp. These do nothing.
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

/// Internal access to objects, not for users of the classes.
class Access {
public:
	/// Notifies the object that it is complete (NOTIFICATION_POSTINITIALIZE).
	static void post_initialize(Object *p_object);
	/// Creates an object of one of the engine's classes. Throws std::bad_alloc if the engine fails.
	static GodotObject *new_object(const StringName &p_engine_class);
	/// Makes the next Wrapped on this thread wrap this object. The constructor of Wrapped takes no arguments, so that classes do not
	/// have to pass them on.
	static void expect(GodotObject *p_owner);
	/// Connects a complete wrapper with the object that it wraps. `p_extension_class`: null for a class of the engine.
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

/// Goes at the top of our classes.
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

/// Goes at the top of a class of the engine. The generator writes it.
#define GDEXTENSION_CLASS(m_class, m_inherits) \
	GDCLASS_COMMON(m_class, m_inherits) \
	static constexpr bool _is_engine_class = true; \
\
private:
