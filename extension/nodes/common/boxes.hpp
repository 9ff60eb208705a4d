#pragma once

#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/transform3d.hpp>

namespace thicket {

/// The smallest box around both boxes.
godot::AABB joined(const godot::AABB &p_a, const godot::AABB &p_b);

/// The smallest box around the corners of `p_box` after the transform.
godot::AABB transformed(const godot::AABB &p_box, const godot::Transform3D &p_transform);

} // namespace thicket
