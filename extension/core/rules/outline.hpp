#pragma once

#include "core/base/bvh.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A polyline prepared for position queries, with a binary bounding volume hierarchy over its
/// consecutive edges. Building it takes O(n) time and memory. A query visits about log n nodes if
/// consecutive points are close together, as on a drawn line, and all edges in the worst case. All
/// lengths are in meters.
class Outline {
public:
	/// Sets the polyline. `points` must not be empty, and all must be finite. If `closed` is true,
	/// an edge from the last point to the first is added.
	void set(std::span<const glm::dvec2> points, bool closed);

	/// Returns true if `position` is inside the closed outline by the even-odd rule. Edges and
	/// corners are outside.
	bool contains(glm::dvec2 position) const;

	/// Returns the distance in meters from `position` to the nearest edge, or `limit` if that is
	/// less.
	double distance(glm::dvec2 position, double limit) const;

private:
	struct Box {
		glm::dvec2 min;
		glm::dvec2 max;
	};

	static Box around(const Box &a, const Box &b);

	std::size_t edges() const { return points_.size() - 1; }

	std::vector<glm::dvec2> points_; ///< If closed, the first point repeats at the end.
	Bvh edge_tree_;                  ///< Hierarchy over the edges.
	std::vector<Box> boxes_;         ///< Bounding boxes, by node index.
};

} // namespace thicket
