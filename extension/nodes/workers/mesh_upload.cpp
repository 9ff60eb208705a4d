#include "nodes/workers/mesh_upload.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

AABB box_around(glm::vec3 min, glm::vec3 max, float margin) {
	return AABB(to_engine(min - margin), to_engine(max - min + 2.0F * margin));
}

void BufferPool::keep(std::vector<MeshUpload> &&uploads) {
	std::int64_t float_count = 0;
	for (const PackedFloat32Array &buffer : buffers_) {
		float_count += buffer.size();
	}
	for (MeshUpload &upload : uploads) {
		const std::int64_t size = upload.buffer.size();
		if (size > 0 && buffers_.size() < max_buffers && float_count + size <= max_floats) {
			buffers_.push_back(std::move(upload.buffer));
			float_count += size;
		}
	}
	uploads.clear();
}

PackedFloat32Array BufferPool::take(std::size_t floats) {
	PackedFloat32Array buffer;
	if (!buffers_.empty()) {
		// Reuses memory that the renderer has already read.
		buffer = std::move(buffers_.back()); // The most recently used one.
		buffers_.pop_back();
		reused_count_.fetch_add(1, std::memory_order_relaxed);
	}
	resize(buffer, static_cast<int64_t>(floats));
	return buffer;
}

MeshUpload to_upload(const MeshInstances &mesh, float mesh_radius, BufferPool &r_pool) {
	MeshUpload upload;
	upload.aabb = box_around(mesh.min, mesh.max, mesh_radius * mesh.max_scale);
	upload.buffer = r_pool.take(mesh.buffer.size());
	std::ranges::copy(mesh.buffer, writable(upload.buffer).begin());
	return upload;
}

MeshUpload to_upload(const CompactMesh &mesh, float mesh_radius) {
	MeshUpload upload;
	upload.aabb = box_around(mesh.min(), mesh.max(), mesh_radius * mesh.max_scale());
	const std::size_t floats = mesh.size() * mesh.stride();
	mesh.read_all(resize(upload.buffer, static_cast<int64_t>(floats)));
	return upload;
}

} // namespace thicket
