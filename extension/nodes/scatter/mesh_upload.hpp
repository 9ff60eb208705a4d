#pragma once

#include "core/placement/kept_tile.hpp"

#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>

namespace thicket {

/// The instances of one mesh in a tile as the renderer takes them.
struct MeshUpload {
	godot::PackedFloat32Array buffer;
	godot::AABB aabb; ///< Around the meshes as they stand, relative to the tile's origin.
};

/// The box around meshes whose origins lie in another, when they reach `margin` meters beyond it.
godot::AABB box_around(glm::vec3 min, glm::vec3 max, float margin);

/// `reach`: meters from the mesh's origin to its farthest corner, at scale 1.
MeshUpload to_upload(const MeshInstances &mesh, float reach);
MeshUpload to_upload(const KeptMesh &mesh, float reach);

} // namespace thicket
