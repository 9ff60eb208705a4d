#pragma once

#include "core/placement/kept_tile.hpp"

#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The instances of one mesh in a tile as the renderer takes them.
struct MeshUpload {
	godot::PackedFloat32Array buffer;
	godot::AABB aabb; ///< Around the meshes as they stand, relative to the tile's origin.
};

/// The box around meshes whose origins lie in another, when they reach `margin` meters beyond it.
godot::AABB box_around(glm::vec3 min, glm::vec3 max, float margin);

/// Buffers that were uploaded, for those that come next: the engine clears new memory, and the system has to find it. For one thread.
class SpareBuffers {
public:
	SpareBuffers() { buffers_.reserve(most); }

	/// Keeps those for which there is room, and lets go of the others. Takes no memory.
	void keep(std::vector<MeshUpload> &&uploads);

	/// A buffer for so many floats. What is in it says nothing.
	godot::PackedFloat32Array take(std::size_t floats);

	/// How many of those that were taken had been kept. For any thread.
	std::uint64_t reused() const { return reused_.load(std::memory_order_relaxed); }

private:
	static constexpr std::size_t most = 16;
	static constexpr std::int64_t most_floats = std::int64_t{1} << 18; ///< 1 MiB.

	std::vector<godot::PackedFloat32Array> buffers_;
	std::atomic<std::uint64_t> reused_ = 0;
};

/// `reach`: meters from the mesh's origin to its farthest corner, at scale 1.
MeshUpload to_upload(const MeshInstances &mesh, float reach, SpareBuffers &r_spare);
MeshUpload to_upload(const KeptMesh &mesh, float reach);

} // namespace thicket
