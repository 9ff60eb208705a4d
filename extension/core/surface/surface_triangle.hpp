#pragma once

#include "core/surface/surface_dart.hpp"

#include <glm/gtc/type_ptr.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

namespace thicket {

/// Returns a component by index. Unlike GLM's operator, this function does not branch.
inline double at(const glm::dvec3 &vector, int side) { return glm::value_ptr(vector)[side]; }

/// Returns the largest whole number that is not above `number`. In builds for processors without
/// SSE4.1, std::floor would be a function call.
inline double floor_of(double number) {
	constexpr double whole = 4503599627370496.0; // All numbers from 2^52 are whole.
	if (!(std::abs(number) < whole)) {
		return number;
	}
	const auto toward_zero = static_cast<double>(static_cast<std::int64_t>(number));
	return toward_zero > number ? toward_zero - 1.0 : toward_zero;
}

/// Return one of two numbers. Unlike std::min and std::max, which return references, these functions
/// compile to one instruction without a branch.
template <typename Number>
constexpr Number lesser(Number a, Number b) {
	return a < b ? a : b;
}
template <typename Number>
constexpr Number greater(Number a, Number b) {
	return a > b ? a : b;
}

/// A cube, in lattice units.
struct SurfaceCube {
	glm::dvec3 low{0.0};
	double width = 0.0;
};

/// Returns half the width of the part of a column through which lines pass, in units. They pass
/// only through the centers of the finest squares. The result includes one unit for rounding.
constexpr double half_of_lines(double column_width) {
	return (column_width - static_cast<double>(1 << (surface_bits - surface_depth))) / 2.0 + 1.0;
}

/// A range of positions along an axis, in units. Empty if `high` is below `low`.
struct SurfaceRange {
	double low = 0.0;
	double high = 0.0;
};

/// Returns true if all conditions are true, with a single branch. Use it if they are hard to predict.
template <std::size_t N>
inline bool all_of(const bool (&conditions)[N]) {
	int all = 1;
	for (const bool condition : conditions) {
		all &= static_cast<int>(condition);
	}
	return all != 0;
}

/// A triangle of a surface, in units of one level's lattice. The corners are sorted, and all
/// results depend only on differences of positions, which are exact. Results are therefore
/// identical for any origin, for any order of the given corners, and for both triangles at a common
/// edge.
struct SurfaceTriangle {
	std::array<glm::dvec3, 3> corners{}; ///< Whole units, sorted by x, then y, then z.
	glm::dvec3 normal{0.0};              ///< Cross product of the two edges at the first corner; not normalized.
	double length = 0.0;                 ///< Length of `normal`.
	glm::dvec3 low{0.0};                 ///< Lowest and highest coordinates of the corners.
	glm::dvec3 high{0.0};
	std::uint32_t index = 0; ///< Index of the triangle in the surface.
	SurfaceSearch search;    ///< The search of a cell that contains only this triangle.

	/// Prepares a triangle. Returns nothing if the corners are collinear.
	static std::optional<SurfaceTriangle> of(const std::array<glm::dvec3, 3> &corners, std::uint32_t index);

	/// Returns the absolute components of the unit normal.
	glm::dvec3 steepness() const;

	/// Returns the probability of keeping a hit in a cell with this search.
	double keep_probability(const SurfaceSearch &search) const;

	/// Returns, in the projection along an axis, on which side of its edges the triangle lies: one
	/// bit for each edge. The corners are either in clockwise or in counterclockwise order, and the
	/// third edge runs from the first corner to the third. The normal must not be perpendicular to
	/// the axis.
	std::uint32_t inside(int axis) const { return (at(normal, axis) > 0.0) == (axis != 1) ? 0b011u : 0b100u; }

	/// Returns true if the triangle intersects a half-open cube. The result is exact up to
	/// rounding. The function uses the separating axis test (Akenine-Moeller, "Fast 3D triangle-box
	/// overlap testing", 2001).
	bool enters(const SurfaceCube &cube) const;

	/// Returns false if, in the projection along an axis, the triangle does not intersect the
	/// square with its lower corner at (u, v). The result may be true although it does not.
	bool is_over(int axis, double u, double v, double width) const {
		const auto [side_u, side_v] = axes_across(axis);
		return all_of({at(low, side_u) < u + width, at(high, side_u) >= u, at(low, side_v) < v + width,
				at(high, side_v) >= v, at(normal, axis) != 0.0});
	}

	/// Returns false if a position is outside the triangle's bounds on the axes u and v.
	bool bounds_contain(int side_u, int side_v, double u, double v) const {
		return all_of({u >= at(low, side_u), u <= at(high, side_u), v >= at(low, side_v), v <= at(high, side_v)});
	}

	/// Returns the position along the axis, in whole units, at which a line along the axis hits the
	/// triangle. The line must be over the triangle (see bounds_contain). If two triangles are on different sides of a common edge, a line through the edge
	/// hits exactly one of them.
	std::optional<double> hit(int axis, double u, double v) const;

	/// Returns the position along the axis, in whole units, at which the line meets the triangle's
	/// plane. The plane must not be parallel to the axis.
	double plane_at(int axis, double u, double v) const;
};

/// Returns the search for a cell in which the absolute components of all unit normals are at least
/// `least_steepness`.
SurfaceSearch search_for(const glm::dvec3 &least_steepness);

/// The projection of a triangle along an axis. The triangle must outlive this object.
class SurfaceOutline {
public:
	SurfaceOutline(const SurfaceTriangle &triangle, int axis);

	/// Returns false only if the square with its center at (u, v) and a side of 2 * `half` is
	/// entirely outside one of the edges.
	bool meets(double u, double v, double half) const {
		return lesser(lesser(nearness(edges_[0], u, v, half), nearness(edges_[1], u, v, half)),
					   nearness(edges_[2], u, v, half)) >= 0.0;
	}

	/// The half-plane on the triangle's side of an edge: all positions (u, v), relative to an origin,
	/// with u * toward_u + v * toward_v + distance >= 0.
	struct Side {
		double toward_u;
		double toward_v;
		double distance;
	};
	Side side(std::size_t edge, double origin_u, double origin_v) const {
		const Edge &from = edges_[edge];
		return {from.u, from.v, from.distance(origin_u, origin_v)};
	}

	/// A square that moves in steps along u and v, in the projection along the axis.
	class Columns {
	public:
		/// Returns false only if the square is entirely outside one of the edges.
		bool meets() const { return lesser(lesser(edges_[0].now, edges_[1].now), edges_[2].now) >= 0.0; }

		/// Returns the position along the axis of the triangle's plane at the square's center, in
		/// units.
		double height() const { return height_.now; }

		void move_u() {
			height_.now += height_.per_u;
			for (Linear &edge : edges_) {
				edge.now += edge.per_u;
			}
		}
		void move_v() {
			height_.now += height_.per_v;
			for (Linear &edge : edges_) {
				edge.now += edge.per_v;
			}
		}

	private:
		friend class SurfaceOutline;
		struct Linear {
			double now;
			double per_u;
			double per_v;
		};
		std::array<Linear, 3> edges_;
		Linear height_;
	};

	/// Returns the square with its center at (u, v) and a side of 2 * `half`. It moves in steps of
	/// `step`.
	Columns columns(double u, double v, double step, double half) const;

	/// Returns the largest difference in height of the plane between the center and the corners of
	/// a square, in whole units.
	double reach(double half) const;

	/// Returns the range on the axis, in whole units, at which lines through a column meet the
	/// triangle's plane. The column's lower corner is at (u, v). The range is empty if no line hits
	/// the triangle, except close to its edges. It must be exact. Otherwise, a column whose lines
	/// meet the plane only beyond its cell would be split to the finest depth, because no dart in
	/// it is ever accepted.
	SurfaceRange range_in(double u, double v, double width) const;

private:
	/// A point on the edge, and a normal vector that points inside and is as long as the edge.
	struct Edge {
		double at_u = 0.0;
		double at_v = 0.0;
		double u = 0.0;
		double v = 0.0;
		double size = 0.0; ///< Sum of the absolute components of the vector.

		double distance(double to_u, double to_v) const { return u * (to_u - at_u) + v * (to_v - at_v); }
	};
	static double nearness(const Edge &edge, double u, double v, double half) {
		return edge.distance(u, v) + half * edge.size;
	}

	const SurfaceTriangle *triangle_;
	int axis_;
	std::array<Edge, 3> edges_;
	SurfaceRange bounds_;
	double corner_u_;
	double corner_v_;
	double corner_height_;
	double slope_u_;
	double slope_v_;
};

} // namespace thicket
