#pragma once

#include "core/terrain/terrain.hpp"

#include <glm/vec3.hpp>

#include <optional>

namespace thicket {

/// Returns the first position at which a ray enters the ground from above, within `reach` meters,
/// or nothing if there is none. `direction` must be a unit vector. Ridges thinner than 1/128 of
/// `reach` may be missed. The search samples at most 163 heights.
std::optional<glm::dvec3> ground_on_ray(const Terrain &terrain, glm::dvec3 from, glm::dvec3 direction, double reach);

/// The axis of an orthogonal camera.
struct ParallelView {
	glm::dvec3 from{0.0}; ///< Position of the camera in world meters.
	glm::dvec3 direction{0.0, -1.0, 0.0};
	double reach = 4000.0;    ///< Maximum distance of the focus, in meters.
	double usual_depth = 0.0; ///< Distance of the focus, in meters, if the axis misses the ground.
};

/// Returns the focus of an orthogonal camera: the point at which its axis meets the ground. If
/// `terrain` is null or the axis misses its ground, a horizontal plane at the height `level`
/// (meters) replaces the ground. If the axis is less than 10 degrees below the horizon, or also
/// misses the plane, the focus is at `usual_depth`.
glm::dvec3 view_focus(const ParallelView &view, const Terrain *terrain, double level);

} // namespace thicket
