#pragma once

#include "core/terrain/terrain.hpp"

#include <glm/vec3.hpp>

#include <optional>

namespace thicket {

/// The first position where a ray enters the ground from above, within `reach` meters; nothing if there is none. `direction` is a unit
/// vector. A ridge that is thinner than 1/128 of the reach may be missed. Asks for 160 heights at most.
std::optional<glm::dvec3> ground_on_ray(const Terrain &terrain, glm::dvec3 from, glm::dvec3 direction, double reach);

/// The axis of a camera that sees in parallel.
struct ParallelView {
	glm::dvec3 from{0.0}; ///< World meters.
	glm::dvec3 direction{0.0, -1.0, 0.0};
	double reach = 4000.0;    ///< Meters that the camera sees.
	double usual_depth = 0.0; ///< Meters to what the camera looks at where the axis does not meet the ground.
};

/// What such a camera looks at: where its axis meets the ground. For ground that cannot be sampled (null), and beside the ground, that
/// is taken to be a plane at `level`. An axis that is less than 10 degrees below the horizon, or that meets neither, ends at `usual_depth`.
glm::dvec3 view_focus(const ParallelView &view, const Terrain *terrain, double level);

} // namespace thicket
