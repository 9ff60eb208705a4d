#pragma once

#include "core/base/pixel_rect.hpp"
#include "core/base/trigonometry.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <vector>

namespace thicket {

/// Returns the position of a direction from a planet's center on an image that covers the whole
/// planet, as a texture covers the engine's SphereMesh: 0 to 1 along both axes. The direction need not
/// be normalized, but must be finite. Row 0 is at the pole toward world y. Columns go once around the
/// planet, from +z over +x, -z and -x.
inline glm::dvec2 sphere_image_position(const glm::dvec3 &from_center) {
	const double x = from_center.x;
	const double z = from_center.z;
	const double across = std::sqrt(x * x + z * z);
	// On the axis, and at the center, the direction around it is unknown.
	const double half_turn = across > 0.0 ? angle_degrees(std::abs(x), z) : 0.0;
	const double around = x < 0.0 ? 360.0 - half_turn : half_turn;
	const double from_pole = across > 0.0 || from_center.y < 0.0 ? angle_degrees(across, from_center.y) : 0.0;
	return {around / 360.0, from_pole / 180.0};
}

/// Appends rectangles, one pixel high, that contain the pixels of such an image whose centers are within a
/// straight distance of a direction, and the pixel of the direction itself. `middle` is a unit vector, and
/// `distance` is in units of the planet's radius. `size` is at least 1 on both axes. Throws
/// std::bad_alloc.
void find_sphere_disc(glm::ivec2 size, const glm::dvec3 &middle, double distance, std::vector<PixelRect> &r_rows);

} // namespace thicket
