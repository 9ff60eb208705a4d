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

/// The instances of one mesh in one tile, sorted by (thinning rank, id). Every prefix of the list
/// keeps the distance of the level in which it ends. It is also the set that a lower density would produce.
struct MeshInstances {
	/// `stride` floats per instance: the transform in meters relative to the tile's origin, then
	/// the data that InstanceData adds.
	UnfilledVector<float> buffer;
	std::vector<std::uint64_t> ids;   ///< Packed InstanceIds of the instances.
	std::vector<std::uint32_t> ranks; ///< Thinning ranks of the instances, ascending.

	// Inputs from which the floats were computed. Empty for instances that were not generated.
	UnfilledVector<glm::vec3> normals; ///< Normals of the ground at the instances.
	std::vector<SourceFractions>
			fractions; ///< Color and variation inputs. Also empty if the layer has no known source.

	/// Bounds of the positions relative to the tile's origin, without the extent of the mesh. Both
	/// are 0 if there are no instances.
	glm::vec3 min{0.0f};
	glm::vec3 max{0.0f};
	/// The largest scale of the instances. To include the mesh, expand the bounds by the mesh's
	/// reach times this scale.
	float max_scale = 0.0f;

	std::size_t stride = transform_floats; ///< floats_per_instance for the layer's instance data.

	std::size_t size() const { return ids.size(); }

	/// Resizes the lists to `count` instances of `floats` floats each, without normals and
	/// fractions. Memory is reused.
	void resize(std::size_t count, std::size_t floats = transform_floats);

	/// Allocates memory for `count` generated instances.
	void reserve(std::size_t count, const InstanceData &data);

	/// Resizes the lists to `count` generated instances. New elements of the buffer are not
	/// initialized.
	void resize(std::size_t count, const InstanceData &data);

	/// Returns the floats of one instance.
	std::span<float> floats_of(std::size_t i) { return std::span(buffer).subspan(i * stride, stride); }
};

/// The number of points that remained after each step of generating a tile.
struct TileCounts {
	std::size_t sampled = 0;
	std::size_t dense = 0;  ///< Number of points that the rules for positions alone keep.
	std::size_t placed = 0; ///< Number of points that all rules keep.
};

/// All instances in one tile of one layer.
struct TileInstances {
	/// The center of the tile in world meters; y is the height of the ground, rounded to whole
	/// meters. It depends only on the rectangle and the terrain, so changing a rule does not affect
	/// the bits of the remaining instances.
	glm::dvec3 origin{0.0};
	std::vector<MeshInstances> meshes; ///< One entry for each mesh of the layer, including empty ones.
	TileCounts counts;
};

/// Returns the number of instances of a mesh that are visible at a density of 0 to 1, for
/// MultiMesh.visible_instance_count. `ranks` are ascending. A density above 1 shows all instances;
/// a density below 0 or NAN shows none. Takes O(log n) time.
std::size_t visible_prefix(std::span<const std::uint32_t> ranks, double density);

/// Returns the FNV-1a hash of 32-bit words instead of bytes: starting from 0xcbf29ce484222325, for
/// each float's bits, hash = (hash xor bits) * 0x100000001b3, modulo 2^64. The hash is simple
/// enough to reimplement in a script.
std::uint64_t digest(std::span<const float> buffer);

/// Returns a digest of a tile's origin, ids, ranks and buffers. Equal tiles have equal digests on
/// every machine.
std::uint64_t digest(const TileInstances &tile);

} // namespace thicket
