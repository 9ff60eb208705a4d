#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

/// A range of distances, in meters, from a planet's center that contains all ground. It may be
/// wider than necessary. By default, it is empty.
struct GroundShell {
	double nearest = std::numeric_limits<double>::infinity();
	double farthest = -std::numeric_limits<double>::infinity();

	/// Returns the shell for ground of unknown extent.
	static GroundShell everywhere() { return {0.0, std::numeric_limits<double>::infinity()}; }

	void add(const GroundShell &other) {
		nearest = std::min(nearest, other.nearest);
		farthest = std::max(farthest, other.farthest);
	}

	/// Extends the shell by a triangle, whose corners are relative to the center. A triangle
	/// without an area has no effect, because it is not ground.
	void add(const glm::dvec3 &a, const glm::dvec3 &b, const glm::dvec3 &c) {
		const glm::dvec3 normal = glm::cross(b - a, c - a);
		const double squared = glm::dot(normal, normal);
		if (!(squared > 0.0)) {
			return;
		}
		const glm::dvec3 foot = normal * (glm::dot(a, normal) / squared); // The plane's point nearest to the center.
		const auto is_inside = [&](const glm::dvec3 &from, const glm::dvec3 &to) {
			return glm::dot(glm::cross(to - from, foot - from), normal) >= 0.0;
		};
		double min_distance = std::min({distance_to_edge(a, b), distance_to_edge(b, c), distance_to_edge(c, a)});
		if (is_inside(a, b) && is_inside(b, c) && is_inside(c, a)) {
			min_distance = std::min(min_distance, glm::length(foot));
		}
		add({min_distance, std::max({glm::length(a), glm::length(b), glm::length(c)})});
	}

	/// Returns a wider shell, rounded to multiples of `step`, so that most small edits to the
	/// ground do not change it.
	GroundShell widened() const {
		constexpr double step = 16.0;     // Meters.
		constexpr double rounding = 1e-3; // Meters.
		return {std::floor((nearest - rounding) / step) * step, std::ceil((farthest + rounding) / step) * step};
	}

	friend bool operator==(const GroundShell &, const GroundShell &) = default;

private:
	static double distance_to_edge(const glm::dvec3 &from, const glm::dvec3 &to) {
		const glm::dvec3 edge = to - from;
		const double squared = glm::dot(edge, edge);
		const double fraction = squared > 0.0 ? std::clamp(-glm::dot(from, edge) / squared, 0.0, 1.0) : 0.0;
		return glm::length(from + fraction * edge);
	}
};

} // namespace thicket
