#pragma once

#include "core/surface/surface_triangle.hpp"

#include <glm/vec3.hpp>

#include <cstdint>

namespace thicket {

/// Approximates a part of a cell's surface as a height field over one of the cell's faces: a plane,
/// and an upper bound for the surface's distance from the plane. The patch determines which of 8 x 8
/// columns may still need darts. A column that it reports as covered is always covered, but not the
/// other way round. Lengths are in cell widths, relative to the cell's lower corner.
class SurfacePatch {
public:
	/// Base-2 logarithm of a column's width in units. In results, columns have one bit each,
	/// numbered by u, then v.
	static constexpr int shift = surface_bits - surface_patch_depth;

	explicit SurfacePatch(int axis) : axis_(axis) {}

	int axis() const { return axis_; }

	/// Extends the approximation to include a triangle. Returns false, and changes nothing, if the
	/// triangle's plane differs from the patch's by more than `tolerance` in the cell. The triangle
	/// and `low`, the cell's lower corner, are in units.
	bool add(const SurfaceTriangle &triangle, const glm::dvec3 &low, float tolerance);

	/// Returns the columns in which lines along an axis may hit a triangle, one bit each.
	static std::uint64_t columns_over(const SurfaceTriangle &triangle, int axis, const glm::dvec3 &low);

	/// Returns the columns that the surface may enter, one bit each.
	std::uint64_t entered() const;

	/// Returns those of `columns` that the surface may enter and that the ball around `point` does
	/// not cover, one bit each.
	std::uint64_t open_beside(const glm::vec3 &point, std::uint64_t columns) const;

	/// The approximating plane.
	struct Plane {
		float height = 0.0f; ///< Height at u = v = 0.
		float slope_u = 0.0f;
		float slope_v = 0.0f;
		/// Largest distance, in a column, of the surface from the plane's height at the column's
		/// center.
		float reach = -1e3f;
		/// Largest distance of the surface from the plane, along the axis.
		float thickness = 0.0f;
	};

private:
	int axis_;
	bool is_empty_ = true;
	Plane plane_;
};

} // namespace thicket
