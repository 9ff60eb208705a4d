#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace thicket {

/// The directions that an octahedral map represents.
enum class OctahedralSpan : bool {
	hemisphere, ///< The upper hemisphere.
	sphere,     ///< All directions.
};

/// Returns the unit direction for a position in the square [-1, 1] x [-1, 1]. The center of the
/// square is up (y). For a position outside the square, the result is an arbitrary direction. The
/// function uses the octahedral and hemi-octahedral maps of Cigolle et al., *A Survey of Efficient
/// Representations for Independent Unit Vectors*, 2014, section 3, with y up.
glm::vec3 octahedral_direction(glm::vec2 position, OctahedralSpan span);

/// The axes of a frame: orthogonal unit vectors.
struct ViewAxes {
	glm::vec3 right;
	glm::vec3 up;
	glm::vec3 to_viewer; ///< Points to the viewer.
};

/// Returns the axes for a unit direction toward the viewer. `up` is as close to y as possible. If
/// the viewer is exactly above or below, `right` is the x axis.
ViewAxes view_axes(glm::vec3 to_viewer);

} // namespace thicket
