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

/// The tops of many meshes, each in its own TriangleTerrain, so that one can be replaced without rebuilding the others. Immutable after
/// `set`.
class TriangleParts final : public Terrain {
public:
	using Part = std::shared_ptr<const TriangleTerrain>;

	/// No part may be null. Builds a tree of boxes over the parts: O(n log n) time in the number of parts, whatever their size. A failure
	/// changes nothing.
	Status set(std::span<const Part> parts);

	/// Like TriangleTerrain::sample for all triangles together. If parts have exactly the same height in double precision, the most level
	/// one determines the normal; of equally level ones, the one that leans farthest towards x, then z. The order of the parts does not
	/// matter.
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

private:
	/// Bounds of a node's parts: their area seen from above, and their highest point.
	struct Box {
		Rect area;
		double top;
	};

	Ground ground_at(glm::dvec2 position) const;

	std::vector<Part> parts_; ///< In tree order; none is empty.
	Bvh tree_;
	std::vector<Box> boxes_; ///< Indexed by the tree's slots.
};

} // namespace thicket
