#pragma once

#include "core/surface/surface_dart.hpp"

#include <glm/gtc/type_ptr.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <optional>

namespace thicket {

/// A component by its number. glm's own operator branches.
inline double at(const glm::dvec3 &vector, int side) { return glm::value_ptr(vector)[side]; }

/// A cube in units.
struct SurfaceCube {
	glm::dvec3 low{0.0};
	double width = 0.0;
};

/// Half the width of the part of a column that lines run through: through the middle of the finest squares. A unit more, for rounding.
constexpr double half_of_lines(double column_width) {
	return (column_width - static_cast<double>(1 << (surface_bits - surface_depth))) / 2.0 + 1.0;
}

/// A range of positions along an axis, in units. Empty if `high` is below `low`.
struct SurfaceRange {
	double low = 0.0;
	double high = 0.0;
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
	SurfaceSearch search;    ///< Of a cell that contains nothing else.
	std::array<std::uint8_t, 3>
			inside{}; ///< For each axis, a bit for each edge: on which of its sides the triangle is.

	/// Nothing if the corners lie on one line.
	static std::optional<SurfaceTriangle> of(const std::array<glm::dvec3, 3> &corners, std::uint32_t index);

	/// The components of the unit normal, without signs.
	glm::dvec3 steepness() const;

	/// The probability with which a hit of a line is kept.
	double keep_probability(const SurfaceSearch &search) const;

	/// Whether it enters a half-open cube. Exact but for rounding, by separating axes (Akenine-Moeller, "Fast 3D triangle-box overlap
	/// testing", 2001).
	bool enters(const SurfaceCube &cube) const;

	/// False only if it is not seen, along an axis, in a square with a corner at (u, v).
	bool is_over(int axis, double u, double v, double width) const {
		const auto [side_u, side_v] = axes_across(axis);
		return at(low, side_u) < u + width && at(high, side_u) >= u && at(low, side_v) < v + width &&
				at(high, side_v) >= v && at(normal, axis) != 0.0;
	}

	/// The whole units along the axis at which a line along it meets the triangle. A line that meets the common edge of two triangles on
	/// both sides of it meets one of them.
	std::optional<double> hit(int axis, double u, double v) const;
};

/// How a cell is searched in which each component of all unit normals, without signs, is at least as large.
SurfaceSearch search_for(const glm::dvec3 &least_steepness);

/// A triangle that is seen along an axis.
class SurfaceOutline {
public:
	SurfaceOutline(const SurfaceTriangle &triangle, int axis);

	/// False only if a square with its center at (u, v) lies outside of one of the edges.
	bool meets(double u, double v, double half) const {
		return is_near(edges_[0], u, v, half) && is_near(edges_[1], u, v, half) && is_near(edges_[2], u, v, half);
	}

	/// The position on the axis of the triangle's plane over (u, v), in whole units.
	double height(double u, double v) const;

	/// How far the plane rises or falls from the middle of a square to its corners, in whole units.
	double reach(double half) const;

	/// At least the positions on the axis, in whole units, at which lines through a column with a corner at (u, v) meet the triangle.
	/// Empty if none does.
	SurfaceRange range_in(double u, double v, double width) const;

private:
	/// A point on the edge, and a vector that is normal to it, points inside and is as long as the edge.
	struct Edge {
		double at_u = 0.0;
		double at_v = 0.0;
		double u = 0.0;
		double v = 0.0;
		double size = 0.0; ///< The sum of its two components, without signs.

		double distance(double to_u, double to_v) const { return u * (to_u - at_u) + v * (to_v - at_v); }
	};
	static bool is_near(const Edge &edge, double u, double v, double half) {
		return edge.distance(u, v) + half * edge.size >= 0.0;
	}

	std::array<Edge, 3> edges_;
	SurfaceRange bounds_;
	double corner_u_;
	double corner_v_;
	double corner_height_;
	double slope_u_;
	double slope_v_;
};

} // namespace thicket
