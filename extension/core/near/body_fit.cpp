#include "core/near/body_fit.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace thicket {

namespace {

constexpr double min_body_scale = 1e-4;
constexpr double max_body_scale = 1e4;

/// A shear that leaves less than this of an axis makes the instance flat.
constexpr double flat = 1e-4;

/// Point `i` of `count` on a Fibonacci spiral around the unit sphere.
glm::dvec3 direction(std::size_t i, std::size_t count) {
	const double y = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(count);
	const double ring = std::sqrt(1.0 - y * y);
	const double angle = 2.0 * std::numbers::pi / std::numbers::phi * static_cast<double>(i);
	return {ring * std::cos(angle), y, ring * std::sin(angle)};
}

} // namespace

glm::vec3 BodyFit::scale() const {
	glm::vec3 result;
	for (int axis = 0; axis < 3; ++axis) {
		result[axis] = static_cast<float>(std::pow(body_scale_step, scale_steps[axis]));
	}
	result.z = mirrored ? -result.z : result.z;
	return result;
}

bool fit_body(const glm::mat3 &basis, BodyFit &r_fit) {
	const glm::dmat3 axes(basis);
	for (int axis = 0; axis < 3; ++axis) {
		const double scale = glm::length(axes[axis]);
		if (!(scale >= min_body_scale && scale <= max_body_scale)) {
			return false;
		}
		r_fit.scale_steps[axis] = static_cast<int>(std::lround(std::log(scale) / std::log(body_scale_step)));
	}
	const glm::dvec3 up = glm::normalize(axes[1]);
	const glm::dvec3 across = glm::normalize(axes[0]);
	const glm::dvec3 side = across - up * glm::dot(up, across);
	if (glm::length(side) < flat) {
		return false;
	}
	const glm::dvec3 x = glm::normalize(side);
	const glm::dvec3 z = glm::cross(x, up);
	const double depth = glm::dot(z, glm::normalize(axes[2]));
	if (std::abs(depth) < flat) {
		return false;
	}
	r_fit.mirrored = depth < 0.0;
	r_fit.rotation = glm::mat3(x, up, z);
	return true;
}

void keep_outermost(std::vector<glm::vec3> &points, std::size_t most) {
	if (points.size() <= most) {
		return;
	}
	std::vector<std::size_t> kept;
	for (std::size_t i = 0; i < most; ++i) {
		const glm::vec3 towards(direction(i, most));
		const auto farther = [&towards](const glm::vec3 &a, const glm::vec3 &b) {
			return glm::dot(a, towards) < glm::dot(b, towards);
		};
		kept.push_back(
				static_cast<std::size_t>(std::max_element(points.begin(), points.end(), farther) - points.begin()));
	}
	std::sort(kept.begin(), kept.end());
	kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
	std::vector<glm::vec3> result;
	for (const std::size_t index : kept) {
		result.push_back(points[index]);
	}
	points = std::move(result);
}

} // namespace thicket
