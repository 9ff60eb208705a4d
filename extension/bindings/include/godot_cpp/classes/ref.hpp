#pragma once

#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/core/marshal.hpp>
#include <godot_cpp/core/gdextension_interface_loader.hpp>

#include <utility>

namespace godot {

/// A counted reference to a RefCounted object, which is freed along with its last reference.
template <typename T>
class Ref {
public:
	Ref() = default;
	Ref(const Ref &p_from) : Ref(p_from.object_) {}
	Ref(Ref &&p_from) noexcept : object_(std::exchange(p_from.object_, nullptr)) {}
	template <typename Other>
	Ref(const Ref<Other> &p_from) : Ref(Object::cast_to<T>(p_from.ptr())) {}
	Ref(T *p_object) {
		// The first Ref takes over the initial reference of a new object.
		if (p_object && p_object->init_ref()) {
			object_ = p_object;
		}
	}
	Ref(const Variant &p_from) : Ref(Object::cast_to<T>(p_from.get_validated_object())) {}
	~Ref() {
		if (object_ && object_->unreference()) {
			gdextension_interface::object_destroy(object_->_owner); // The engine also frees the wrapper.
		}
	}

	// As in godot-cpp, assignments return nothing, and pointers and {} are ambiguous.
	void operator=(const Ref &p_from) { swap(Ref(p_from)); }
	template <typename Other>
	void operator=(const Ref<Other> &p_from) {
		swap(Ref(p_from));
	}
	void operator=(const Variant &p_from) { swap(Ref(p_from)); }

	T *ptr() const { return object_; }
	T *operator->() const { return object_; }
	bool is_valid() const { return object_ != nullptr; }
	bool is_null() const { return object_ == nullptr; }
	bool operator==(const Ref &p_other) const { return object_ == p_other.object_; }
	operator Variant() const { return Variant(static_cast<const Object *>(object_)); }

	/// Returns a Ref that takes over a reference that the engine has already counted.
	static Ref _adopt(T *p_object) {
		Ref result;
		result.object_ = p_object;
		return result;
	}

private:
	void swap(Ref &&p_from) { std::swap(object_, p_from.object_); }

	T *object_ = nullptr;
};

namespace internal {

template <typename T>
struct Marshal<Ref<T>> : Marshal<T *> {
	static PropertyInfo info() {
		return PropertyInfo(Variant::OBJECT, StringName(), PROPERTY_HINT_RESOURCE_TYPE, T::get_class_static());
	}
	static GodotObject *wire(const Ref<T> &p_value) { return owner_of(p_value.ptr()); }
	static Ref<T> adopt(GodotObject *p_wire) { return Ref<T>::_adopt(Marshal<T *>::adopt(p_wire)); }
	static Ref<T> decode(const void *p_wire) {
		return Ref<T>(Marshal<T *>::adopt(gdextension_interface::ref_get_object(p_wire)));
	}
	static void encode(const Ref<T> &p_value, void *r_wire) {
		gdextension_interface::ref_set_object(r_wire, owner_of(p_value.ptr()));
	}
};

} // namespace internal
} // namespace godot
