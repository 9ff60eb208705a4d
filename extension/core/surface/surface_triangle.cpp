#include "core/surface/surface_triangle.hpp"

#include "core/base/floating_point.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

bool comes_before(const glm::dvec3 &a, const glm::dvec3 &b) {
	if (a.x != b.x) {
		return a.x < b.x;
	}
	return a.y != b.y ? a.y < b.y : a.z < b.z;
}

glm::dvec3 cross(const glm::dvec3 &a, const glm::dvec3 &b) {
	return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Whether the projections of the triangle, relative to the cube's center, and of the cube on an axis are apart. The axis is the cross
/// product of the edge from `from` with a side of the cube.
bool apart(double of_edge, double of_other, double radius) {
	return std::min(of_edge, of_other) > radius || std::max(of_edge, of_other) < -radius;
}

/// The three axes of one edge. `on` is one of its ends, `off` is the third corner.
bool edge_is_apart(const glm::dvec3 &edge, const glm::dvec3 &on, const glm::dvec3 &off, double half) {
	const glm::dvec3 size(std::abs(edge.x), std::abs(edge.y), std::abs(edge.z));
	return apart(edge.y * on.z - edge.z * on.y, edge.y * off.z - edge.z * off.y, half * (size.y + size.z)) ||
			apart(edge.z * on.x - edge.x * on.z, edge.z * off.x - edge.x * off.z, half * (size.z + size.x)) ||
			apart(edge.x * on.y - edge.y * on.x, edge.x * off.y - edge.y * off.x, half * (size.x + size.y));
}

} // namespace

std::optional<SurfaceTriangle> SurfaceTriangle::of(const std::array<glm::dvec3, 3> &corners, std::uint32_t index) {
	SurfaceTriangle result;
	result.corners = corners;
	if (comes_before(result.corners[1], result.corners[0])) {
		std::swap(result.corners[0], result.corners[1]);
	}
	if (comes_before(result.corners[2], result.corners[1])) {
		std::swap(result.corners[1], result.corners[2]);
	}
	if (comes_before(result.corners[1], result.corners[0])) {
		std::swap(result.corners[0], result.corners[1]);
	}
	const auto &[a, b, c] = result.corners;
	result.normal = cross(b - a, c - a);
	result.length = std::sqrt(
			result.normal.x * result.normal.x + result.normal.y * result.normal.y + result.normal.z * result.normal.z);
	result.low = glm::min(a, glm::min(b, c));
	result.high = glm::max(a, glm::max(b, c));
	result.index = index;
	return result.length > 0.0 ? std::optional(result) : std::nullopt;
}

double SurfaceTriangle::keep_probability(const SurfaceSearch &search) const {
	const double along = search.axis == SurfaceSearch::all_axes
			? std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z)
			: std::abs(normal[search.axis]);
	return static_cast<double>(search.kept) * length / along;
}

bool SurfaceTriangle::enters(const SurfaceCube &cube) const {
	// Surfaces on the upper faces belong to the next cubes. Positions are whole units, so half a unit excludes them.
	const double half = (cube.width - 0.5) / 2.0;
	const glm::dvec3 center = cube.low + half;
	for (int side = 0; side < 3; ++side) {
		if (low[side] > center[side] + half || high[side] < center[side] - half) {
			return false;
		}
	}
	const glm::dvec3 a = corners[0] - center;
	const double distance = normal.x * a.x + normal.y * a.y + normal.z * a.z;
	if (std::abs(distance) > half * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z))) {
		return false;
	}
	const glm::dvec3 b = corners[1] - center;
	const glm::dvec3 c = corners[2] - center;
	return !edge_is_apart(corners[1] - corners[0], a, c, half) && !edge_is_apart(corners[2] - corners[1], b, a, half) &&
			!edge_is_apart(corners[2] - corners[0], a, b, half);
}

std::optional<double> SurfaceTriangle::hit(int axis, double u, double v) const {
	const std::array<int, 2> across = axes_across(axis);
	const int side_u = across[0];
	const int side_v = across[1];
	const auto &[a, b, c] = corners;
	// On which side of an edge, from its first corner to its second. The edge itself belongs to one side.
	const auto side = [&](const glm::dvec3 &from, const glm::dvec3 &to, double at_u, double at_v) {
		return (to[side_u] - from[side_u]) * (at_v - from[side_v]) >=
				(to[side_v] - from[side_v]) * (at_u - from[side_u]);
	};
	if (normal[axis] == 0.0 || side(a, b, u, v) != side(a, b, c[side_u], c[side_v]) ||
			side(b, c, u, v) != side(b, c, a[side_u], a[side_v]) ||
			side(a, c, u, v) != side(a, c, b[side_u], b[side_v])) {
		return std::nullopt;
	}
	const double rise = -(normal[side_u] * (u - a[side_u]) + normal[side_v] * (v - a[side_v])) / normal[axis];
	return std::clamp(a[axis] + std::floor(rise), low[axis], high[axis]);
}

} // namespace thicket
