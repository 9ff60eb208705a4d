#pragma once

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/string.hpp>

namespace thicket {

/// Returns true for a PlaceholderMesh or PlaceholderTexture2D. A dedicated server export replaces
/// meshes and textures with these placeholders when it strips visuals.
bool is_stripped(const godot::Ref<godot::Resource> &p_resource);

/// Returns a sentence for a node's warnings, which names the property whose resource was stripped,
/// the consequence, and the remedy.
godot::String stripped_problem(const godot::String &p_property, const godot::String &p_consequence);

} // namespace thicket
