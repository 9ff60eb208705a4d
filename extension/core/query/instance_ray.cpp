#include "core/query/instance_ray.hpp"

#include "core/query/tile_window.hpp"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

constexpr RayPart nothing{1.0, 0.0};

/// Returns the part of the ray inside the infinite cylinder around the y axis.
RayPart inside_tube(RayPart part, const Ray &ray, double radius) {
	const glm::dvec2 from(ray.from.x, ray.from.z);
	const glm::dvec2 along(ray.along.x, ray.along.z);
	const double squared = along.x * along.x + along.y * along.y;
	if (!(squared > 0.0)) {
		return from.x * from.x + from.y * from.y <= radius * radius ? part : nothing;
	}
	// The computation starts from the position nearest to the axis, because the usual quadratic
	// formula suffers from cancellation if the ray starts far away.
	const double nearest = -(from.x * along.x + from.y * along.y) / squared;
	const glm::dvec2 off = from + nearest * along;
	const double inside = radius * radius - (off.x * off.x + off.y * off.y);
	if (inside < 0.0) {
		return nothing;
	}
	const double half = std::sqrt(inside / squared);
	return {std::max(part.start, nearest - half), std::min(part.end, nearest + half)};
}

} // namespace

RayPart clipped(RayPart part, double from, double along, double low, double high) {
	if (along == 0.0) {
		return low <= from && from <= high ? part : nothing;
	}
	double enters = (low - from) / along;
	double leaves = (high - from) / along;
	if (enters > leaves) {
		std::swap(enters, leaves);
	}
	return {std::max(part.start, enters), std::min(part.end, leaves)};
}

double rounding_of(const Ray &ray) {
	double farthest = 0.0;
	for (int axis = 0; axis < 3; ++axis) {
		farthest = std::max({farthest, std::abs(ray.from[axis]), std::abs(ray.along[axis])});
	}
	return 16.0 * double_rounding * farthest;
}

double cylinder_reach(const InstanceShape &shape, double scale) {
	return std::sqrt(shape.radius * shape.radius + shape.height * shape.height) * scale * (1.0 + float_rounding);
}

ReachTest::ReachTest(const Ray &ray, double reach) : ray_(ray) {
	const double squared = squared_length(ray.along);
	per_squared_length_ = squared > 0.0 ? 1.0 / squared : 0.0;
	reach_ = reach + rounding_of(ray);
}

bool ReachTest::position(glm::dvec3 position) const {
	const glm::dvec3 off = position - ray_.from;
	const double fraction = std::clamp(glm::dot(off, ray_.along) * per_squared_length_, 0.0, 1.0);
	return squared_length(off - fraction * ray_.along) <= reach_ * reach_;
}

bool ReachTest::box(glm::dvec3 min, glm::dvec3 max) const {
	RayPart part;
	for (int axis = 0; axis < 3; ++axis) {
		part = clipped(part, ray_.from[axis], ray_.along[axis], min[axis] - reach_, max[axis] + reach_);
	}
	return !part.empty();
}

RayPart inside_cylinder(const Ray &ray, const InstanceShape &shape, glm::dvec3 position, const glm::mat3 &basis) {
	const glm::dmat3 to_world(basis);
	const double volume = std::abs(glm::determinant(to_world));
	if (!(volume > 0.0) || !std::isfinite(volume)) {
		return nothing;
	}
	const glm::dmat3 inverse = glm::inverse(to_world);
	const Ray own{inverse * (ray.from - position), inverse * ray.along};
	RayPart part = clipped({}, own.from.y, own.along.y, 0.0, shape.height);
	if (!part.empty()) {
		part = inside_tube(part, own, shape.radius);
	}
	return part;
}

} // namespace thicket
