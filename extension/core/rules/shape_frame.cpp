#include "core/rules/shape_frame.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace thicket {

Status decompose(const glm::dmat3 &basis, ShapeFrame &r_frame) {
	ShapeFrame frame{basis, glm::dvec3(0.0)};
	for (int axis = 0; axis < 3; ++axis) {
		const double length = std::sqrt(glm::dot(basis[axis], basis[axis]));
		if (!std::isfinite(length)) {
			return {ErrorCode::not_finite, "scale", length};
		}
		if (length <= 0.0) {
			return {ErrorCode::not_positive, "scale", length, {}, {}, "Do not scale any axis to 0"};
		}
		frame.scale[axis] = length;
		frame.axes[axis] /= length;
	}
	glm::dmat3 &axes = frame.axes;
	const double shear = std::max({std::abs(glm::dot(axes[0], axes[1])), std::abs(glm::dot(axes[0], axes[2])),
			std::abs(glm::dot(axes[1], axes[2]))});
	if (!(shear <= max_shape_shear)) {
		return Status::out_of_range(
				"shear", shear, at_most(max_shape_shear), "Scale a rotated parent by the same factor on all axes");
	}
	// Orthonormalizes the axes (Gram-Schmidt), starting with the up axis, so that an upright shape
	// stays upright.
	axes[0] = glm::normalize(axes[0] - glm::dot(axes[0], axes[1]) * axes[1]);
	const glm::dvec3 across = glm::cross(axes[0], axes[1]);
	axes[2] = glm::dot(across, axes[2]) < 0.0 ? -across : across;
	r_frame = frame;
	return {};
}

} // namespace thicket
