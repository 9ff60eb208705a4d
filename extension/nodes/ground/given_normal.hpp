#pragma once

#include "core/terrain/terrain.hpp"

#include <godot_cpp/variant/vector3.hpp>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <limits>

namespace thicket {

/// Sets the normal of `r_ground` to the normalized result of a script or another node. A normal
/// that is zero or not finite means that there is no ground. Sets the height to NAN in that case.
inline void set_normal(const godot::Vector3 &p_normal, Ground &r_ground) {
	const glm::vec3 normal{p_normal.x, p_normal.y, p_normal.z};
	const float length = std::sqrt(glm::dot(normal, normal));
	if (std::isfinite(length) && length > 0.0F) {
		r_ground.normal = normal / length;
	} else {
		r_ground.height = std::numeric_limits<float>::quiet_NaN();
	}
}

} // namespace thicket
