#pragma once

#include "core/terrain/terrain.hpp"

#include <cmath>
#include <cstdint>

namespace thicket {

/// The sides of the ground that rules permit: its top, seen from above, or all of its surfaces.
enum class GroundSides : std::uint8_t { top, all };

/// Returns true if instances can be placed on this ground: its height and normal are finite, and
/// the normal of a top points up.
inline bool is_ground(const Ground &ground, GroundSides sides = GroundSides::top) {
	return std::isfinite(ground.height) && std::isfinite(ground.normal.x) && std::isfinite(ground.normal.y) &&
			std::isfinite(ground.normal.z) && (ground.normal.y > 0.0f || sides == GroundSides::all);
}

} // namespace thicket
