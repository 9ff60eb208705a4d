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
	polygon,  ///< Within `outline`, even-odd, from end to end of the world's vertical.
	path,     ///< Within half_size.x of the polyline `outline`, its ends round, likewise.
};

/// A part of space in which a layer is included, or from which it is excluded. World meters.
struct Shape {
	ShapeKind kind = ShapeKind::box;
	bool exclude = false;
	/// Box, sphere, cylinder: what counts is the shape's shadow when the light falls straight down, from end to end of the
	/// world's vertical, and depth is the distance to the shadow's border: a flat box reaches as deep as it is wide.
	bool ignore_height = false;
	double falloff = 0.0; ///< Meters within the border over which the shape gains its full effect; 0 is a sharp border.
	glm::dvec3 center{0.0};    ///< Box, sphere, cylinder.
	glm::dmat3 axes{1.0};      ///< Box, cylinder: its orthonormal axes as columns; mirrored ones are the same shape.
	glm::dvec3 half_size{0.0}; ///< Above 0 where the kind uses it.
	/// x and z; polygon: 3 or more corners, closed by itself; path: 2 or more points, open. Points may repeat and lines may
	/// cross or lie on each other: what is crossed an even number of times on the way out is outside a polygon.
	std::vector<glm::dvec2> outline;

	friend bool operator==(const Shape &, const Shape &) = default;
};

inline constexpr std::size_t max_outline_points = 1 << 16;
inline constexpr double max_shape_coordinate = 1e9; ///< Meters, any coordinate, either sign; sizes and falloff too.

/// Refuses what is not finite, outside the ranges above, or not orthonormal to 1e-6. Looks only at what the kind uses. Names
/// half_size as "half_size" (box), "radius", "half_height" or "half_width" (path).
Status validate(const Shape &shape);

/// The world rectangle outside which a valid shape changes nothing: it holds the border and a hair (a part in 10^12 of the
/// coordinates) more, for what rounding may do.
Rect bounds(const Shape &shape);

} // namespace thicket
