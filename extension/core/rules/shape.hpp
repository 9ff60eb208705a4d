#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

enum class ShapeKind : std::uint8_t {
	box,      ///< half_size along the axes.
	sphere,   ///< half_size.x is the radius.
	cylinder, ///< Around axes[1]: half_size.x is the radius, half_size.y half the height.
	polygon,  ///< Inside `outline` by the even-odd rule, at any height.
	path,     ///< Within half_size.x of the polyline `outline`, with round ends, at any height.
};

/// A region in which a layer is included, or from which it is excluded. World meters.
struct Shape {
	ShapeKind kind = ShapeKind::box;
	bool exclude = false;
	/// If true, a box, sphere or cylinder acts at any height, within its shadow under vertical light. Its depth is then
	/// the distance to the shadow's border, so a flat box is as deep as it is wide.
	bool ignore_height = false;
	double falloff = 0.0;      ///< Meters inside the border over which the effect grows to full. 0 is a sharp border.
	glm::dvec3 center{0.0};    ///< Box, sphere, cylinder.
	glm::dmat3 axes{1.0};      ///< Box, cylinder: orthonormal axes as columns. Mirrored axes define the same shape.
	glm::dvec3 half_size{0.0}; ///< Above 0 where the kind uses it.
	/// x and z. Polygon: 3 or more corners, closed automatically. Path: 2 or more points, open. Points may repeat, and lines may cross or
	/// overlap. A position is outside a polygon if the way out crosses the outline an even number of times.
	std::vector<glm::dvec2> outline;

	friend bool operator==(const Shape &, const Shape &) = default;
};

inline constexpr std::size_t max_outline_points = 1 << 16;
inline constexpr double max_shape_coordinate = 1e9; ///< Meters, either sign. Applies to coordinates, sizes and falloff.

/// Refuses values that are not finite or outside the ranges above, and axes that are not orthonormal to 1e-6. Checks
/// only the fields that the kind uses. A status names half_size as "half_size" (box), "radius", "half_height" or
/// "half_width" (path).
Status validate(const Shape &shape);

/// The world rectangle outside which a valid shape changes nothing. The rectangle includes the border and a small
/// margin for rounding (10^-12 of the coordinates).
Rect bounds(const Shape &shape);

} // namespace thicket
