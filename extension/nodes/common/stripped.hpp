#pragma once

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/string.hpp>

namespace thicket {

/// True for what an export as a dedicated server puts in place of a mesh or a texture whose file it strips of visuals: a PlaceholderMesh, a
/// PlaceholderTexture2D.
bool is_stripped(const godot::Ref<godot::Resource> &p_resource);

/// A sentence for the problems of a node: a resource that a property needs was stripped, what follows, and what helps.
godot::String stripped_problem(const godot::String &p_property, const godot::String &p_consequence);

} // namespace thicket
