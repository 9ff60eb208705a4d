#pragma once

#include <godot_cpp/core/builtin_call.hpp>

#include <initializer_list>

namespace godot::internal {

/// A method of an engine class, looked up on construction (`classdb_get_method_bind`). If the
/// engine lacks the method, every call prints an error and returns a default value.
class EngineMethod {
public:
	EngineMethod(const char *p_class, const char *p_name, GDExtensionInt p_hash);

	template <typename R, typename... Args>
	R call(GodotObject *p_owner, const Args &...p_args) const {
		if constexpr (std::is_void_v<R>) {
			run(p_owner, nullptr, p_args...);
		} else {
			typename Marshal<R>::Wire result{};
			run(p_owner, &result, p_args...);
			return Marshal<R>::adopt(result);
		}
	}

	/// Calls a method with a variable number of arguments.
	template <typename R>
	R call_variants(GodotObject *p_owner, std::initializer_list<Variant> p_values) const {
		const Variant result = run_variants(p_owner, p_values);
		if constexpr (!std::is_void_v<R>) {
			return from_variant<R>(result);
		}
	}

private:
	template <typename... Args>
	void run(GodotObject *p_owner, void *r_result, const Args &...p_args) const {
		if (!check()) {
			return;
		}
		with_pointers(
				[&](const GDExtensionConstTypePtr *p_pointers) {
					gdextension_interface::object_method_bind_ptrcall(method_, p_owner, p_pointers, r_result);
				},
				p_args...);
	}
	Variant run_variants(GodotObject *p_owner, std::initializer_list<Variant> p_values) const;
	bool check() const;

	GDExtensionMethodBindPtr method_;
	const char *class_;
	const char *name_;
};

} // namespace godot::internal
