#pragma once

#include <godot_cpp/core/signature.hpp>
#include <godot_cpp/variant/callable.hpp>

#include <functional>
#include <memory>

namespace godot {
namespace internal {

/// A method of an object as a Callable; equal to others of the same object and method.
class CallableMethod {
public:
	virtual ~CallableMethod() = default;
	virtual void call(const GDExtensionConstVariantPtr *p_args, GDExtensionInt p_count, Variant *r_result,
			GDExtensionCallError &r_error) = 0;
	virtual bool equals(const CallableMethod &p_other) const = 0;
	virtual uint32_t hash() const = 0;

	/// Hands it over to the engine (`callable_custom_create2`).
	static Callable make(std::unique_ptr<CallableMethod> p_method, Object *p_object);
};

template <typename T, typename M>
class CallableMethodOf final : public CallableMethod {
	using Sign = Signature<M>;

public:
	CallableMethodOf(T *p_object, M p_method) : object_(p_object), method_(p_method) {}

	// The engine does not call it once the object is gone.
	void call(const GDExtensionConstVariantPtr *p_args, GDExtensionInt p_count, Variant *r_result,
			GDExtensionCallError &r_error) override {
		Sign::call(object_, method_, p_args, p_count, r_result, r_error);
	}

	bool equals(const CallableMethod &p_other) const override {
		const auto *other = dynamic_cast<const CallableMethodOf *>(&p_other);
		return other && other->object_ == object_ && other->method_ == method_;
	}

	uint32_t hash() const override { return static_cast<uint32_t>(std::hash<T *>()(object_)); }

private:
	T *object_;
	M method_;
};

} // namespace internal

/// A Callable of a method of an object; the method need not be registered.
template <typename T, typename M>
Callable callable_mp(T *p_object, M p_method) {
	return internal::CallableMethod::make(
			std::make_unique<internal::CallableMethodOf<T, M>>(p_object, p_method), p_object);
}

} // namespace godot
