#pragma once

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/string.hpp>

namespace thicket {

/// Returns true for a PlaceholderMesh or PlaceholderTexture2D. A dedicated server export replaces
/// meshes and textures with these placeholders when it strips visuals.
bool is_stripped(const godot::Ref<godot::Resource> &p_resource);

/// Returns a configuration warning that names the property with the stripped resource, the
/// consequence, and the fix.
godot::String stripped_problem(const godot::String &p_property, const godot::String &p_consequence);

} // namespace thicket
