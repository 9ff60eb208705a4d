#include "core/placement/placement.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/placement/rotation.hpp"
#include "core/rules/instance_random.hpp"

#include <glm/vec3.hpp>

#include <cmath>

namespace thicket {

namespace {

double mix(double min, double max, double t) { return min + (max - min) * t; }

/// The instance's up axis, of unit length: between straight up and the normal.
glm::dvec3 up_axis(glm::vec3 normal, double align) {
	const glm::dvec3 up{align * normal.x, mix(1.0, normal.y, align), align * normal.z};
	return up * (1.0 / std::sqrt(up.x * up.x + up.y * up.y + up.z * up.z));
}

/// What the shortest rotation from straight up to `up` makes of a vector (x, 0, z). `up` is not straight down.
glm::dvec3 tilted(glm::dvec3 up, double x, double z) {
	const double toward = up.x * x + up.z * z;
	const double share = toward / (1.0 + up.y);
	return {x - up.x * share, -toward, z - up.z * share};
}

} // namespace

Status validate(const Placement &placement) {
	const auto check_yaw = [](const char *property, double yaw) {
		return check_range(property, yaw, -360.0, 360.0);
	};
	const auto check_scale = [](const char *property, double scale) {
		const Status status = check_positive(property, scale);
		return status.ok() ? check_range(property, scale, min_placement_scale, max_placement_scale) : status;
	};
	return first_failure(check_yaw("min_yaw_degrees", placement.min_yaw_degrees),
			check_yaw("max_yaw_degrees", placement.max_yaw_degrees),
			check_order("max_yaw_degrees", placement.min_yaw_degrees, placement.max_yaw_degrees),
			check_scale("min_scale", placement.min_scale), check_scale("max_scale", placement.max_scale),
			check_order("max_scale", placement.min_scale, placement.max_scale),
			check_range("align_to_normal", placement.align_to_normal, 0.0, 1.0),
			check_range("height_offset", placement.height_offset, -max_height_offset, max_height_offset));
}

float write_transform(const Placement &placement, std::uint64_t seed, std::uint64_t id, glm::vec3 normal,
		glm::vec3 position, std::span<float, floats_per_instance> r_transform) {
	const auto random = instance_random(seed, id, Draw::placement);
	const double yaw = mix(placement.min_yaw_degrees, placement.max_yaw_degrees, unit_interval(random[0]));
	const double scale = mix(placement.min_scale, placement.max_scale, unit_interval(random[1]));
	const Rotation turn = rotation_by(yaw / 360.0);

	// Columns of the basis: the tilt applied to the axes after the yaw, which leaves y where it is.
	const glm::dvec3 y = up_axis(normal, placement.align_to_normal);
	const glm::dvec3 x = tilted(y, turn.cosine, -turn.sine);
	const glm::dvec3 z = tilted(y, turn.sine, turn.cosine);
	for (int row = 0; row < 3; ++row) {
		const auto at = static_cast<std::size_t>(row) * 4;
		r_transform[at] = static_cast<float>(scale * x[row]);
		r_transform[at + 1] = static_cast<float>(scale * y[row]);
		r_transform[at + 2] = static_cast<float>(scale * z[row]);
		r_transform[at + 3] = position[row];
	}
	return static_cast<float>(scale);
}

} // namespace thicket
