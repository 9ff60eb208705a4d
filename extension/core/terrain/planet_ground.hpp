#pragma once

#include "core/base/planet.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

namespace thicket {

/// Converts ground from world space to the frame of a planet. The height becomes the altitude, and
/// the slope of the normal becomes relative to the direction away from the center. `position` is
/// the ground's world x and z.
inline Ground on_planet(const Planet &planet, glm::dvec2 position, const Ground &ground) {
	const glm::dvec3 on_ground(position.x, ground.height, position.y);
	return {static_cast<float>(planet.altitude(on_ground)), planet.upright(ground.normal, on_ground), ground.weight,
			ground.density};
}

} // namespace thicket
