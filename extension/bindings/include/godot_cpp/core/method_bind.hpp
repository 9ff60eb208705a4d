#pragma once

#include <godot_cpp/core/signature.hpp>

#include <string>
#include <vector>

namespace godot {

/// A method's name and those of its arguments.
struct MethodDefinition {
	StringName name;
	std::vector<StringName> arguments;
};

template <typename... Args>
MethodDefinition D_METHOD(const StringName &p_name, const Args &...p_arguments) {
	return {p_name, {StringName(p_arguments)...}};
}

namespace internal {

/// A method that was registered: what the engine hands back with every call.
class MethodBind {
public:
	MethodBind() = default;
	MethodBind(const MethodBind &) = delete;
	MethodBind &operator=(const MethodBind &) = delete;
	virtual ~MethodBind() = default;
};

template <typename M>
class MethodBindOf final : public MethodBind {
	using Sign = Signature<M>;
	using Owner = typename Sign::Owner;

public:
	MethodBindOf(M p_method, std::vector<Variant> p_defaults) : method_(p_method), defaults_(std::move(p_defaults)) {}

	/// For `GDExtensionClassMethodInfo`.
	static void call(void *p_bind, GDExtensionClassInstancePtr p_instance, const GDExtensionConstVariantPtr *p_args,
			GDExtensionInt p_given, GDExtensionVariantPtr r_result, GDExtensionCallError *r_error) {
		const auto &bind = *static_cast<const MethodBindOf *>(p_bind);
		Sign::call(self(p_instance), bind.method_, p_args, p_given, bind.defaults_, r_result, *r_error);
	}
	static void ptrcall(void *p_bind, GDExtensionClassInstancePtr p_instance, const GDExtensionConstTypePtr *p_args,
			GDExtensionTypePtr r_result) {
		Sign::ptrcall(self(p_instance), static_cast<const MethodBindOf *>(p_bind)->method_, p_args, r_result);
	}

private:
	static Owner *self(GDExtensionClassInstancePtr p_instance) {
		return static_cast<Owner *>(static_cast<Wrapped *>(p_instance));
	}

	M method_;
	std::vector<Variant> defaults_; ///< Of the last arguments.
};

} // namespace internal
} // namespace godot
