#include "core/near/obstruction.hpp"

#include "core/base/trigonometry.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace thicket {

namespace {

constexpr int corners = 12;

/// Ground that is steeper counts as that steep: it falls off by no more than four times the way.
constexpr double steepest = 75.0;

constexpr double degrees_in_turn = 360.0;

/// From the middle of a cell to its corner, in sides.
constexpr double half_diagonal = 0.7071067811865476;

Rotation towards(double corner) { return rotation_by(corner / corners); }

/// A polygon around a circle is wider than it, at its corners.
double around(double radius) { return radius / towards(0.5).cosine; }

/// Meters that ground rises over a way.
double rise(double way, const NavigationAgent &agent) {
	const Rotation slope = rotation_by(std::clamp(agent.max_slope, 0.0, steepest) / degrees_in_turn);
	return way * slope.sine / slope.cosine;
}

/// The outline of a polygon with a radius that was drawn from the middle along `lean`.
void outline(glm::dvec2 middle, double radius, glm::dvec2 lean, std::vector<glm::dvec2> &r_outline) {
	const auto leads = [lean](double side) {
		const Rotation normal = towards(side);
		return lean.x * normal.cosine + lean.y * normal.sine > 0.0;
	};
	r_outline.clear();
	bool moved = leads(-0.5);
	for (int corner = 0; corner < corners; ++corner) {
		const Rotation at = towards(corner);
		const glm::dvec2 position = middle + radius * glm::dvec2(at.cosine, at.sine);
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
	const double share = axis.y > touched ? touched / axis.y : 1.0;
	const double wide = around(radius + half_diagonal * agent.cell_size);
	outline({foot.x, foot.z}, wide, share * glm::dvec2(axis.x, axis.z), r_obstruction.outline);
	r_obstruction.bottom = foot.y + std::min(axis.y, 0.0) - std::max(agent.height, falls) - agent.cell_height;
	r_obstruction.top = foot.y + std::max(axis.y, falls) + agent.cell_height;
	return true;
}

double obstruction_reach(const InstanceShape &shape, double scale, const NavigationAgent &agent) {
	return around((shape.radius + shape.height) * scale + agent.cell_size);
}

} // namespace thicket
