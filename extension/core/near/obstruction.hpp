#pragma once

#include "core/query/instance_query.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace thicket {

/// The agent for which a navigation mesh is baked, and the bake settings.
struct NavigationAgent {
	double height = 1.5;       ///< Height of the agent in meters.
	double max_slope = 45.0;   ///< Maximum slope of walkable ground, in degrees.
	double cell_size = 0.25;   ///< Horizontal cell size of the bake grid, in meters.
	double cell_height = 0.25; ///< Vertical cell size of the bake grid, in meters.
};

/// An upright prism that marks unwalkable ground.
struct Obstruction {
	std::vector<glm::dvec2> outline; ///< Convex polygon in the xz plane, with its corners in order.
	double bottom = 0.0;             ///< Height of the lower end in meters.
	double top = 0.0;
};

/// Computes the space that an instance blocks for walking, in the coordinate space of `basis` and
/// `foot`, in meters with y up. The obstruction covers every cell that the instance's cylinder
/// touches, as seen from above. If the cylinder leans, only its part up to the agent's height is
/// used.
///
/// A cell is covered as soon as the cylinder touches it, as when a mesh is baked. Otherwise, a stem
/// thinner than a cell could be lost between two cells. The outline is therefore 0.7 cells wider
/// than the cylinder. Its corners extend farther by up to half a cell or 4 % of its radius,
/// whichever is larger. The prism extends down far enough for ground that falls away from the
/// cylinder, and for an agent whose head would hit the cylinder.
///
/// The obstruction excludes the agent's radius, because the bake adds it. Returns false if the
/// instance has no width or a number is not finite; `r_obstruction` is then unchanged. Otherwise,
/// replaces `r_obstruction` and reuses its memory.
bool obstruct(const glm::dmat3 &basis, glm::dvec3 foot, const InstanceShape &shape, const NavigationAgent &agent,
		Obstruction &r_obstruction);

/// Maximum reach, in meters, of the obstruction of a hand-placed instance. A larger one is a
/// mistake, because it would block the whole area of any bake.
inline constexpr double max_obstruction_reach = 1000.0;

/// Returns the maximum horizontal distance, in meters, from the foot of an instance of this scale
/// to the edge of its obstruction.
double obstruction_reach(const InstanceShape &shape, double scale, const NavigationAgent &agent);

} // namespace thicket
