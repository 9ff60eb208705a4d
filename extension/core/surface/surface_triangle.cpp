#include "core/surface/surface_triangle.hpp"

#include "core/base/floating_point.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

/// The edges, as pairs of corner indices in ascending order.
constexpr std::array<std::array<std::size_t, 2>, 3> edges{{{0, 1}, {1, 2}, {0, 2}}};

bool comes_before(const glm::dvec3 &a, const glm::dvec3 &b) {
	if (a.x != b.x) {
		return a.x < b.x;
	}
	return a.y != b.y ? a.y < b.y : a.z < b.z;
}

glm::dvec3 cross(const glm::dvec3 &a, const glm::dvec3 &b) {
	return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Returns true if the projections of the triangle and the cube onto an axis are disjoint.
/// `of_edge` and `of_other` are the projections of an edge and of the third corner, relative to the
/// cube's center; `radius` is half the projection of the cube.
bool apart(double of_edge, double of_other, double radius) {
	return std::min(of_edge, of_other) > radius || std::max(of_edge, of_other) < -radius;
}

/// Tests the three axes that are cross products of an edge with the sides of the cube. `on` is an
/// end of the edge, `off` the third corner.
bool edge_is_apart(const glm::dvec3 &edge, const glm::dvec3 &on, const glm::dvec3 &off, double half) {
	const glm::dvec3 size(std::abs(edge.x), std::abs(edge.y), std::abs(edge.z));
	return apart(edge.y * on.z - edge.z * on.y, edge.y * off.z - edge.z * off.y, half * (size.y + size.z)) ||
			apart(edge.z * on.x - edge.x * on.z, edge.z * off.x - edge.x * off.z, half * (size.z + size.x)) ||
			apart(edge.x * on.y - edge.y * on.x, edge.x * off.y - edge.y * off.x, half * (size.x + size.y));
}

/// Returns the side of a line on which a position is, in the projection along an axis. The line
/// itself belongs to the `true` side.
bool side(const glm::dvec3 &from, const glm::dvec3 &to, int side_u, int side_v, double u, double v) {
	return (at(to, side_u) - at(from, side_u)) * (v - at(from, side_v)) >=
			(at(to, side_v) - at(from, side_v)) * (u - at(from, side_u));
}

} // namespace

SurfaceSearch search_for(const glm::dvec3 &least_steepness) {
	// A single plane always reaches the last value, because one component of its normal is at least
	// 1 / sqrt(3). The y axis is tried first, because most ground is not steep.
	for (const float kept : {0.95f, 0.85f, 0.7f, 0.55f, 0.4f}) {
		for (const std::uint8_t axis : {std::uint8_t{1}, std::uint8_t{0}, std::uint8_t{2}}) {
			if (at(least_steepness, axis) >= static_cast<double>(kept)) {
				return {axis, kept};
			}
		}
	}
	return {};
}

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
	if (!(result.length > 0.0)) {
		return std::nullopt;
	}
	// The corners are sorted by x.
	result.low = {a.x, lesser(a.y, lesser(b.y, c.y)), lesser(a.z, lesser(b.z, c.z))};
	result.high = {c.x, greater(a.y, greater(b.y, c.y)), greater(a.z, greater(b.z, c.z))};
	result.index = index;
	result.search = search_for(result.steepness());
	return result;
}

glm::dvec3 SurfaceTriangle::steepness() const { return glm::abs(normal) / length; }

double SurfaceTriangle::keep_probability(const SurfaceSearch &wanted) const {
	const double along = wanted.axis == SurfaceSearch::all_axes
			? std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z)
			: std::abs(at(normal, wanted.axis));
	return static_cast<double>(wanted.kept) * length / along;
}

double SurfaceTriangle::plane_at(int axis, double u, double v) const {
	const auto [side_u, side_v] = axes_across(axis);
	const glm::dvec3 &corner = corners[0];
	const double rise =
			-(at(normal, side_u) * (u - at(corner, side_u)) + at(normal, side_v) * (v - at(corner, side_v))) /
			at(normal, axis);
	return at(corner, axis) + floor_of(rise);
}

bool SurfaceTriangle::enters(const SurfaceCube &cube) const {
	// A surface on an upper face belongs to the next cube. Positions are whole units, so half a
	// unit less excludes it.
	const double half = (cube.width - 0.5) / 2.0;
	const glm::dvec3 center = cube.low + half;
	for (int axis = 0; axis < 3; ++axis) {
		if (at(low, axis) > at(center, axis) + half || at(high, axis) < at(center, axis) - half) {
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
	const auto [side_u, side_v] = axes_across(axis);
	if (at(normal, axis) == 0.0) {
		return std::nullopt;
	}
	std::uint32_t sides = 0;
	for (std::size_t edge = 0; edge < edges.size(); ++edge) {
		sides |=
				static_cast<std::uint32_t>(side(corners[edges[edge][0]], corners[edges[edge][1]], side_u, side_v, u, v))
				<< edge;
	}
	if (sides != inside(axis)) {
		return std::nullopt;
	}
	return lesser(greater(plane_at(axis, u, v), at(low, axis)), at(high, axis));
}

SurfaceOutline::SurfaceOutline(const SurfaceTriangle &triangle, int axis) : triangle_(&triangle), axis_(axis) {
	const auto [side_u, side_v] = axes_across(axis);
	const std::uint32_t inside = triangle.inside(axis);
	for (std::size_t edge = 0; edge < edges.size(); ++edge) {
		const glm::dvec3 &from = triangle.corners[edges[edge][0]];
		const glm::dvec3 &to = triangle.corners[edges[edge][1]];
		// The triangle is either on the left or on the right side of the edge.
		const double sign = 2.0 * static_cast<double>(static_cast<std::int32_t>(inside >> edge & 1)) - 1.0;
		Edge &made = edges_[edge];
		made.at_u = at(from, side_u);
		made.at_v = at(from, side_v);
		made.u = sign * (at(from, side_v) - at(to, side_v));
		made.v = sign * (at(to, side_u) - at(from, side_u));
		made.size = std::abs(made.u) + std::abs(made.v);
	}
	bounds_ = {at(triangle.low, axis), at(triangle.high, axis)};
	corner_u_ = at(triangle.corners[0], side_u);
	corner_v_ = at(triangle.corners[0], side_v);
	corner_height_ = at(triangle.corners[0], axis);
	slope_u_ = at(triangle.normal, side_u) / at(triangle.normal, axis);
	slope_v_ = at(triangle.normal, side_v) / at(triangle.normal, axis);
}

SurfaceOutline::Columns SurfaceOutline::columns(double u, double v, double step, double half) const {
	Columns result{};
	for (std::size_t number = 0; number < edges_.size(); ++number) {
		const Edge &edge = edges_[number];
		result.edges_[number] = {edge.distance(u, v) + half * edge.size, edge.u * step, edge.v * step};
	}
	result.height_ = {corner_height_ - (slope_u_ * (u - corner_u_) + slope_v_ * (v - corner_v_)), -slope_u_ * step,
			-slope_v_ * step};
	return result;
}

double SurfaceOutline::reach(double half) const {
	return std::ceil((std::abs(slope_u_) + std::abs(slope_v_)) * half) + 1.0;
}

SurfaceRange SurfaceOutline::range_in(double u, double v, double width) const {
	const double half = half_of_lines(width);
	const double middle_u = u + width / 2.0;
	const double middle_v = v + width / 2.0;
	if (!meets(middle_u, middle_v, half)) {
		return {1.0, 0.0};
	}
	// It suffices to check the lines at two opposite corners: all roundings are monotonic, so no
	// other line meets the plane below the first or above the second.
	const double edge = static_cast<double>(1 << (surface_bits - surface_depth)) / 2.0;
	const std::array<double, 2> at_u{u + edge, u + width - edge};
	const std::array<double, 2> at_v{v + edge, v + width - edge};
	const std::size_t lower_u = slope_u_ > 0.0 ? 1 : 0;
	const std::size_t lower_v = slope_v_ > 0.0 ? 1 : 0;
	return {greater(triangle_->plane_at(axis_, at_u[lower_u], at_v[lower_v]), bounds_.low),
			lesser(triangle_->plane_at(axis_, at_u[1 - lower_u], at_v[1 - lower_v]), bounds_.high)};
}

} // namespace thicket
