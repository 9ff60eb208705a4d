#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/core/singleton.hpp>
#include <godot_cpp/godot.hpp>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <utility>
#include <vector>

namespace godot {

namespace internal {

namespace {

thread_local Construction next_construction;

/// A class of the engine that is offered.
struct EngineClass {
	EngineClass(LazyName &p_name, const GDExtensionInstanceBindingCallbacks &p_callbacks) :
			name(p_name), callbacks(p_callbacks) {}

	LazyName &name;
	const GDExtensionInstanceBindingCallbacks &callbacks;
	std::atomic<void *> tag = nullptr; ///< Known to the engine only after the library is loaded.

	/// True for an object of the class or of one derived from it.
	bool wraps(GodotObject *p_object) {
		if (!tag) {
			tag = gdextension_interface::classdb_get_class_tag(name.get()._native_ptr());
		}
		return tag && gdextension_interface::object_cast_to(p_object, tag);
	}
};

std::deque<EngineClass> engine_classes; // Derived classes first.

std::mutex singletons_mutex;
std::vector<GDObjectInstanceID> singleton_ids;

} // namespace

void register_engine_class(LazyName &p_name, const GDExtensionInstanceBindingCallbacks &p_callbacks) {
	engine_classes.emplace_front(p_name, p_callbacks);
}

void Access::expect(const Construction &p_next) { next_construction = p_next; }

void Access::post_initialize(Object *p_object) { p_object->notification(Object::NOTIFICATION_POSTINITIALIZE); }

GodotObject *owner_of(const Object *p_object) { return p_object ? p_object->_owner : nullptr; }

Object *wrapper_of(GodotObject *p_object) {
	if (!p_object) {
		return nullptr;
	}
	void *wrapper = gdextension_interface::object_get_instance_binding(p_object, library, nullptr);
	if (!wrapper) {
		const auto nearest = std::find_if(engine_classes.begin(), engine_classes.end(),
				[p_object](EngineClass &engine_class) { return engine_class.wraps(p_object); });
		wrapper = gdextension_interface::object_get_instance_binding(p_object, library, &nearest->callbacks);
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

// The engine frees these objects after it has closed the library, when it could no longer call us to free a wrapper.
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
	const internal::Construction own = std::exchange(internal::next_construction, {});
	_owner = own.owner;
	if (!own.callbacks) {
		if (!_owner) {
			std::fputs("The engine makes its objects, and ours: C++ cannot.\n", stderr);
			std::abort();
		}
		return;
	}
	if (!_owner) {
		_owner = gdextension_interface::classdb_construct_object2(own.engine_class->_native_ptr());
	}
	if (own.extension_class) {
		gdextension_interface::object_set_instance(_owner, own.extension_class->_native_ptr(), this);
	}
	gdextension_interface::object_set_instance_binding(_owner, internal::library, this, own.callbacks);
}

} // namespace godot
