#pragma once

#include "core/base/status.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace thicket {

/// The orientation and scale of a box, sphere or cylinder.
struct ShapeFrame {
	glm::dmat3 axes{1.0};  ///< Orthonormal, as columns. May be mirrored.
	glm::dvec3 scale{1.0}; ///< Scale factor along each axis, above 0.
};

/// A basis is accepted as a rotation with scale if the cosine of the angle between any two axes is
/// at most this number in magnitude.
inline constexpr double max_shape_shear = 1e-3;

/// Decomposes a basis, whose columns are the transformed axes, into rotation and scale. The
/// resulting axes are orthonormal to double precision, although a scene stores them as floats.
/// Values that are not finite, an axis of length 0, and a shear above max_shape_shear are errors;
/// `r_frame` is then unchanged.
Status decompose(const glm::dmat3 &basis, ShapeFrame &r_frame);

} // namespace thicket
