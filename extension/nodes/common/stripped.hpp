#pragma once

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/string.hpp>

namespace thicket {

/// True for a placeholder: a PlaceholderMesh or a PlaceholderTexture2D. A dedicated server export substitutes them for
/// meshes and textures whose files it strips of visuals.
bool is_stripped(const godot::Ref<godot::Resource> &p_resource);

/// A sentence for a node's warnings: a resource that a property needs was stripped, the consequence, and how to fix it.
godot::String stripped_problem(const godot::String &p_property, const godot::String &p_consequence);

} // namespace thicket
