#pragma once

#include "core/terrain/terrain.hpp"

#include <glm/vec3.hpp>

#include <optional>

namespace thicket {

/// The first position where a ray enters the ground from above, within `reach` meters. Returns nothing if there is none. `direction` is a
/// unit vector. A ridge thinner than 1/128 of the reach may be missed. Samples at most 160 heights.
std::optional<glm::dvec3> ground_on_ray(const Terrain &terrain, glm::dvec3 from, glm::dvec3 direction, double reach);

/// The axis of an orthogonal camera.
struct ParallelView {
	glm::dvec3 from{0.0}; ///< World meters.
	glm::dvec3 direction{0.0, -1.0, 0.0};
	double reach = 4000.0;    ///< How far the camera sees, in meters.
	double usual_depth = 0.0; ///< Depth of the focus in meters where the axis misses the ground.
};

/// The focus of a camera with a parallel projection: the point where its axis meets the ground. Where the ground is
/// missing or cannot be sampled (null), a plane at `level` replaces it. The focus is at `usual_depth` if the axis is
/// less than 10 degrees below the horizon or meets neither.
glm::dvec3 view_focus(const ParallelView &view, const Terrain *terrain, double level);

} // namespace thicket
