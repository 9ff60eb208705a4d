#pragma once

#include "core/query/instance_query.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace thicket {

/// What a navigation mesh is baked for, and with.
struct NavigationAgent {
	double height = 1.5;       ///< Meters.
	double max_slope = 45.0;   ///< Degrees, of ground to walk on.
	double cell_size = 0.25;   ///< Meters, of the grid that is baked on,
	double cell_height = 0.25; ///< and of its steps.
};

/// An upright prism whose ground no agent may stand on.
struct Obstruction {
	std::vector<glm::dvec2> outline; ///< x and z, convex, around once.
	double bottom = 0.0;             ///< Meters of height.
	double top = 0.0;
};

/// What an instance keeps from being walked on, in a space of meters whose y is up and in which `basis` and `foot` are. It covers
/// every cell that the instance's cylinder stands on, seen from above: where that leans, as far up as an agent reaches. A cell counts
/// as the cylinder's if that touches it, as when a mesh is baked: a stem thinner than a cell is not lost between two of them. So the
/// outline is 0.7 cells wider than the cylinder, at its corners by half a cell more, or by a twenty-fifth if that is farther. It goes
/// deep enough for ground that falls off below the cylinder, and for an agent that would hit it with its head.
///
/// Distance from the outline is not its business: what bakes adds the agent's radius. False, and nothing, for an instance without a
/// width and for numbers that are not finite. Replaces `r_obstruction`, whose memory it uses again.
bool obstruct(const glm::dmat3 &basis, glm::dvec3 foot, const InstanceShape &shape, const NavigationAgent &agent,
		Obstruction &r_obstruction);

/// A hand-placed instance whose obstruction reaches farther, in meters, is a mistake: it would block the whole of any bake.
inline constexpr double max_obstruction_reach = 1000.0;

/// Meters from the foot of an instance of that scale at which its obstruction ends at the farthest.
double obstruction_reach(const InstanceShape &shape, double scale, const NavigationAgent &agent);

} // namespace thicket
