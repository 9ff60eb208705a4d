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

/// The instances of one mesh in one tile, sorted by (thinning rank, id): every prefix is a well spaced thinning of the whole,
/// as if all densities were lower.
struct MeshInstances {
	/// `stride` floats an instance: the transform relative to the tile's origin, in meters, then what InstanceData adds.
	UnfilledVector<float> buffer;
	std::vector<std::uint64_t> ids;   ///< Packed InstanceIds.
	std::vector<std::uint32_t> ranks; ///< thinning_rank of each, ascending.

	// What else the floats follow from; none for instances that no layer's settings made.
	UnfilledVector<glm::vec3> normals;  ///< Of the ground.
	std::vector<InstanceShares> shares; ///< None either where no source is known.

	glm::vec3 min{0.0f};    ///< Smallest and largest position relative to the tile's origin, the size of the
	glm::vec3 max{0.0f};    ///< mesh not counted; both 0 for no instances.
	float max_scale = 0.0f; ///< The largest scale there is: grow the box by this times the mesh's reach.

	std::size_t stride = transform_floats; ///< floats_per_instance of the layer's instance data.

	std::size_t size() const { return ids.size(); }

	/// Makes room for `count` instances of `floats` each, without what they follow from. Keeps the memory it has.
	void resize(std::size_t count, std::size_t floats = transform_floats);

	/// Takes the memory for `count` instances that a layer's settings make.
	void reserve(std::size_t count, const InstanceData &data);

	/// Makes room for them, as above. What is new has to be written.
	void resize(std::size_t count, const InstanceData &data);

	/// The floats of one instance.
	std::span<float> floats_of(std::size_t i) { return std::span(buffer).subspan(i * stride, stride); }
};

/// How many points were left after each step.
struct TileCounts {
	std::size_t sampled = 0;
	std::size_t dense = 0;  ///< Passed the density.
	std::size_t placed = 0; ///< Passed all rules.
};

/// Everything that stands in one tile of one layer.
struct TileInstances {
	/// World meters: the center of the tile, and in y a whole number of meters near its ground. A function of the
	/// rectangle and the terrain alone, so that no rule changes a bit of what it leaves standing.
	glm::dvec3 origin{0.0};
	std::vector<MeshInstances> meshes; ///< One for each mesh of the layer, empty ones included.
	TileCounts counts;
};

/// How many instances of a mesh stand at a density of 0 to 1: a number for `visible_instance_count`. `ranks` ascends.
/// A density above 1 gives all, one below 0 or NAN none. O(log n).
std::size_t visible_prefix(std::span<const std::uint32_t> ranks, double density);

/// FNV-1a over 32-bit words instead of bytes: starting from 0xcbf29ce484222325, for each float's bits,
/// hash = (hash xor bits) * 0x100000001b3, modulo 2^64. Simple enough to be repeated in a script.
std::uint64_t digest(std::span<const float> buffer);

/// Every bit of a tile, origin, ids, ranks and buffers, in order: equal for equal tiles on every machine.
std::uint64_t digest(const TileInstances &tile);

} // namespace thicket
