#pragma once

#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <array>
#include <concepts>

namespace thicket {

/// Calls `p_method` of `p_target`, an object or Callable from a script. Returns
/// GDEXTENSION_CALL_OK, or the reason why the call was not possible; Callable::call and
/// Object::call do not report this reason. May run any script code.
inline GDExtensionCallErrorType call_script(godot::Variant &p_target, const godot::StringName &p_method,
		godot::Variant &r_result, const std::same_as<godot::Variant> auto &...p_arguments) {
	std::array<const godot::Variant *, sizeof...(p_arguments)> arguments{&p_arguments...};
	GDExtensionCallError error{};
	p_target.callp(p_method, arguments.data(), static_cast<int>(arguments.size()), r_result, error);
	return error.error;
}

} // namespace thicket
