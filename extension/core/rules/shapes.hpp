#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

enum class ShapeKind : std::uint8_t {
	box,      ///< half_size along the axes.
	sphere,   ///< half_size.x is the radius.
	cylinder, ///< half_size.x is the radius, half_size.y half the height.
	polygon,  ///< Within `outline`, even-odd, from end to end of the world's vertical.
	path,     ///< Within half_size.x of the polyline `outline`, likewise.
};

/// A part of space in which a layer is included, or from which it is excluded. World metres.
struct Shape {
	ShapeKind kind = ShapeKind::box;
	bool exclude = false;
	bool ignore_height =
			false; ///< Box, sphere, cylinder: reaches from end to end of the world's vertical, see ShapeSet::chance.
	double falloff = 0.0; ///< Metres within the border over which the shape gains its full effect; 0 is a sharp border.
	glm::dvec3 center{0.0};          ///< Box, sphere, cylinder.
	glm::dmat3 axes{1.0};            ///< Its orthonormal axes as columns.
	glm::dvec3 half_size{0.0};       ///< Above 0 where the kind uses it.
	std::vector<glm::dvec2> outline; ///< x and z; polygon: 3 or more corners, closed by itself; path: 2 or more, open.

	friend bool operator==(const Shape &, const Shape &) = default;
};

inline constexpr std::size_t max_outline_points = 1 << 16;
inline constexpr double max_shape_coordinate = 1e9; ///< Metres, any coordinate, either sign; sizes and falloff too.

/// Refuses what is not finite, outside the ranges above, or not orthonormal to 1e-6.
Status validate(const Shape &shape);

/// The world rectangle outside which a shape changes nothing, borders included.
Rect bounds(const Shape &shape);

/// The shapes that count for one layer. Immutable after `set`, so threads may share one.
///
/// A shape's influence is 0 outside and on its border, grows linearly over `falloff` metres of depth, and is 1 beyond that
/// depth. The layer's density is multiplied by the largest influence of all including shapes (1 if there are none) and by
/// 1 minus the largest influence of all excluding ones.
class ShapeSet {
public:
	/// Takes valid shapes; refuses all if one is refused, and then stays as it was.
	Status set(std::vector<Shape> shapes);

	bool empty() const { return shapes_.empty(); }
	std::span<const Shape> shapes() const { return shapes_; }

	/// The shapes that may have an effect in `area`, in order, as indices. Appends nothing twice; replaces `r_near`. An
	/// including shape elsewhere still counts: `chance` is 0 where the layer has including shapes and none is near.
	void near(const Rect &area, std::vector<std::uint32_t> &r_near) const;

	/// The factor 0 to 1 at a place on the ground (world metres, y up), among the shapes that `near` gave for an area that
	/// holds it. With ignore_height, a shape acts on the place's projection along y: box and cylinder by the section of their
	/// volume's shadow on the plane y = 0, the sphere as a circle. The same bits everywhere: no libm but square roots.
	double chance(std::span<const std::uint32_t> near, glm::dvec3 position) const;

	friend bool operator==(const ShapeSet &a, const ShapeSet &b) { return a.shapes_ == b.shapes_; }

private:
	std::vector<Shape> shapes_;
	std::vector<Rect> bounds_;
	bool includes_ = false; ///< One of them at least.
};

} // namespace thicket
