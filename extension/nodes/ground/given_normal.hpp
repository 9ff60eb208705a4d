#pragma once

#include "core/terrain/terrain.hpp"

#include <godot_cpp/variant/vector3.hpp>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <limits>

namespace thicket {

/// Normalizes and stores a normal that a script or another node has returned. A normal that is zero
/// or not finite means that there is no ground; in that case, sets the height to NAN instead.
inline void take_normal(const godot::Vector3 &p_given, Ground &r_ground) {
	const glm::vec3 normal{p_given.x, p_given.y, p_given.z};
	const float length = std::sqrt(glm::dot(normal, normal));
	if (std::isfinite(length) && length > 0.0F) {
		r_ground.normal = normal / length;
	} else {
		r_ground.height = std::numeric_limits<float>::quiet_NaN();
	}
}

} // namespace thicket
