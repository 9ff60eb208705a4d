#pragma once

#include "core/base/unfilled.hpp"
#include "core/placement/instance_data.hpp"
#include "core/placement/placement.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The instances of one mesh in one tile, sorted by (thinning rank, id). Every prefix is a well-spaced thinning of the whole, as if all
/// densities were lower.
struct MeshInstances {
	/// The floats of all instances, `stride` each: the transform relative to the tile's origin, in meters, then the
	/// data that InstanceData adds.
	UnfilledVector<float> buffer;
	std::vector<std::uint64_t> ids;   ///< Packed InstanceIds.
	std::vector<std::uint32_t> ranks; ///< The thinning_rank of each, ascending.

	// Further inputs of the floats. Empty for instances that were not generated from a layer's settings.
	UnfilledVector<glm::vec3> normals;  ///< Normals of the ground.
	std::vector<InstanceShares> shares; ///< Also empty if no source is known.

	glm::vec3 min{0.0f};    ///< Smallest and largest position relative to the tile's origin, without the size of
	glm::vec3 max{0.0f};    ///< the mesh; both 0 if there are no instances.
	float max_scale = 0.0f; ///< The largest scale: expand the box by this times the reach of the mesh.

	std::size_t stride = transform_floats; ///< floats_per_instance of the layer's instance data.

	std::size_t size() const { return ids.size(); }

	/// Resizes to `count` instances of `floats` each, without normals and shares. Reuses the memory it has.
	void resize(std::size_t count, std::size_t floats = transform_floats);

	/// Allocates the memory for `count` instances that a layer's settings generate.
	void reserve(std::size_t count, const InstanceData &data);

	/// Resizes to that many, as above. New elements must be written.
	void resize(std::size_t count, const InstanceData &data);

	/// The floats of one instance.
	std::span<float> floats_of(std::size_t i) { return std::span(buffer).subspan(i * stride, stride); }
};

/// How many points were left after each step.
struct TileCounts {
	std::size_t sampled = 0;
	std::size_t dense = 0;  ///< Kept by the density rules.
	std::size_t placed = 0; ///< Kept by all rules.
};

/// All instances in one tile of one layer.
struct TileInstances {
	/// The center of the tile in world meters; y is a whole number of meters near the tile's ground. Depends only on
	/// the rectangle and the terrain, so that a rule changes no bit of the instances that it keeps.
	glm::dvec3 origin{0.0};
	std::vector<MeshInstances> meshes; ///< One for each mesh of the layer, empty ones included.
	TileCounts counts;
};

/// How many instances of a mesh are visible at a density of 0 to 1, for `visible_instance_count`. `ranks` ascends. A density above 1 shows
/// all, and one below 0 or NAN shows none. O(log n).
std::size_t visible_prefix(std::span<const std::uint32_t> ranks, double density);

/// FNV-1a over 32-bit words instead of bytes: starting from 0xcbf29ce484222325, for each float's bits, hash = (hash xor
/// bits) * 0x100000001b3, modulo 2^64. Simple enough for a script to repeat.
std::uint64_t digest(std::span<const float> buffer);

/// A digest of every bit of a tile: origin, ids, ranks and buffers, in order. Equal tiles have equal digests on every machine.
std::uint64_t digest(const TileInstances &tile);

} // namespace thicket
