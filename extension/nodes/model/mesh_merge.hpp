#pragma once

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <glm/vec4.hpp>

#include <span>
#include <vector>

namespace thicket {

/// A mesh as a part of a model.
struct MeshPart {
	godot::Ref<godot::Mesh> mesh; ///< Never null.
	godot::Transform3D transform; ///< From the mesh's space into the model's; not mirrored, not flat.
	std::vector<godot::Ref<godot::Material>>
			materials; ///< In place of those of its surfaces; null for a surface's own.
	godot::Ref<godot::Material>
			overlay; ///< Drawn over all surfaces, as GeometryInstance3D.material_overlay; null for none.
	std::vector<double> blend_weights; ///< Of the mesh's blend shapes; empty if all are 0.
};

/// One mesh that looks as the parts do, each in its place: the part's own mesh where there is one part as it is, else a new one with a surface for
/// each material and format of vertices. LODs that surfaces have for the engine's automatic choice are kept. Bones are not: a mesh
/// stands in its rest pose, with the weights of its blend shapes. An overlay becomes surfaces of its own. For parts that an export has stripped, a placeholder with the box around them. Null if the parts have neither.
godot::Ref<godot::Mesh> merged_mesh(std::span<const MeshPart> parts);

/// A copy of a mesh for each of some values, which all its vertices have in CUSTOM3; as above without bones and blend shapes. Null where the mesh has no
/// surface.
std::vector<godot::Ref<godot::Mesh>> faded_meshes(
		const godot::Ref<godot::Mesh> &mesh, std::span<const glm::vec4> values);

/// True if the vertices of a mesh have something in CUSTOM3.
bool uses_custom3(const godot::Ref<godot::Mesh> &mesh);

} // namespace thicket
