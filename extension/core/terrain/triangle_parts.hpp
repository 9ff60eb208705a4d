#pragma once

#include "core/base/bvh.hpp"
#include "core/base/rect.hpp"
#include "core/terrain/terrain.hpp"
#include "core/terrain/triangle_terrain.hpp"

#include <glm/vec2.hpp>

#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The tops of many meshes, each a TriangleTerrain of its own, so that one of them can be replaced without building the others anew.
/// Immutable after `set`.
class TriangleParts final : public Terrain {
public:
	using Part = std::shared_ptr<const TriangleTerrain>;

	/// None of the parts may be null. Builds a tree of boxes over them: O(n log n) time in the number of parts, whatever they hold.
	/// A failure changes nothing.
	Status set(std::span<const Part> parts);

	/// As TriangleTerrain::sample for all triangles together. Of parts that are equally high, to the last bit of a double, the most
	/// level one gives the normal, and of equally level ones that which leans farthest towards x, then z: the order of the parts
	/// does not matter.
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

private:
	/// Around the parts of a node, seen from above, and how high they reach.
	struct Box {
		Rect area;
		double top;
	};

	Ground ground_at(glm::dvec2 position) const;

	std::vector<Part> parts_; ///< In the order of the tree; none is empty.
	Bvh tree_;
	std::vector<Box> boxes_; ///< By the tree's slots.
};

} // namespace thicket
