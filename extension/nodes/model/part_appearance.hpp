#pragma once

#include "nodes/model/scatter_lod.hpp"

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/mesh_instance3d.hpp>
#include <godot_cpp/classes/packed_scene.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>

#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace thicket {

/// The appearance of one part of a scene, without its mesh.
struct PartAppearance {
	godot::String name; ///< The name of the part's node, for remarks.
	double transparency = 0.0;
	ShaderParameters parameters; ///< The instance shader parameters that the node sets.
	godot::String shaders;       ///< The shader code of all its materials.
};

/// Returns the names of all instance shader parameters that a scene or its nested scenes set.
std::set<std::string> instance_parameters_of(const godot::Ref<godot::PackedScene> &p_scene);

/// Reads the appearance of a node. `names` is the result of instance_parameters_of for its scene.
PartAppearance appearance_of(const godot::MeshInstance3D &node, const std::set<std::string> &names);

/// Returns the name of a material as a key of ScatterModel.replacement_materials: its resource name
/// or, if it has none, the name of its file. Returns an empty string if it has neither.
godot::String material_name(const godot::Ref<godot::Material> &p_material);

/// Returns the material that replaces a surface's material, found by its name in `p_replacements`.
/// If there is none, returns `p_material`, which is null if the mesh's material for the surface is
/// drawn.
godot::Ref<godot::Material> drawn_material(const godot::Ref<godot::Material> &p_material,
		const godot::Ref<godot::Mesh> &p_mesh, int32_t p_surface, const godot::Dictionary &p_replacements);

/// Sets the appearance of an LOD, whose parts are drawn as one instance. If the parts differ in a
/// setting, uses the first value for all of them and adds a remark.
void join_appearances(
		std::span<const PartAppearance *const> parts, ScatterLod &r_lod, godot::PackedStringArray &r_remarks);

} // namespace thicket
