#pragma once

#include "core/surface/surface_triangle.hpp"

#include <glm/vec3.hpp>

#include <cstdint>

namespace thicket {

/// A cell's surface as a height over one of the cell's faces, roughly: a plane, and how far the surface can be from it. Tells which of 4 x 4
/// columns need no more darts. Everything is rounded so that no column counts as covered before it is. In cell widths, from the cell's
/// lower corner.
class SurfacePatch {
public:
	static constexpr int shift =
			surface_bits - 2; ///< Columns are 2^shift units wide. Their bits are numbered by u, then v.

	explicit SurfacePatch(int axis) : axis_(axis) {}

	/// Makes room for a triangle, in units. `low` is the cell's lower corner.
	void add(const SurfaceTriangle &triangle, const glm::dvec3 &low);

	/// The columns that the surface may enter.
	std::uint32_t entered() const;

	/// The columns that the surface may enter and that the ball of one radius around a point does not cover.
	std::uint32_t open_beside(const glm::vec3 &point) const;

	/// The plane, as the vectors of open_beside need it.
	struct Plane {
		float height = 0.0f; ///< At u = v = 0.
		float slope_u = 0.0f;
		float slope_v = 0.0f;
		float reach = -1e3f; ///< How far the surface can be from the plane's height in the middle of a column.
	};

private:
	int axis_;
	bool is_empty_ = true;
	Plane plane_;
};

} // namespace thicket
