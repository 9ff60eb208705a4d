#include "nodes/scatter/mesh_upload.hpp"

#include "nodes/common/convert.hpp"

using namespace godot;

namespace thicket {

AABB box_around(glm::vec3 min, glm::vec3 max, float margin) {
	return AABB(to_engine(min - margin), to_engine(max - min + 2.0F * margin));
}

MeshUpload to_upload(const MeshInstances &mesh, float reach) {
	MeshUpload upload;
	upload.aabb = box_around(mesh.min, mesh.max, reach * mesh.max_scale);
	upload.buffer = packed_floats(mesh.buffer);
	return upload;
}

MeshUpload to_upload(const KeptMesh &mesh, float reach) {
	MeshUpload upload;
	upload.aabb = box_around(mesh.min(), mesh.max(), reach * mesh.max_scale());
	const std::size_t floats = mesh.size() * mesh.stride();
	upload.buffer.resize(static_cast<int64_t>(floats));
	mesh.read_all({upload.buffer.ptrw(), floats});
	return upload;
}

} // namespace thicket
