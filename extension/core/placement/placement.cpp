#include "core/placement/placement.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/trigonometry.hpp"
#include "core/rules/instance_random.hpp"

#include <glm/vec3.hpp>

#include <cmath>

namespace thicket {

namespace {

double mix(double min, double max, double t) { return min + (max - min) * t; }

/// Returns the instance's up axis: the normalized mean of the world's up axis and the normal,
/// weighted by `align`. If the normal points straight down and `align` is one half, the mean has no
/// direction. The result then points straight down.
glm::dvec3 up_axis(glm::vec3 normal, double align) {
	const glm::dvec3 up{align * normal.x, mix(1.0, normal.y, align), align * normal.z};
	const double squared = up.x * up.x + up.y * up.y + up.z * up.z;
	return squared < no_direction ? glm::dvec3(0.0, -1.0, 0.0) : up * (1.0 / std::sqrt(squared));
}

/// Returns the up axis on a planet: the normalized mean of `upright` and the normal, weighted by
/// `align`, or the normal if the mean has no direction.
glm::dvec3 up_axis(glm::vec3 normal, double align, const glm::dvec3 &upright) {
	const glm::dvec3 up{
			mix(upright.x, normal.x, align), mix(upright.y, normal.y, align), mix(upright.z, normal.z, align)};
	const double squared = up.x * up.x + up.y * up.y + up.z * up.z;
	return squared < no_direction ? glm::dvec3(normal) : up * (1.0 / std::sqrt(squared));
}

/// Applies the shortest rotation from the world's up axis to `up` to the vector (x, 0, z). `up`
/// must not point nearly straight down.
glm::dvec3 tilted_up(glm::dvec3 up, double x, double z) {
	const double toward = up.x * x + up.z * z;
	const double fraction = toward / (1.0 + up.y);
	return {x - up.x * fraction, -toward, z - up.z * fraction};
}

/// Applies a rotation from the world's up axis to `up` to the vector (x, 0, z). The rotation is the
/// shortest one unless the y component of `up` is below `overhang`. In that case, it is the
/// shortest rotation to the mirrored axis, followed by half a turn about x, because no rotation to
/// straight down is shorter than all others.
glm::dvec3 tilted(glm::dvec3 up, double x, double z) {
	if (up.y >= overhang) {
		return tilted_up(up, x, z);
	}
	const glm::dvec3 half = tilted_up({up.x, -up.y, -up.z}, x, z);
	return {half.x, -half.y, -half.z};
}

/// Applies the same rotation to an arbitrary vector.
glm::dvec3 tilted(glm::dvec3 up, glm::dvec3 v) { return tilted(up, v.x, v.z) + v.y * up; }

/// The three unit axes of an instance.
struct Axes {
	glm::dvec3 x;
	glm::dvec3 y;
	glm::dvec3 z;
};

/// Returns the axes after the yaw, followed by the rotation of tilted() from the world's up axis to
/// `up`.
Axes rotated_axes(const Rotation &yaw, glm::dvec3 up) {
	return {tilted(up, yaw.cosine, -yaw.sine), up, tilted(up, yaw.sine, yaw.cosine)};
}

/// Returns the up axis of a tilted instance. `tilt` and `direction` are random numbers from 0 to 1,
/// which select the angle and the direction.
glm::dvec3 leaning_axis(const Placement &placement, double tilt, double direction) {
	const Rotation lean = rotation_by(mix(placement.min_tilt_degrees, placement.max_tilt_degrees, tilt) / 360.0);
	const Rotation towards = rotation_by(direction);
	return {lean.sine * towards.cosine, lean.cosine, lean.sine * towards.sine};
}

/// Returns the scale for a number from 0 to 1.
double scale_at(const Placement &placement, double number) {
	const double fraction = placement.scale_curve == nullptr ? number : placement.scale_curve->at(number);
	return mix(placement.min_scale, placement.max_scale, fraction);
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
	const auto check_tilt = [](const char *property, double tilt) {
		return check_range(property, tilt, 0.0, 90.0);
	};
	const auto check_offset = [](const char *property, double offset) {
		return check_range(property, offset, -max_height_offset, max_height_offset);
	};
	return first_failure(check_yaw("min_yaw_degrees", placement.min_yaw_degrees),
			check_yaw("max_yaw_degrees", placement.max_yaw_degrees),
			check_order("max_yaw_degrees", placement.min_yaw_degrees, placement.max_yaw_degrees),
			check_scale("min_scale", placement.min_scale), check_scale("max_scale", placement.max_scale),
			check_order("max_scale", placement.min_scale, placement.max_scale),
			check_range("align_to_normal", placement.align_to_normal, 0.0, 1.0),
			check_offset("height_offset", placement.height_offset),
			check_tilt("min_tilt_degrees", placement.min_tilt_degrees),
			check_tilt("max_tilt_degrees", placement.max_tilt_degrees),
			check_order("max_tilt_degrees", placement.min_tilt_degrees, placement.max_tilt_degrees),
			check_offset("offset_along_normal", placement.offset_along_normal));
}

float write_basis(const Placement &placement, std::uint64_t seed, std::uint64_t id, glm::vec3 normal,
		std::span<float, transform_floats> r_transform, const UpField &up_field, std::optional<double> scale_number,
		const std::optional<Rotation> &heading) {
	const auto random = instance_random(seed, id, Draw::placement);
	const double yaw = mix(placement.min_yaw_degrees, placement.max_yaw_degrees, unit_interval(random[0]));
	const double scale = scale_at(placement, scale_number.value_or(unit_interval(random[1])));
	const Rotation yaw_rotation = rotation_by(yaw / 360.0);
	const Rotation rotation = heading ? combined(yaw_rotation, *heading) : yaw_rotation;
	const double align = placement.align_to_normal;
	const glm::vec3 position{r_transform[3], r_transform[7], r_transform[11]};
	const glm::dvec3 up = up_field.away ? up_axis(normal, align, up_field.at(position)) : up_axis(normal, align);
	Axes axes;
	if (placement.max_tilt_degrees > 0.0) {
		axes = rotated_axes(rotation, leaning_axis(placement, unit_interval(random[2]), unit_interval(random[3])));
		axes = {tilted(up, axes.x), tilted(up, axes.y), tilted(up, axes.z)};
	} else {
		// Without a tilt, one rotation suffices.
		axes = rotated_axes(rotation, up);
	}
	for (int row = 0; row < 3; ++row) {
		const auto at = static_cast<std::size_t>(row) * 4;
		r_transform[at] = static_cast<float>(scale * axes.x[row]);
		r_transform[at + 1] = static_cast<float>(scale * axes.y[row]);
		r_transform[at + 2] = static_cast<float>(scale * axes.z[row]);
	}
	return static_cast<float>(scale);
}

glm::vec3 moved_along(glm::vec3 normal, double offset, glm::vec3 position) {
	return position + glm::vec3(up_axis(normal, 1.0) * offset);
}

} // namespace thicket
