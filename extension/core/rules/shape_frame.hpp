#pragma once

#include "core/base/status.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace thicket {

/// The orientation and scale of a box, sphere or cylinder.
struct ShapeFrame {
	glm::dmat3 axes{1.0};  ///< Orthonormal, as columns. May be mirrored.
	glm::dvec3 scale{1.0}; ///< Along each axis, above 0.
};

/// The largest cosine of the angle between two axes for which a basis still counts as a rotation with scales.
inline constexpr double max_shape_shear = 1e-3;

/// Decomposes a basis, whose columns are the transformed axes. The axes are made orthonormal to double precision, to correct the
/// precision that they lost as floats in a scene. Refuses values that are not finite, an axis of no length, and two axes that deviate
/// from a right angle by more than max_shape_shear. `r_frame` is then unchanged.
Status take_apart(const glm::dmat3 &basis, ShapeFrame &r_frame);

} // namespace thicket
