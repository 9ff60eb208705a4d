#include "nodes/model/part_appearance.hpp"
#include "nodes/common/resource_file.hpp"

#include <godot_cpp/classes/scene_state.hpp>
#include <godot_cpp/classes/shader.hpp>
#include <godot_cpp/classes/shader_material.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <algorithm>
#include <string_view>

using namespace godot;

namespace thicket {

namespace {

constexpr std::string_view prefix = "instance_shader_parameters/";
constexpr int max_depth = 64; ///< The maximum depth of nested scenes.

/// Adds the names of the instance shader parameters that a scene and its nested scenes set.
void add_parameters(const Ref<PackedScene> &p_scene, int depth, std::set<std::string> &r_names) {
	const Ref<SceneState> state = p_scene.is_valid() && depth < max_depth ? p_scene->get_state() : Ref<SceneState>();
	for (int32_t node = 0; state.is_valid() && node < state->get_node_count(); ++node) {
		add_parameters(state->get_node_instance(node), depth + 1, r_names);
		for (int32_t property = 0; property < state->get_node_property_count(node); ++property) {
			const std::string name = String(state->get_node_property_name(node, property)).utf8().get_data();
			if (name.starts_with(prefix)) {
				r_names.insert(name.substr(prefix.size()));
			}
		}
	}
}

String code_of(const Ref<Material> &p_material) {
	const Ref<ShaderMaterial> material = p_material;
	const Ref<Shader> shader = material.is_valid() ? material->get_shader() : Ref<Shader>();
	return shader.is_valid() ? static_cast<String>(shader->call("get_code")) : String();
}

const Variant *find(const ShaderParameters &parameters, const StringName &p_name) {
	const auto entry = std::ranges::find(parameters, p_name, [](const auto &parameter) { return parameter.first; });
	return entry != parameters.end() ? &entry->second : nullptr;
}

bool same_value(const Variant &p_a, const Variant &p_b) {
	return p_a.get_type() == p_b.get_type() && static_cast<String>(p_a) == static_cast<String>(p_b);
}

/// Returns true if a part may be drawn with a value other than `p_value`.
bool differs(const PartAppearance &part, const StringName &p_name, const Variant &p_value) {
	const Variant *part_value = find(part.parameters, p_name);
	const std::string name = String(p_name).utf8().get_data();
	const std::string code = part.shaders.utf8().get_data();
	return part_value != nullptr ? !same_value(*part_value, p_value) : code.find(name) != std::string::npos;
}

} // namespace

std::set<std::string> instance_parameters_of(const Ref<PackedScene> &p_scene) {
	std::set<std::string> names;
	add_parameters(p_scene, 0, names);
	return names;
}

PartAppearance appearance_of(const MeshInstance3D &node, const std::set<std::string> &names) {
	PartAppearance appearance{node.get_name(), node.get_transparency(), {},
			names.empty() ? String() : code_of(node.get_material_override())};
	const Ref<Mesh> mesh = node.get_mesh();
	for (int32_t surface = 0; !names.empty() && surface < mesh->get_surface_count(); ++surface) {
		const Ref<Material> override_material = node.get_surface_override_material(surface);
		appearance.shaders = appearance.shaders +
				code_of(override_material.is_valid() ? override_material : mesh->surface_get_material(surface));
	}
	for (const std::string &name : names) {
		const Variant value = node.get_instance_shader_parameter(name.c_str());
		if (value.get_type() != Variant::NIL) {
			appearance.parameters.emplace_back(name.c_str(), value);
		}
	}
	return appearance;
}

String material_name(const Ref<Material> &p_material) {
	if (p_material.is_null()) {
		return {};
	}
	const String name = p_material->get_name();
	return name.is_empty() ? name_of_file(p_material->get_path()) : name;
}

Ref<Material> drawn_material(
		const Ref<Material> &p_material, const Ref<Mesh> &p_mesh, int32_t p_surface, const Dictionary &p_replacements) {
	if (p_replacements.is_empty()) {
		return p_material;
	}
	const Ref<Material> material = p_material.is_valid() ? p_material : p_mesh->surface_get_material(p_surface);
	const Ref<Material> replacement = p_replacements.get(material_name(material), Variant());
	return material.is_valid() && replacement.is_valid() ? replacement : p_material;
}

void join_appearances(std::span<const PartAppearance *const> parts, ScatterLod &r_lod, PackedStringArray &r_remarks) {
	const auto remark = [&r_remarks](const PartAppearance &part, const String &p_setting) {
		r_remarks.push_back(
				vformat("\"%s\" has a different %s than other parts of its LOD: all are drawn with the value of "
						"the first part that has one.",
						part.name, p_setting));
	};
	const PartAppearance &first = *parts.front();
	r_lod.set_transparency(first.transparency);
	Dictionary joined_parameters;
	ShaderParameters parameters;
	for (const PartAppearance *part : parts) {
		if (part->transparency != first.transparency) {
			remark(*part, "transparency");
		}
		for (const auto &[name, value] : part->parameters) {
			if (find(parameters, name) == nullptr) {
				parameters.emplace_back(name, value);
				joined_parameters[name] = value;
			}
		}
	}
	for (const auto &[name, value] : parameters) {
		for (const PartAppearance *part : parts) {
			if (differs(*part, name, value)) {
				remark(*part, vformat("instance shader parameter \"%s\"", String(name)));
			}
		}
	}
	r_lod.set_instance_shader_parameters(joined_parameters);
}

} // namespace thicket
