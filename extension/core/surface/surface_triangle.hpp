#pragma once

#include "core/surface/surface_dart.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <optional>

namespace thicket {

/// A cube in units.
struct SurfaceCube {
	glm::dvec3 low{0.0};
	double width = 0.0;
};

/// A triangle of a surface in units of one level's lattice. The corners are sorted, and all results depend only on
/// differences of positions, which are exact. So results are the same wherever the origin is, in whichever order the
/// corners were given, and on both sides of an edge that two triangles share.
struct SurfaceTriangle {
	std::array<glm::dvec3, 3> corners{}; ///< Whole units, sorted by x, then y, then z.
	glm::dvec3 normal{0.0};              ///< Not of unit length: the cross product of the first corner's two edges.
	double length = 0.0;                 ///< Of `normal`.
	glm::dvec3 low{0.0};                 ///< Bounds.
	glm::dvec3 high{0.0};
	std::uint32_t index = 0; ///< In the caller's list.

	/// Nothing if the corners lie on one line.
	static std::optional<SurfaceTriangle> of(const std::array<glm::dvec3, 3> &corners, std::uint32_t index);

	/// The probability with which a hit of a line is kept.
	double keep_probability(const SurfaceSearch &search) const;

	/// Whether it enters a half-open cube. Exact but for rounding, by separating axes (Akenine-Moeller, "Fast 3D triangle-box overlap
	/// testing", 2001).
	bool enters(const SurfaceCube &cube) const;

	/// The whole units along the axis at which a line along it meets the triangle. A line that meets the common edge of two triangles on
	/// both sides of it meets one of them.
	std::optional<double> hit(int axis, double u, double v) const;
};

} // namespace thicket
