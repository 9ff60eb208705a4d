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

/// How one part of a scene is drawn, apart from its mesh.
struct PartLook {
	godot::String name; ///< The name of its node, for remarks.
	double transparency = 0.0;
	ShaderParameters parameters; ///< The instance shader parameters that are set.
	godot::String shaders;       ///< The code of the shaders of its materials.
};

/// The names of all instance shader parameters that a scene or a nested scene sets.
std::set<std::string> instance_parameters_of(const godot::Ref<godot::PackedScene> &p_scene);

/// `names` are those of its scene.
PartLook look_of(const godot::MeshInstance3D &node, const std::set<std::string> &names);

/// The name of a material in ScatterModel.replacement_materials: its own, or that of its file; empty if it has neither.
godot::String material_name(const godot::Ref<godot::Material> &p_material);

/// The replacement of a surface's material, by its name, if there is one. Otherwise `p_material`, which is null if the mesh's own material is drawn.
godot::Ref<godot::Material> drawn_material(const godot::Ref<godot::Material> &p_material,
		const godot::Ref<godot::Mesh> &p_mesh, int32_t p_surface, const godot::Dictionary &p_replacements);

/// Sets one look for all parts of an LOD, because they are drawn as one instance. If their looks differ, uses the first
/// one for all and adds a remark.
void join_looks(std::span<const PartLook *const> parts, ScatterLod &r_lod, godot::PackedStringArray &r_remarks);

} // namespace thicket
