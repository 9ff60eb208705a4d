#pragma once

#include <godot_cpp/core/gdextension_interface_loader.hpp>
#include <godot_cpp/core/lazy_name.hpp>
#include <godot_cpp/core/marshal.hpp>

#include <array>

namespace godot::internal {

/// Returns true if the object has a script that implements the method.
bool has_script_method(GodotObject *p_owner, const StringName &p_name);

/// Calls a method of the object's script (`object_call_script_method`). Returns false if the method
/// does not exist or cannot be called with these arguments.
bool call_script_method(GodotObject *p_owner, const StringName &p_name, const Variant *const *p_args,
		std::size_t p_count, Variant &r_result);

template <typename F>
struct ScriptVirtual;

/// A const method R(Args...) that scripts may override.
template <typename R, typename... Args>
struct ScriptVirtual<R(Args...)> {
	static bool call(GodotObject *p_owner, const StringName &p_name, const Args &...p_args, R &r_result) {
		const std::array<Variant, sizeof...(Args)> values{Variant(p_args)...};
		std::array<const Variant *, sizeof...(Args)> pointers;
		for (std::size_t i = 0; i < values.size(); ++i) {
			pointers[i] = &values[i];
		}
		Variant result;
		if (!call_script_method(p_owner, p_name, pointers.data(), pointers.size(), result)) {
			return false;
		}
		r_result = from_variant<R>(result);
		return true;
	}

	static MethodInfo info(const StringName &p_name) {
		MethodInfo result(p_name, Marshal<Args>::info()...);
		result.flags = METHOD_FLAG_VIRTUAL | METHOD_FLAG_CONST;
		result.arguments_metadata = {Marshal<Args>::metadata...};
		result.return_val = Marshal<R>::info();
		result.return_val_metadata = Marshal<R>::metadata;
		return result;
	}
};

} // namespace godot::internal
