#pragma once

#include <godot_cpp/core/border.hpp>
#include <godot_cpp/core/signature.hpp>

#include <array>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <span>
#include <type_traits>
#include <vector>

namespace godot {

/// The names of a method and its arguments.
struct MethodDefinition {
	StringName name;
	std::vector<StringName> arguments;
};

MethodDefinition define_method(const StringName &p_name, std::initializer_list<const char *> p_arguments);

template <typename... Args>
MethodDefinition D_METHOD(const StringName &p_name, const Args &...p_arguments) {
	return define_method(p_name, {p_arguments...});
}

namespace internal {

/// A type-erased pointer to a member function, so that all methods can be stored in the same type.
class MethodPointer {
public:
	template <typename M>
	explicit MethodPointer(M p_method) {
		static_assert(sizeof(M) <= sizeof(bytes_) && std::is_trivially_copyable_v<M>);
		std::memcpy(bytes_.data(), &p_method, sizeof(M));
	}

	template <typename M>
	M as() const {
		M method;
		std::memcpy(&method, bytes_.data(), sizeof(M));
		return method;
	}

private:
	std::array<std::byte, 3 * sizeof(void *)> bytes_{};
};

/// A registered method. The engine passes a pointer to it with every call.
struct MethodBind {
	MethodPointer method;
	std::vector<Variant> defaults; ///< The default values of the last arguments.
};

/// The description of a method for the engine, with its entry points.
struct MethodDescription {
	std::span<const DescribedType> arguments;
	DescribedType result;
	bool has_result;
	uint32_t flags;
	GDExtensionClassMethodCall call;
	GDExtensionClassMethodPtrCall ptrcall;
};

/// The entry points for methods with a given pointer type. Methods are cast to members of Wrapped,
/// so that all classes share this code.
template <typename M>
struct MethodCalls {
	using Sign = Signature<M>;

	static MethodDescription describe() {
		return {Sign::arguments, described_type<typename Sign::Result>, Sign::has_result,
				Sign::is_const ? METHOD_FLAG_NORMAL | METHOD_FLAG_CONST : uint32_t{METHOD_FLAG_NORMAL}, call, ptrcall};
	}

	static void call(void *p_bind, GDExtensionClassInstancePtr p_instance, const GDExtensionConstVariantPtr *p_args,
			GDExtensionInt p_count, GDExtensionVariantPtr r_result, GDExtensionCallError *r_error) {
		const auto &bind = *static_cast<const MethodBind *>(p_bind);
		at_border("a call", [&] {
			Sign::call(static_cast<Wrapped *>(p_instance), bind.method.template as<M>(), p_args, p_count, bind.defaults,
					r_result, *r_error);
		});
	}
	static void ptrcall(void *p_bind, GDExtensionClassInstancePtr p_instance, const GDExtensionConstTypePtr *p_args,
			GDExtensionTypePtr r_result) {
		at_border("a call", [=] {
			Sign::ptrcall(static_cast<Wrapped *>(p_instance),
					static_cast<const MethodBind *>(p_bind)->method.template as<M>(), p_args, r_result);
		});
	}
};

} // namespace internal
} // namespace godot
