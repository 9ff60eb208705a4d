#pragma once

#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/transform3d.hpp>

namespace thicket {

/// Returns the smallest box that contains `p_a` and `p_b`.
godot::AABB joined(const godot::AABB &p_a, const godot::AABB &p_b);

/// Returns the smallest axis-aligned box that contains `p_box` after the transform.
godot::AABB transformed(const godot::AABB &p_box, const godot::Transform3D &p_transform);

} // namespace thicket
