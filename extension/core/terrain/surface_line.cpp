#include "core/terrain/surface_line.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace thicket {

namespace {

/// Barycentric coordinates may be this far outside a triangle, so that rounding leaves no gaps
/// between triangles.
constexpr double border = 1e-9;

/// The number of pieces of a line that are searched one after the other.
constexpr int pieces = 128;

/// The part of a line inside a box, as fractions of the line. Empty if `begin` is not below `end`.
struct Part {
	double begin = 0.0;
	double end = 1.0;
};

Part part_inside(const Box3 &box, const glm::dvec3 &from, const glm::dvec3 &to) {
	Part part;
	for (int axis = 0; axis < 3; ++axis) {
		const double way = to[axis] - from[axis];
		const double a = (box.min[axis] - from[axis]) / way;
		const double b = (box.max[axis] - from[axis]) / way;
		if (way != 0.0) {
			part = {std::max(part.begin, std::min(a, b)), std::min(part.end, std::max(a, b))};
		} else if (from[axis] < box.min[axis] || from[axis] > box.max[axis]) {
			return {1.0, 0.0};
		}
	}
	return part;
}

} // namespace

double distance_along(const std::array<glm::dvec3, 3> &corners, const glm::dvec3 &from, const glm::dvec3 &direction) {
	const glm::dvec3 first = corners[1] - corners[0];
	const glm::dvec3 second = corners[2] - corners[0];
	const glm::dvec3 cross = glm::cross(first, second);
	const double facing = glm::dot(cross, direction);
	if (!(facing > 0.0)) {
		return std::numeric_limits<double>::quiet_NaN();
	}
	const glm::dvec3 offset = from - corners[0];
	const double u = glm::dot(glm::cross(second, direction), offset) / facing;
	const double v = glm::dot(glm::cross(direction, first), offset) / facing;
	if (u < -border || v < -border || u + v > 1.0 + border) {
		return std::numeric_limits<double>::quiet_NaN();
	}
	return -glm::dot(cross, offset) / facing;
}

SurfacePosition first_on_line(const Surface &surface, const glm::dvec3 &from, const glm::dvec3 &to) {
	SurfacePosition result{glm::dvec3(std::numeric_limits<double>::quiet_NaN()), {}};
	const double length = glm::distance(from, to);
	if (!(length > 0.0) || !std::isfinite(length) || is_empty(surface.bounds())) {
		return result;
	}
	const glm::dvec3 back = (from - to) / length; // The line meets only triangles whose fronts face this way.
	const Part inside = part_inside(surface.bounds(), from, to);
	double nearest = length;
	std::vector<std::uint32_t> triangles;
	for (int piece = 0; piece < pieces && inside.begin <= inside.end; ++piece) {
		const double step = (inside.end - inside.begin) / pieces;
		const glm::dvec3 begin = from + (to - from) * (inside.begin + step * piece);
		const glm::dvec3 end = from + (to - from) * (inside.begin + step * (piece + 1));
		surface.find({glm::min(begin, end), glm::max(begin, end)}, triangles);
		for (const std::uint32_t index : triangles) {
			const double distance = -distance_along(surface.triangle(index), from, back);
			if (distance >= 0.0 && distance < nearest) {
				nearest = distance;
				result = {from - distance * back, glm::normalize(surface.cross(index))};
			}
		}
		if (nearest <= length * (inside.begin + step * (piece + 1))) {
			break;
		}
	}
	return result;
}

} // namespace thicket
