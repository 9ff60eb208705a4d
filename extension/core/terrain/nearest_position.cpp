#include "core/terrain/nearest_position.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace thicket {

namespace {

glm::dvec3 nearest_on_edge(const glm::dvec3 &from, const glm::dvec3 &to, const glm::dvec3 &position) {
	const glm::dvec3 along = to - from;
	const double squared = glm::dot(along, along);
	return squared > 0.0 ? from + along * glm::clamp(glm::dot(position - from, along) / squared, 0.0, 1.0) : from;
}

/// Returns the foot of the perpendicular if it is inside all edges, otherwise the nearest position
/// on an edge.
glm::dvec3 nearest_on_triangle(
		const std::array<glm::dvec3, 3> &corners, const glm::dvec3 &cross, const glm::dvec3 &position) {
	const glm::dvec3 foot = position - cross * (glm::dot(position - corners[0], cross) / glm::dot(cross, cross));
	glm::dvec3 nearest = foot;
	double min_distance = std::numeric_limits<double>::infinity();
	bool is_inside = true;
	for (std::size_t edge = 0; edge < corners.size(); ++edge) {
		const glm::dvec3 &from = corners[edge];
		const glm::dvec3 &to = corners[(edge + 1) % corners.size()];
		is_inside = is_inside && glm::dot(glm::cross(to - from, foot - from), cross) >= 0.0;
		const glm::dvec3 on_edge = nearest_on_edge(from, to, position);
		if (const double away = glm::distance(on_edge, position); away < min_distance) {
			min_distance = away;
			nearest = on_edge;
		}
	}
	return is_inside ? foot : nearest;
}

} // namespace

SurfacePosition nearest_position(const Surface &surface, const glm::dvec3 &position, double distance) {
	std::vector<std::uint32_t> triangles;
	surface.find({position - distance, position + distance}, triangles);
	SurfacePosition result{glm::dvec3(std::numeric_limits<double>::quiet_NaN()), {}};
	double min_distance = distance;
	for (const std::uint32_t index : triangles) {
		const glm::dvec3 cross = surface.cross(index);
		if (!(glm::dot(cross, cross) > 0.0)) {
			continue; // The triangle's corners are collinear.
		}
		const glm::dvec3 nearest = nearest_on_triangle(surface.triangle(index), cross, position);
		if (const double away = glm::distance(nearest, position); away <= min_distance) {
			min_distance = away;
			result = {nearest, glm::normalize(cross)};
		}
	}
	return result;
}

} // namespace thicket
