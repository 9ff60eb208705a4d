#include "nodes/scatter/mesh_upload.hpp"

#include "nodes/common/convert.hpp"

using namespace godot;

namespace thicket {

MeshUpload to_upload(const MeshInstances &mesh, float reach) {
	const float margin = reach * mesh.max_scale;
	const glm::vec3 min = mesh.min - margin;
	const glm::vec3 size = mesh.max - mesh.min + 2.0F * margin;
	MeshUpload upload;
	upload.aabb = AABB(to_engine(min), to_engine(size));
	upload.buffer = packed_floats(mesh.buffer);
	return upload;
}

} // namespace thicket
