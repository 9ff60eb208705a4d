#pragma once

#include <godot_cpp/variant/string.hpp>

namespace thicket {

/// Returns true for the path of a resource that has its own file. Returns false for a resource that
/// is built into a scene or another file.
inline bool is_own_file(const godot::String &p_path) { return !p_path.is_empty() && !p_path.contains("::"); }

/// Returns the name of a resource's file without folder and extension; empty if the resource is built-in.
inline godot::String name_of_file(const godot::String &p_path) {
	return is_own_file(p_path) ? p_path.get_file().get_basename() : godot::String();
}

} // namespace thicket
