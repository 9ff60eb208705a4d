#pragma once

#include <godot_cpp/core/gdextension_interface_loader.hpp>
#include <godot_cpp/core/marshal.hpp>

#include <array>

namespace godot::internal {

/// Converts the values to the engine's representation and calls `p_call` with an array of pointers
/// to them.
template <typename Call, typename... Args>
void with_pointers(const Call &p_call, const Args &...p_args) {
	[&](const auto &...p_wires) {
		const std::array<GDExtensionConstTypePtr, sizeof...(Args)> pointers{static_cast<const void *>(&p_wires)...};
		p_call(pointers.data());
	}(Marshal<Args>::wire(p_args)...);
}

/// Runs the constructor of a builtin type with the given index on uninitialized storage.
template <typename Self, int Index, typename... Args>
void construct(void *p_storage, const Args &...p_args) {
	static const GDExtensionPtrConstructor constructor =
			gdextension_interface::variant_get_ptr_constructor(builtin_type<Self>, Index);
	with_pointers([&](const GDExtensionConstTypePtr *p_pointers) { constructor(p_storage, p_pointers); }, p_args...);
}

/// Returns the result of `p_left Op p_right`.
template <GDExtensionVariantOperator Op, typename R, typename Left, typename Right>
R evaluate(const Left &p_left, const Right &p_right) {
	static const GDExtensionPtrOperatorEvaluator evaluator =
			gdextension_interface::variant_get_ptr_operator_evaluator(Op, builtin_type<Left>, builtin_type<Right>);
	R result;
	evaluator(p_left._native_ptr(), p_right._native_ptr(), &result);
	return result;
}

/// A method of a builtin type, looked up on construction.
class BuiltinMethod {
public:
	BuiltinMethod(GDExtensionVariantType p_type, const char *p_name, GDExtensionInt p_hash);

	template <typename R, typename... Args>
	R call(void *p_base, const Args &...p_args) const {
		if constexpr (std::is_void_v<R>) {
			run(p_base, nullptr, p_args...);
		} else {
			typename Marshal<R>::Wire result{};
			run(p_base, &result, p_args...);
			return Marshal<R>::adopt(result);
		}
	}

private:
	template <typename... Args>
	void run(void *p_base, void *r_result, const Args &...p_args) const {
		with_pointers(
				[&](const GDExtensionConstTypePtr *p_pointers) {
					method_(p_base, p_pointers, r_result, static_cast<int32_t>(sizeof...(Args)));
				},
				p_args...);
	}

	GDExtensionPtrBuiltInMethod method_;
};

} // namespace godot::internal
