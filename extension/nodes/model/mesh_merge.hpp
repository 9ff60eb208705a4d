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
	godot::Transform3D transform; ///< From the mesh's space to the model's; not flat.
	std::vector<godot::Ref<godot::Material>>
			materials; ///< Replace the materials of its surfaces; null keeps a surface's own.
	godot::Ref<godot::Material>
			overlay; ///< Drawn over all surfaces, as GeometryInstance3D.material_overlay; null if there is none.
	std::vector<double> blend_weights; ///< For the mesh's blend shapes; empty if all are 0.
};

/// One mesh that looks like all parts at their positions. For a single unmodified part, returns its own mesh. Otherwise
/// returns a new mesh, with a surface for each material and vertex format. Keeps the surfaces' LODs for the engine's
/// automatic selection. Discards bones: a mesh is in its rest pose, with the weights of its blend shapes. An overlay
/// becomes separate surfaces. Triangles of mirrored parts are turned around. For parts that an export has stripped, returns a placeholder with the box around them.
/// Null if the parts have neither surfaces nor such a box.
godot::Ref<godot::Mesh> merged_mesh(std::span<const MeshPart> parts);

/// Copies a mesh once for each of the values, and stores the value in CUSTOM3 of all its vertices. Bones and blend
/// shapes are discarded as in merged_mesh. Null if the mesh has no surface.
std::vector<godot::Ref<godot::Mesh>> faded_meshes(
		const godot::Ref<godot::Mesh> &mesh, std::span<const glm::vec4> values);

/// True if the vertices of a mesh use CUSTOM3.
bool uses_custom3(const godot::Ref<godot::Mesh> &mesh);

} // namespace thicket
