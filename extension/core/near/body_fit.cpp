#include "core/near/body_fit.hpp"

#include "core/base/floating_point.hpp"
#include "core/base/trigonometry.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace thicket {

namespace {

constexpr double min_body_scale = 1e-4;
constexpr double max_body_scale = 1e4;

/// An instance is treated as flat if a shear leaves less than this fraction of an axis.
constexpr double flat = 1e-4;

/// body_scale_step ^ max_scale_step is just above max_body_scale.
constexpr int max_scale_step = 466;

/// The powers of body_scale_step with exponents from -max_scale_step to max_scale_step. They are
/// computed by multiplication, because the rounding of std::pow and std::log differs between
/// machines. Two players would otherwise collide with bodies of different sizes.
constexpr auto scale_powers = [] {
	std::array<double, 2 * max_scale_step + 1> powers{};
	double power = 1.0;
	for (std::size_t step = 0; step <= max_scale_step; ++step) {
		powers[max_scale_step + step] = power;
		powers[max_scale_step - step] = 1.0 / power;
		power *= body_scale_step;
	}
	return powers;
}();
static_assert(scale_powers.back() > max_body_scale && scale_powers[2 * max_scale_step - 1] < max_body_scale);
static_assert(scale_powers.front() < min_body_scale);

/// Returns the exponent of the power of body_scale_step that is nearest to a scale, by ratio.
int nearest_step(double scale) {
	// The boundary between two powers is their geometric mean.
	int low = 0;
	int high = 2 * max_scale_step;
	while (low < high) {
		const int middle = (low + high) / 2;
		const auto at = static_cast<std::size_t>(middle);
		if (scale_powers[at] * scale_powers[at + 1] <= scale * scale) {
			low = middle + 1;
		} else {
			high = middle;
		}
	}
	return low - max_scale_step;
}

/// Returns point `i` of `count` on a Fibonacci spiral around the unit sphere.
glm::dvec3 direction(std::size_t i, std::size_t count) {
	const double y = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(count);
	const double ring = std::sqrt(1.0 - y * y);
	const double turns = static_cast<double>(i) / std::numbers::phi;
	const Rotation rotation = rotation_by(turns - std::floor(turns));
	return {ring * rotation.cosine, y, ring * rotation.sine};
}

} // namespace

glm::vec3 BodyFit::scale() const {
	glm::vec3 result;
	for (int axis = 0; axis < 3; ++axis) {
		const int step = std::clamp(scale_steps[axis], -max_scale_step, max_scale_step);
		result[axis] = static_cast<float>(scale_powers[static_cast<std::size_t>(step + max_scale_step)]);
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
		r_fit.scale_steps[axis] = nearest_step(scale);
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

void keep_outermost(std::vector<glm::vec3> &points, std::size_t max_count) {
	if (points.size() <= max_count) {
		return;
	}
	std::vector<std::size_t> outermost;
	for (std::size_t i = 0; i < max_count; ++i) {
		const glm::vec3 towards(direction(i, max_count));
		const auto farther = [&towards](const glm::vec3 &a, const glm::vec3 &b) {
			return glm::dot(a, towards) < glm::dot(b, towards);
		};
		outermost.push_back(
				static_cast<std::size_t>(std::max_element(points.begin(), points.end(), farther) - points.begin()));
	}
	std::sort(outermost.begin(), outermost.end());
	outermost.erase(std::unique(outermost.begin(), outermost.end()), outermost.end());
	std::vector<glm::vec3> result;
	for (const std::size_t index : outermost) {
		result.push_back(points[index]);
	}
	points = std::move(result);
}

} // namespace thicket
