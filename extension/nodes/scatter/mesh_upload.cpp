#include "nodes/scatter/mesh_upload.hpp"

#include <algorithm>

using namespace godot;

namespace thicket {

MeshUpload to_upload(const MeshInstances &mesh, float reach) {
	const float margin = reach * mesh.max_scale;
	const glm::vec3 min = mesh.min - margin;
	const glm::vec3 size = mesh.max - mesh.min + 2.0F * margin;
	MeshUpload upload;
	upload.aabb = AABB(Vector3(min.x, min.y, min.z), Vector3(size.x, size.y, size.z));
	upload.buffer.resize(static_cast<int64_t>(mesh.buffer.size()));
	std::copy(mesh.buffer.begin(), mesh.buffer.end(), upload.buffer.ptrw());
	return upload;
}

} // namespace thicket
