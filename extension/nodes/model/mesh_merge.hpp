#pragma once

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <glm/vec4.hpp>

#include <span>
#include <vector>

namespace thicket {

/// A mesh that is part of a model.
struct MeshPart {
	godot::Ref<godot::Mesh> mesh; ///< The mesh; never null.
	godot::Transform3D transform; ///< The transform from the mesh's space to the model's; invertible.
	/// The materials that replace those of the surfaces. A null entry keeps the surface's material.
	std::vector<godot::Ref<godot::Material>> materials;
	/// The material that is drawn over all surfaces, like GeometryInstance3D.material_overlay. Null
	/// if there is none.
	godot::Ref<godot::Material> overlay;
	/// One weight per blend shape of the mesh; empty if all are 0.
	std::vector<double> blend_weights;
};

/// Merges all parts, at their positions, into one mesh. If there is a single unmodified part,
/// returns its mesh. Otherwise creates a mesh with one surface per material and vertex format.
/// Keeps the surfaces' LODs for the engine's automatic LOD selection. Applies blend shapes, but
/// discards bones, so skinned parts have their rest pose. Overlays become separate surfaces.
/// Reverses the winding of mirrored parts. If an export has stripped the parts, returns a
/// placeholder with their bounding box. Returns null if the parts have neither surfaces nor a
/// bounding box.
godot::Ref<godot::Mesh> merged_mesh(std::span<const MeshPart> parts);

/// Copies a mesh once per value and stores the value in CUSTOM3 of all vertices of the copy.
/// Discards bones and blend shapes. A copy is null if the mesh has no surfaces.
std::vector<godot::Ref<godot::Mesh>> faded_meshes(
		const godot::Ref<godot::Mesh> &mesh, std::span<const glm::vec4> values);

/// Returns true if the vertices of a mesh use CUSTOM3.
bool uses_custom3(const godot::Ref<godot::Mesh> &mesh);

} // namespace thicket
