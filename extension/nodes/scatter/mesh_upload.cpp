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

} // namespace thicket
