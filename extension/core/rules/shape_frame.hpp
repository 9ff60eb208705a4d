#pragma once

#include "core/base/status.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace thicket {

/// How a box, sphere or cylinder stands in the world.
struct ShapeFrame {
	glm::dmat3 axes{1.0};  ///< Orthonormal, as columns; may be a mirror image.
	glm::dvec3 scale{1.0}; ///< Along each axis, above 0.
};

/// The cosine of the angle between two axes up to which a basis still counts as a rotation with scales.
inline constexpr double max_shape_shear = 1e-3;

/// Takes a basis (columns: where the axes go) apart. The axes are made orthonormal to double precision, whatever they
/// lost as floats on the way through a scene. Refused: what is not finite, an axis of no length, two axes that are
/// farther from a right angle than max_shape_shear; then `r_frame` stays as it was.
Status take_apart(const glm::dmat3 &basis, ShapeFrame &r_frame);

} // namespace thicket
