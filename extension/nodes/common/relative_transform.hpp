#pragma once

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/variant/transform3d.hpp>

namespace thicket {

/// Returns the transform of `node` in the local space of `space`, without any scale of `space`. Both
/// must be in the tree. Composes the local transforms below the closest common ancestor, so the
/// result stays bit-identical while both move with that ancestor.
godot::Transform3D relative_transform(const godot::Node3D &space, const godot::Node3D &node);

} // namespace thicket
