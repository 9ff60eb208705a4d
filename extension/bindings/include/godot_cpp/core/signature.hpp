#pragma once

#include <godot_cpp/core/marshal.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace godot::internal {

/// The description of a type for scripts.
struct DescribedType {
	PropertyInfo (*info)();
	GDExtensionClassMethodArgumentMetadata metadata;
};

template <typename T>
inline constexpr DescribedType described_type{&Marshal<T>::info, Marshal<T>::metadata};

/// Collects the arguments of a call in `r_values`. `p_defaults` are the defaults of the last
/// arguments and replace missing ones. If the number of arguments is wrong, sets `r_error` and
/// returns false.
bool take_arguments(const GDExtensionConstVariantPtr *p_args, GDExtensionInt p_count,
		const std::vector<Variant> &p_defaults, std::span<GDExtensionConstVariantPtr> r_values,
		GDExtensionCallError &r_error);

template <typename M>
struct Signature;

/// The argument and result types of a member function, with entry points for the engine's two kinds
/// of calls.
template <typename C, typename R, typename... Args>
struct Signature<R (C::*)(Args...)> {
	using Owner = C;
	using OfWrapped = R (Wrapped::*)(Args...);
	static constexpr bool has_result = !std::is_void_v<R>;
	static constexpr bool is_const = false;

	using Result = std::conditional_t<has_result, std::decay_t<R>, bool>; // bool stands in for void.

	static constexpr std::array<DescribedType, sizeof...(Args)> arguments{described_type<std::decay_t<Args>>...};

	/// Performs a pointer call, whose arguments have the registered types.
	template <typename M>
	static void ptrcall(C *p_self, M p_method, const GDExtensionConstTypePtr *p_args, void *r_result) {
		ptrcall(p_self, p_method, p_args, r_result, std::index_sequence_for<Args...>());
	}

	/// Performs a call with Variants. `p_defaults` replace missing arguments. If the number of
	/// arguments is wrong, or an argument has the wrong type, sets `r_error` and does not call the
	/// method.
	template <typename M>
	static void call(C *p_self, M p_method, const GDExtensionConstVariantPtr *p_args, GDExtensionInt p_count,
			const std::vector<Variant> &p_defaults, void *r_result, GDExtensionCallError &r_error) {
		std::array<GDExtensionConstVariantPtr, sizeof...(Args)> values{};
		if (take_arguments(p_args, p_count, p_defaults, values, r_error)) {
			call(p_self, p_method, values.data(), static_cast<Variant *>(r_result), r_error,
					std::index_sequence_for<Args...>());
		}
	}

private:
	template <typename M, std::size_t... I>
	static void ptrcall(C *p_self, M p_method, [[maybe_unused]] const GDExtensionConstTypePtr *p_args,
			[[maybe_unused]] void *r_result, std::index_sequence<I...>) {
		if constexpr (has_result) {
			Marshal<Result>::encode((p_self->*p_method)(Marshal<std::decay_t<Args>>::decode(p_args[I])...), r_result);
		} else {
			(p_self->*p_method)(Marshal<std::decay_t<Args>>::decode(p_args[I])...);
		}
	}

	template <typename M, std::size_t... I>
	static void call(C *p_self, M p_method, [[maybe_unused]] const GDExtensionConstVariantPtr *p_args,
			[[maybe_unused]] Variant *r_result, [[maybe_unused]] GDExtensionCallError &r_error,
			std::index_sequence<I...>) {
		if (!(fits<std::decay_t<Args>>(value(p_args[I]), I, r_error) && ...)) {
			return;
		}
		if constexpr (has_result) {
			*r_result = (p_self->*p_method)(from_variant<std::decay_t<Args>>(value(p_args[I]))...);
		} else {
			(p_self->*p_method)(from_variant<std::decay_t<Args>>(value(p_args[I]))...);
		}
	}

	static const Variant &value(GDExtensionConstVariantPtr p_value) { return *static_cast<const Variant *>(p_value); }

	template <typename T>
	static bool fits(const Variant &p_value, std::size_t p_index, GDExtensionCallError &r_error) {
		if (Marshal<T>::fits(p_value)) {
			return true;
		}
		r_error = {GDEXTENSION_CALL_ERROR_INVALID_ARGUMENT, static_cast<int32_t>(p_index),
				static_cast<int32_t>(Marshal<T>::type)};
		return false;
	}
};

template <typename C, typename R, typename... Args>
struct Signature<R (C::*)(Args...) const> : Signature<R (C::*)(Args...)> {
	using OfWrapped = R (Wrapped::*)(Args...) const;
	static constexpr bool is_const = true;
};

} // namespace godot::internal
