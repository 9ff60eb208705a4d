#pragma once

#include "core/placement/compact_tile.hpp"

#include <glm/vec3.hpp>

#include <span>

namespace thicket {

/// The instances of a mesh in one tile, with the tile's origin.
struct TileMesh {
	const CompactMesh *mesh = nullptr; ///< Never null.
	glm::dvec3 origin{0.0};
};

/// Merges the instances of a mesh from several tiles of a layer into one mesh, sorted by rank, then
/// id. Positions become relative to `origin`, which rounds them to floats a second time. Throws
/// std::bad_alloc.
CompactMesh merged(std::span<const TileMesh> meshes, const glm::dvec3 &origin);

} // namespace thicket
