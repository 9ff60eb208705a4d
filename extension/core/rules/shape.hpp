#pragma once

#include "core/base/planet.hpp"
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
	box,      ///< half_size is half the extent along each axis.
	sphere,   ///< half_size.x is the radius.
	cylinder, ///< The axis is axes[1], half_size.x is the radius, and half_size.y is half the height.
	polygon,  ///< The interior of `outline` by the even-odd rule, at any height.
	/// All positions within half_size.x of the polyline `outline`, at any height. Its ends are
	/// round.
	path,
};

/// A region that includes or excludes a layer. Lengths are in world meters.
struct Shape {
	ShapeKind kind = ShapeKind::box;
	bool exclude = false;
	/// If true, a box, sphere or cylinder acts at any height, within its vertical projection onto
	/// the ground plane (its shadow). The depth inside the shape is then the distance to the
	/// shadow's border, so the height of a flat box does not limit it.
	bool ignore_height = false;
	/// Distance in meters inside the border over which the effect grows to its full strength. 0
	/// means a sharp border.
	double falloff = 0.0;
	/// Used by boxes, spheres and cylinders, and by all shapes with a planet.
	glm::dvec3 center{0.0};
	/// Axes of boxes and cylinders: orthonormal, as columns. Mirrored axes define the same shape.
	glm::dmat3 axes{1.0};
	glm::dvec3 half_size{0.0}; ///< Meters. The components that the kind uses are above 0.
	/// World x and z or, with a planet, map positions of a PlanetMap around `center`. Polygon: 3 or more
	/// corners, closed automatically. Path: 2 or more points, open. Points may repeat, and edges may
	/// cross or overlap.
	std::vector<glm::dvec2> outline;
	/// The planet that defines "at any height" for a polygon, a path, or a shape that ignores height;
	/// otherwise none. The shape then covers all positions above and below it, along the direction
	/// away from the planet's center, up to Planet::radii_around radii from the center.
	Planet planet{};

	friend bool operator==(const Shape &, const Shape &) = default;
};

inline constexpr std::size_t max_outline_points = 1 << 16;
/// Limit of coordinates (of either sign), sizes and falloff, in meters.
inline constexpr double max_shape_coordinate = 1e9;

/// Returns true if a shape acts at any height.
inline bool acts_at_any_height(const Shape &shape) {
	return shape.ignore_height || shape.kind == ShapeKind::polygon || shape.kind == ShapeKind::path;
}

/// Returns an error for values that are not finite or outside the ranges above, and for axes that
/// are not orthonormal to 1e-6. Only the fields that the kind uses are checked. The status names a
/// component of half_size as "half_size" (box), "radius", "half_height" or "half_width" (path). With a
/// planet, `center` must not be the planet's center, and an outline must be on the PlanetMap.
Status validate(const Shape &shape);

class PlanetMap;

/// Transforms a box, sphere or cylinder that ignores height to the space of PlanetMap::at_middle, and
/// removes its planet. `map` is the map around the shape's center.
Shape rotated_upright(const Shape &shape, const PlanetMap &map);

/// Returns the world rectangle outside which a valid shape has no effect. The rectangle includes
/// the border and a small margin for rounding (10^-12 of the coordinates).
Rect bounds(const Shape &shape);

} // namespace thicket
