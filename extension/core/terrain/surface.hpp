#pragma once

#include "core/base/status.hpp"
#include "core/terrain/box3.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// A triangle mesh in world meters: closed or open, with any number of sheets above each other. A
/// surface is immutable, so threads may share it.
class Surface {
public:
	virtual ~Surface() = default;
	Surface(const Surface &) = delete;
	Surface &operator=(const Surface &) = delete;

	/// Creates a surface from `indices`, three for each triangle, in O(n log n) time. Positions
	/// that are not finite, indices out of range, and a number of indices that is not a multiple of
	/// three are errors; `r_surface` is then unchanged.
	static Status create(std::vector<glm::dvec3> vertices, std::vector<std::uint32_t> indices,
			std::shared_ptr<const Surface> &r_surface);

	/// Returns the triangles of several parts, in any order. No part may be null, and together they
	/// may have at most max_triangles triangles.
	using Part = std::shared_ptr<const Surface>;
	static std::shared_ptr<const Surface> of_parts(std::span<const Part> parts);

	/// Returns the number of triangle indices, including indices without a triangle.
	virtual std::size_t triangle_count() const = 0;

	/// Returns the corners. Seen from the front, they run counterclockwise. Indices without a
	/// triangle, as in the holes of a grid, return three equal corners.
	virtual std::array<glm::dvec3, 3> triangle(std::uint32_t index) const = 0;

	/// Returns the bounds of all triangles, or `no_box` if there are none.
	virtual const Box3 &bounds() const = 0;

	/// Replaces `r_triangles` with the indices of the triangles that touch `box`, in ascending
	/// order. May include triangles whose bounds touch `box` but which do not touch it themselves.
	virtual void find(const Box3 &box, std::vector<std::uint32_t> &r_triangles) const = 0;

	Box3 triangle_bounds(std::uint32_t index) const;

	/// Returns the cross product of two edges. It points to the front of the triangle, and its
	/// length is twice the area.
	glm::dvec3 cross(std::uint32_t index) const;
	double triangle_area(std::uint32_t index) const; ///< Returns the area in square meters.
	double area() const;                             ///< Returns the area in square meters. Takes O(n) time.

	static constexpr std::size_t max_triangles = std::numeric_limits<std::uint32_t>::max();

protected:
	Surface() = default;
};

} // namespace thicket
