#include "core/near/obstruction.hpp"

#include "core/base/trigonometry.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace thicket {

namespace {

/// Maximum slope used, in degrees. It ensures that ground falls by less than four times the
/// horizontal distance.
constexpr double steepest = 75.0;

constexpr int few_corners = 8;
constexpr int many_corners = 12;

constexpr double degrees_in_turn = 360.0;

/// Distance from the center of a cell to a corner, as a multiple of the cell size.
constexpr double half_diagonal = 0.7071067811865476;

Rotation towards(double corner, int corners) { return rotation_by(corner / corners); }

/// Returns the circumradius of a regular polygon that encloses a circle.
double around(double radius, int corners) { return radius / towards(0.5, corners).cosine; }

/// Returns the number of corners of the polygon around a circle. Corners cost time in a bake, which
/// compares each of them with the cells around it. The result is eight if the polygon is then at
/// most half a cell wider than the circle.
int corners_around(double radius, const NavigationAgent &agent) {
	return around(radius, few_corners) - radius <= 0.5 * agent.cell_size ? few_corners : many_corners;
}

/// Returns the rise, in meters, of the steepest walkable ground over a horizontal distance.
double rise(double way, const NavigationAgent &agent) {
	const Rotation slope = rotation_by(std::clamp(agent.max_slope, 0.0, steepest) / degrees_in_turn);
	return way * slope.sine / slope.cosine;
}

/// Computes the outline of a polygon that encloses a circle and is swept from `middle` along
/// `lean`.
void outline(glm::dvec2 middle, double radius, int corners, glm::dvec2 lean, std::vector<glm::dvec2> &r_outline) {
	const auto leads = [lean, corners](double side) {
		const Rotation normal = towards(side, corners);
		return lean.x * normal.cosine + lean.y * normal.sine > 0.0;
	};
	const double wide = around(radius, corners);
	r_outline.clear();
	bool moved = leads(-0.5);
	for (int corner = 0; corner < corners; ++corner) {
		const Rotation at = towards(corner, corners);
		const glm::dvec2 position = middle + wide * glm::dvec2(at.cosine, at.sine);
		r_outline.push_back(moved ? position + lean : position);
		const bool moves = leads(corner + 0.5);
		if (moves != moved) {
			r_outline.push_back(moves ? position + lean : position);
		}
		moved = moves;
	}
}

} // namespace

bool obstruct(const glm::dmat3 &basis, glm::dvec3 foot, const InstanceShape &shape, const NavigationAgent &agent,
		Obstruction &r_obstruction) {
	const double radius = shape.radius * std::max(glm::length(basis[0]), glm::length(basis[2]));
	const glm::dvec3 axis = basis[1] * shape.height;
	if (!(radius > 0.0) || !std::isfinite(radius + axis.x + axis.y + axis.z + foot.x + foot.y + foot.z)) {
		return false;
	}
	const double falls = rise(radius, agent);
	const double touched = agent.height + falls;
	const double fraction = axis.y > touched ? touched / axis.y : 1.0;
	const double clearance = radius + half_diagonal * agent.cell_size;
	outline({foot.x, foot.z}, clearance, corners_around(clearance, agent), fraction * glm::dvec2(axis.x, axis.z),
			r_obstruction.outline);
	r_obstruction.bottom = foot.y + std::min(axis.y, 0.0) - std::max(agent.height, falls) - agent.cell_height;
	r_obstruction.top = foot.y + std::max(axis.y, falls) + agent.cell_height;
	return true;
}

double obstruction_reach(const InstanceShape &shape, double scale, const NavigationAgent &agent) {
	return around((shape.radius + shape.height) * scale + agent.cell_size, few_corners);
}

} // namespace thicket
