#pragma once

#include "core/base/bvh.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A line through many points, ready for questions about positions: a tree of boxes over runs of consecutive edges, two runs a
/// box. O(n) memory and time to build; a question looks at about log n boxes where points follow each other as they do on a
/// drawn line, and at all edges where they jump at random. Meters.
class Outline {
public:
	/// Through `points`, at least one, finite; `closed` adds the edge from the last to the first.
	void set(std::span<const glm::dvec2> points, bool closed);

	/// True strictly within a closed outline by the even-odd rule; edges and corners are not within.
	bool contains(glm::dvec2 position) const;

	/// Meters from `position` to the nearest edge, or `limit` if that is less.
	double distance(glm::dvec2 position, double limit) const;

private:
	struct Box {
		glm::dvec2 min;
		glm::dvec2 max;
	};

	static Box around(const Box &a, const Box &b);

	std::size_t edges() const { return points_.size() - 1; }

	std::vector<glm::dvec2> points_; ///< Of a closed one, the first once more at the end.
	Bvh edge_tree_;                  ///< Over the edges.
	std::vector<Box> boxes_;         ///< By its slots.
};

} // namespace thicket
