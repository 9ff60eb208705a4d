#include "core/terrain/solid.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

namespace thicket {

namespace {

constexpr double sagitta = 0.005;
constexpr int fewest_sides = 16;
constexpr int max_sides = 512;

/// Returns the points of a quarter of the unit circle from (1, 0) to (0, 1), both included, in
/// `steps` steps of equal angles. `steps` must be a power of two. The function only bisects angles,
/// because results of std::sin may differ between machines.
std::vector<glm::dvec2> quarter_circle(int steps) {
	std::vector<glm::dvec2> points{{1.0, 0.0}, {0.0, 1.0}};
	while (static_cast<int>(points.size()) <= steps) {
		std::vector<glm::dvec2> finer{points.front()};
		for (std::size_t index = 1; index < points.size(); ++index) {
			const glm::dvec2 sum = points[index - 1] + points[index];
			const double length = std::sqrt(sum.x * sum.x + sum.y * sum.y);
			finer.push_back({sum.x / length, sum.y / length});
			finer.push_back(points[index]);
		}
		points = std::move(finer);
	}
	return points;
}

/// Returns the points of the unit circle, counterclockwise from (1, 0) with x to the right and y up.
std::vector<glm::dvec2> unit_circle(int sides) {
	const std::vector<glm::dvec2> quarter = quarter_circle(sides / 4);
	std::vector<glm::dvec2> points;
	for (int quarter_index = 0; quarter_index < 4; ++quarter_index) {
		for (std::size_t index = 0; index + 1 < quarter.size(); ++index) {
			const glm::dvec2 &at = quarter[index];
			const std::array<glm::dvec2, 4> rotated{at, {-at.y, at.x}, -at, {at.y, -at.x}};
			points.push_back(rotated[static_cast<std::size_t>(quarter_index)]);
		}
	}
	return points;
}

void append(const glm::dvec3 &a, const glm::dvec3 &b, const glm::dvec3 &c, std::vector<glm::vec3> &r_corners) {
	for (const glm::dvec3 &corner : {a, b, c}) {
		r_corners.emplace_back(corner);
	}
}

/// Appends a solid of revolution about the y axis. `profile` lists distances from the axis (x) and
/// heights (y) in meters, from the top of the axis to its bottom. Round sides are approximated by
/// flat ones; see sides_of().
void append_revolved(std::span<const glm::dvec2> profile, std::vector<glm::vec3> &r_corners) {
	double radius = 0.0;
	for (const glm::dvec2 &at : profile) {
		radius = std::max(radius, at.x);
	}
	const std::vector<glm::dvec2> circle = unit_circle(sides_of(radius));
	for (std::size_t row = 0; row + 1 < profile.size(); ++row) {
		for (std::size_t side = 0; side < circle.size(); ++side) {
			const auto corner = [&](std::size_t which, std::size_t along) {
				const glm::dvec2 &at = profile[row + which];
				const glm::dvec2 &direction = circle[(side + along) % circle.size()];
				return glm::dvec3(at.x * direction.x, at.y, at.x * direction.y);
			};
			if (profile[row].x > 0.0) {
				append(corner(0, 0), corner(1, 0), corner(0, 1), r_corners);
			}
			if (profile[row + 1].x > 0.0) {
				append(corner(0, 1), corner(1, 0), corner(1, 1), r_corners);
			}
		}
	}
}

} // namespace

void append_box(const glm::dvec3 &size, std::vector<glm::vec3> &r_corners) {
	for (int axis = 0; axis < 3; ++axis) {
		for (const double side : {-0.5, 0.5}) {
			const auto corner = [&](double u, double v) {
				glm::dvec3 at(0.0);
				at[axis] = side * size[axis];
				at[(axis + 1) % 3] = u * size[(axis + 1) % 3];
				at[(axis + 2) % 3] = v * size[(axis + 2) % 3];
				return at;
			};
			// Swapping u and v on the negative side turns the face outward.
			const double half = side < 0.0 ? 0.5 : -0.5;
			append(corner(-0.5, -0.5), corner(half, -half), corner(0.5, 0.5), r_corners);
			append(corner(-0.5, -0.5), corner(0.5, 0.5), corner(-half, half), r_corners);
		}
	}
}

void append_cylinder(double radius, double height, std::vector<glm::vec3> &r_corners) {
	const double half = 0.5 * height;
	append_revolved(std::array<glm::dvec2, 4>{{{0.0, half}, {radius, half}, {radius, -half}, {0.0, -half}}}, r_corners);
}

void append_capsule(double radius, double height, std::vector<glm::vec3> &r_corners) {
	const double middle = std::max(0.5 * height - radius, 0.0);
	const std::vector<glm::dvec2> quarter = quarter_circle(sides_of(radius) / 4);
	std::vector<glm::dvec2> profile;
	for (auto at = quarter.rbegin(); at != quarter.rend(); ++at) {
		profile.push_back({radius * at->x, middle + radius * at->y});
	}
	for (const glm::dvec2 &at : quarter) {
		if (middle > 0.0 || at.y > 0.0) {
			profile.push_back({radius * at.x, -middle - radius * at.y});
		}
	}
	append_revolved(profile, r_corners);
}

int sides_of(double radius) {
	int sides = fewest_sides;
	// The sagitta of a flat side is about radius * 4.93 / sides^2.
	while (sides < max_sides && radius * 4.94 > sagitta * sides * sides) {
		sides *= 2;
	}
	return sides;
}

} // namespace thicket
