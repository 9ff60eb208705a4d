#pragma once

#include <godot_cpp/variant/string.hpp>

namespace thicket {

/// True if a resource with this path is a file of its own, and not a part of another file, such as a scene.
inline bool is_own_file(const godot::String &p_path) { return !p_path.is_empty() && !p_path.contains("::"); }

/// The name of a resource's own file without its folder and extension; empty if it has none.
inline godot::String name_of_file(const godot::String &p_path) {
	return is_own_file(p_path) ? p_path.get_file().get_basename() : godot::String();
}

} // namespace thicket
