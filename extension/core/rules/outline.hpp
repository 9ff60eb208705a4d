#pragma once

#include "core/base/bvh.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A line through many points, prepared for position queries: a tree of boxes over runs of consecutive edges, two runs per box. Building
/// takes O(n) memory and time. A query visits about log n boxes if consecutive points are close to each other, as on a drawn line, and
/// all edges if they jump randomly. Meters.
class Outline {
public:
	/// A line through `points`: at least one, all finite. `closed` adds the edge from the last to the first.
	void set(std::span<const glm::dvec2> points, bool closed);

	/// Whether a position lies strictly inside a closed outline by the even-odd rule. Edges and corners are outside.
	bool contains(glm::dvec2 position) const;

	/// The distance in meters from `position` to the nearest edge, or `limit` if that is less.
	double distance(glm::dvec2 position, double limit) const;

private:
	struct Box {
		glm::dvec2 min;
		glm::dvec2 max;
	};

	static Box around(const Box &a, const Box &b);

	std::size_t edges() const { return points_.size() - 1; }

	std::vector<glm::dvec2> points_; ///< If closed, the first point repeats at the end.
	Bvh edge_tree_;                  ///< Over the edges.
	std::vector<Box> boxes_;         ///< Indexed by the slots of the tree.
};

} // namespace thicket
