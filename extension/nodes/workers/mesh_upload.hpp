#pragma once

#include "core/placement/compact_tile.hpp"

#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The instances of one mesh in a tile, in the renderer's format.
struct MeshUpload {
	godot::PackedFloat32Array buffer;
	godot::AABB aabb; ///< The box around the placed meshes, relative to the tile's origin.
};

/// The box around meshes whose origins lie in the box from `min` to `max`. No mesh extends more than `margin` meters
/// beyond that box.
godot::AABB box_around(glm::vec3 min, glm::vec3 max, float margin);

/// Keeps buffers that were already uploaded, for reuse. This saves time, because the engine clears new memory and the
/// system has to find it. For one thread.
class SpareBuffers {
public:
	SpareBuffers() { buffers_.reserve(most); }

	/// Keeps as many of the buffers as there is room for, and frees the others. Allocates no memory.
	void keep(std::vector<MeshUpload> &&uploads);

	/// A buffer with the given number of floats. Its content is unspecified.
	godot::PackedFloat32Array take(std::size_t floats);

	/// The number of taken buffers that were reused. For any thread.
	std::uint64_t reused() const { return reused_.load(std::memory_order_relaxed); }

private:
	static constexpr std::size_t most = 16;
	static constexpr std::int64_t most_floats = std::int64_t{1} << 18; ///< 1 MiB.

	std::vector<godot::PackedFloat32Array> buffers_;
	std::atomic<std::uint64_t> reused_ = 0;
};

/// `reach` is the distance in meters from the mesh's origin to its farthest corner, at scale 1.
MeshUpload to_upload(const MeshInstances &mesh, float reach, SpareBuffers &r_spare);
MeshUpload to_upload(const CompactMesh &mesh, float reach);

} // namespace thicket
