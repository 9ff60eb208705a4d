#pragma once

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/string.hpp>

namespace thicket {

/// True for the placeholder that a dedicated server export substitutes for a mesh or a texture whose file it strips of visuals: a
/// PlaceholderMesh or a PlaceholderTexture2D.
bool is_stripped(const godot::Ref<godot::Resource> &p_resource);

/// A sentence for a node's warnings: a resource that a property needs was stripped, the consequence, and how to fix it.
godot::String stripped_problem(const godot::String &p_property, const godot::String &p_consequence);

} // namespace thicket
