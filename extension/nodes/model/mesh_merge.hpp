#pragma once

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <span>
#include <vector>

namespace thicket {

/// A mesh as a part of a model.
struct MeshPart {
	godot::Ref<godot::Mesh> mesh; ///< Never null.
	godot::Transform3D transform; ///< From the mesh's space into the model's; not mirrored, not flat.
	std::vector<godot::Ref<godot::Material>>
			materials; ///< In place of those of its surfaces; null for a surface's own.
};

/// One mesh that looks as the parts do, each in its place: the part's own mesh where there is one part as it is, else a new one with a surface for
/// each material and format of vertices. LODs that surfaces have for the engine's automatic choice are kept. Bones and blend shapes are not: a mesh
/// stands in its rest pose. Null if the parts have no surface.
godot::Ref<godot::Mesh> merged_mesh(std::span<const MeshPart> parts);

} // namespace thicket
