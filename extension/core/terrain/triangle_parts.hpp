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

/// The topmost surface of many meshes. Each mesh has its own TriangleTerrain, so that one mesh can
/// be replaced without rebuilding the trees of all meshes. Immutable after `set`.
class TriangleParts final : public Terrain {
public:
	using Part = std::shared_ptr<const TriangleTerrain>;

	/// Builds a bounding volume hierarchy over the parts, in O(n log n) time for n parts,
	/// regardless of their sizes. No part may be null. A failed call leaves the object unchanged.
	Status set(std::span<const Part> parts);

	/// Writes the ground like TriangleTerrain::sample(), for the triangles of all parts. If several
	/// parts have exactly the same height, the normal with the largest y is chosen, then the
	/// largest x, then the largest z. The result does not depend on the order of the parts.
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// Returns all triangles of all parts.
	const Surface *surface() const override { return surface_.get(); }

private:
	/// Bounds of a node's parts: their horizontal area, and their highest point.
	struct Box {
		Rect area;
		double top;
	};

	Ground ground_at(glm::dvec2 position) const;

	std::vector<Part> parts_; ///< In tree order, without empty parts.
	Bvh tree_;
	std::vector<Box> boxes_; ///< Bounds of the nodes, by Bvh::index_of().
	std::shared_ptr<const Surface> surface_;
};

} // namespace thicket
