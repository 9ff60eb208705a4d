#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/core/border.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/core/singleton.hpp>
#include <godot_cpp/godot.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

namespace godot {

namespace internal {

namespace {

thread_local GodotObject *next_owner = nullptr;

/// An engine class for which the bindings provide a wrapper.
struct EngineClass {
	EngineClass(LazyName &p_name, const GDExtensionInstanceBindingCallbacks &p_callbacks) :
			name(p_name), callbacks(p_callbacks) {}

	LazyName &name;
	const GDExtensionInstanceBindingCallbacks &callbacks;
	/// Null until the first use, because the engine may provide it only after it has loaded the
	/// library.
	std::atomic<void *> tag = nullptr;

	/// Returns true for an object of this class or of a derived class.
	bool wraps(GodotObject *p_object) {
		if (!tag) {
			tag = gdextension_interface::classdb_get_class_tag(name.get()._native_ptr());
		}
		return tag && gdextension_interface::object_cast_to(p_object, tag);
	}
};

std::deque<EngineClass> engine_classes; // The engine classes with wrappers. Derived classes come first.

std::mutex singletons_mutex;
std::vector<GDObjectInstanceID> singleton_ids;

} // namespace

void register_engine_class(LazyName &p_name, const GDExtensionInstanceBindingCallbacks &p_callbacks) {
	engine_classes.emplace_front(p_name, p_callbacks);
}

GodotObject *Access::new_object(const StringName &p_engine_class) {
	GodotObject *object = gdextension_interface::classdb_construct_object2(p_engine_class._native_ptr());
	if (!object) {
		throw std::bad_alloc();
	}
	return object;
}

void Access::expect(GodotObject *p_owner) { next_owner = p_owner; }

void Access::attach(Wrapped *p_wrapped, const StringName *p_extension_class,
		const GDExtensionInstanceBindingCallbacks &p_callbacks) {
	if (p_extension_class) {
		gdextension_interface::object_set_instance(p_wrapped->_owner, p_extension_class->_native_ptr(), p_wrapped);
	}
	gdextension_interface::object_set_instance_binding(p_wrapped->_owner, library, p_wrapped, &p_callbacks);
}

void report_exception(const char *p_entry) noexcept {
	const char *reason = nullptr;
	try {
		throw;
	} catch (const std::bad_alloc &) {
		reason = "needs more memory than is available";
	} catch (const std::length_error &) {
		reason = "needs more memory than is available";
	} catch (...) {
		reason = "failed within";
	}
	std::array<char, 256> text{};
	std::snprintf(text.data(), text.size(), "Thicket: %s %s", p_entry, reason);
	gdextension_interface::print_error(text.data(), __FUNCTION__, __FILE__, __LINE__, false);
}

void Access::post_initialize(Object *p_object) { p_object->notification(Object::NOTIFICATION_POSTINITIALIZE); }

GodotObject *owner_of(const Object *p_object) { return p_object ? p_object->_owner : nullptr; }

Object *wrapper_of(GodotObject *p_object) {
	if (!p_object) {
		return nullptr;
	}
	void *wrapper = gdextension_interface::object_get_instance_binding(p_object, library, nullptr);
	if (!wrapper) {
		const auto match = std::find_if(engine_classes.begin(), engine_classes.end(),
				[p_object](EngineClass &engine_class) { return engine_class.wraps(p_object); });
		wrapper = gdextension_interface::object_get_instance_binding(p_object, library, &match->callbacks);
		if (!wrapper) {
			// Remove the null binding. Otherwise the engine keeps it and never requests a new one.
			gdextension_interface::object_free_instance_binding(p_object, library);
			throw std::bad_alloc();
		}
	}
	return static_cast<Object *>(static_cast<Wrapped *>(wrapper));
}

Object *find_singleton(const StringName &p_name) {
	GodotObject *object = gdextension_interface::global_get_singleton(p_name._native_ptr());
	if (object && !gdextension_interface::object_get_instance_binding(object, library, nullptr)) {
		const std::lock_guard lock(singletons_mutex);
		singleton_ids.push_back(gdextension_interface::object_get_instance_id(object));
	}
	return wrapper_of(object);
}

// Frees the wrappers of singletons. The engine frees the singletons only after it has unloaded the
// library, and can then no longer call the library to free a wrapper.
void release_wrappers() {
	for (const GDObjectInstanceID id : singleton_ids) {
		if (GodotObject *object = gdextension_interface::object_get_instance_from_id(id)) {
			gdextension_interface::object_free_instance_binding(object, library);
		}
	}
	singleton_ids.clear();
	engine_classes.clear();
}

} // namespace internal

Wrapped::Wrapped() {
	_owner = std::exchange(internal::next_owner, nullptr);
	if (!_owner) {
		std::fputs("The engine creates its objects and ours; C++ code cannot.\n", stderr);
		std::abort();
	}
}

} // namespace godot
