#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace thicket {

/// The directions that the square of an octahedral map represents.
enum class OctahedralSpan : bool {
	hemisphere, ///< Directions that do not point down.
	sphere,     ///< All directions.
};

/// The unit direction for a position in the square [-1, 1] x [-1, 1]. Up is y, in the middle of the square. For a
/// position outside the square, returns an arbitrary direction. Octahedral and hemi-octahedral map of Cigolle et al.,
/// *A Survey of Efficient Representations for Independent Unit Vectors*, 2014, section 3, with y up.
glm::vec3 octahedral_direction(glm::vec2 place, OctahedralSpan span);

/// The axes of a frame: unit vectors, at right angles to each other.
struct PictureAxes {
	glm::vec3 right;
	glm::vec3 up;
	glm::vec3 toward; ///< To the viewer.
};

/// The axes for a unit direction towards the viewer. `up` leans towards y. If the viewer is exactly above or below,
/// `right` is the x axis.
PictureAxes picture_axes(glm::vec3 toward);

} // namespace thicket
