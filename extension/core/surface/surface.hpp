#pragma once

#include "core/base/bvh.hpp"
#include "core/base/status.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// A box in world meters. Windows are half-open, bounds are closed.
struct Box3 {
	glm::dvec3 min{0.0};
	glm::dvec3 max{0.0};
};

/// Triangles in world meters, in any arrangement: closed or open, with any number of sheets above each other. Immutable, so any number of
/// threads may read it.
class Surface {
public:
	/// `indices` are three for each triangle. Refuses positions that are not finite, indices without a vertex, and a number of indices that
	/// is not a multiple of three; then `r_surface` is unchanged. O(n log n).
	static Status create(std::vector<glm::dvec3> vertices, std::vector<std::uint32_t> indices,
			std::shared_ptr<const Surface> &r_surface);

	std::size_t triangle_count() const { return indices_.size() / 3; }
	std::array<glm::dvec3, 3> triangle(std::uint32_t index) const;
	Box3 triangle_bounds(std::uint32_t index) const;

	/// The cross product of two edges: on the side from which the corners run counterclockwise, and as long as twice the area.
	glm::dvec3 cross(std::uint32_t index) const;
	double triangle_area(std::uint32_t index) const; ///< Square meters.
	double area() const { return area_; }            ///< Square meters.
	const Box3 &bounds() const { return bounds_; }

	/// Replaces `r_triangles` with the triangles whose bounds touch a box, in increasing order.
	void find(const Box3 &box, std::vector<std::uint32_t> &r_triangles) const;

private:
	Surface() = default;
	void sort();

	std::vector<glm::dvec3> vertices_;
	std::vector<std::uint32_t> indices_;
	std::vector<std::uint32_t> order_; ///< The tree's items: triangles.
	Bvh tree_;
	std::vector<Box3> node_bounds_;
	Box3 bounds_;
	double area_ = 0.0;
};

} // namespace thicket
