#pragma once

#include "nodes/model/scatter_lod.hpp"

#include <godot_cpp/classes/mesh_instance3d.hpp>
#include <godot_cpp/classes/packed_scene.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>

#include <cstddef>
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

/// Sets one look for all parts of an LOD, because they are drawn as one instance. If their looks differ, uses the first
/// one for all and adds a remark.
void join_looks(std::span<const PartLook *const> parts, ScatterLod &r_lod, godot::PackedStringArray &r_remarks);

} // namespace thicket
