#pragma once

#include "core/placement/compact_tile.hpp"

#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The instances of one mesh in a tile, in the format of MultiMesh.buffer.
struct MeshUpload {
	godot::PackedFloat32Array buffer;
	godot::AABB aabb; ///< The bounds of all instances, relative to the tile's origin.
};

/// Returns the bounds of meshes whose origins lie in the box from `min` to `max`. Extends the box
/// by `margin` meters on all sides to include the meshes.
godot::AABB box_around(glm::vec3 min, glm::vec3 max, float margin);

/// Keeps uploaded buffers for reuse, because allocating and clearing new ones is slower. Only one
/// thread at a time may use it.
class BufferPool {
public:
	BufferPool() { buffers_.reserve(max_buffers); }

	/// Keeps buffers up to the limits below and frees the others. Allocates no memory.
	void keep(std::vector<MeshUpload> &&uploads);

	/// Returns a buffer of this size with unspecified content. Throws std::bad_alloc.
	godot::PackedFloat32Array take(std::size_t floats);

	/// Returns the number of buffers that `take` has reused. Any thread may call this method.
	std::uint64_t reused_count() const { return reused_count_.load(std::memory_order_relaxed); }

private:
	static constexpr std::size_t max_buffers = 16;
	/// The maximum total size of the kept buffers, equal to 1 MiB.
	static constexpr std::int64_t max_floats = std::int64_t{1} << 18;

	std::vector<godot::PackedFloat32Array> buffers_;
	std::atomic<std::uint64_t> reused_count_ = 0;
};

/// Converts instances for upload. `mesh_radius` is the distance in meters from the mesh's origin to its
/// farthest vertex, at scale 1.
MeshUpload to_upload(const MeshInstances &mesh, float mesh_radius, BufferPool &r_pool);
MeshUpload to_upload(const CompactMesh &mesh, float mesh_radius);

} // namespace thicket
