#pragma once

#include "core/query/instance_query.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace thicket {

/// The agent that a navigation mesh is baked for, and the settings of the bake.
struct NavigationAgent {
	double height = 1.5;       ///< Meters.
	double max_slope = 45.0;   ///< Degrees, of walkable ground.
	double cell_size = 0.25;   ///< Meters, of the grid used for baking,
	double cell_height = 0.25; ///< and of its vertical steps.
};

/// An upright prism that marks ground on which no agent may stand.
struct Obstruction {
	std::vector<glm::dvec2> outline; ///< x and z, convex, in order around it.
	double bottom = 0.0;             ///< Meters of height.
	double top = 0.0;
};

/// Computes the space that an instance blocks for walking, in the space of `basis` and `foot`, which is in meters with
/// y up. The obstruction covers every cell that the instance's cylinder touches, as seen from above; for a leaning
/// cylinder, only the part up to an agent's height counts. A cell counts as soon as the cylinder touches it, as in a
/// bake of a mesh. So a stem thinner than a cell is not lost between two cells. The outline is therefore 0.7 cells
/// wider than the cylinder. At its corners it is wider by a further half cell, or by a twenty-fifth if that is more.
/// The prism is deep enough for ground that falls off below the cylinder, and for an agent whose head would hit the
/// cylinder.
///
/// The obstruction does not include the agent's radius, because the bake adds it. Returns false, without an
/// obstruction, for an instance without a width and for numbers that are not finite. Replaces `r_obstruction` and
/// reuses its memory.
bool obstruct(const glm::dmat3 &basis, glm::dvec3 foot, const InstanceShape &shape, const NavigationAgent &agent,
		Obstruction &r_obstruction);

/// A hand-placed instance whose obstruction reaches farther, in meters, is a mistake: it would block the whole area of any bake.
inline constexpr double max_obstruction_reach = 1000.0;

/// The largest distance in meters from the foot of an instance of this scale to the end of its obstruction.
double obstruction_reach(const InstanceShape &shape, double scale, const NavigationAgent &agent);

} // namespace thicket
