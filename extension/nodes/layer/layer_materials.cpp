#include "nodes/layer/layer_materials.hpp"

#include <godot_cpp/classes/rendering_server.hpp>
#include <godot_cpp/classes/shader.hpp>
#include <godot_cpp/classes/shader_material.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

using namespace godot;

namespace thicket {

namespace {

/// The maximum of wind_strength in the shader and in ScatterFoliageWorld.
constexpr double max_wind_strength = 2.0;

void add_materials(const Ref<Mesh> &mesh, std::vector<Ref<Material>> &r_materials) {
	const int32_t surfaces = mesh.is_valid() ? mesh->get_surface_count() : 0;
	for (int32_t surface = 0; surface < surfaces; ++surface) {
		const Ref<Material> material = mesh->surface_get_material(surface);
		if (material.is_valid() && std::ranges::find(r_materials, material) == r_materials.end()) {
			r_materials.push_back(material);
		}
	}
}

/// Returns the shader of a material; null if the material is not a ShaderMaterial or has no shader.
Ref<Shader> shader_of(const Ref<Material> &material) {
	const auto *shader_material = Object::cast_to<ShaderMaterial>(material.ptr());
	return shader_material != nullptr ? shader_material->get_shader() : Ref<Shader>();
}

bool is_number(const Variant &p_value) {
	return p_value.get_type() == Variant::FLOAT || p_value.get_type() == Variant::INT;
}

/// Returns the value of a uniform in a material, or its default. Negative values become 0.
double parameter(const ShaderMaterial &material, const Variant &p_default, const StringName &p_name) {
	const Variant value = material.get_shader_parameter(p_name);
	// This order of arguments turns NAN into 0.
	return std::max(0.0, static_cast<double>(is_number(value) ? value : p_default));
}

double sway_reach_of(const ShaderMaterial &material) {
	constexpr std::array names{"wind_sway", "wind_flutter", "bend_reach", "wind_strength"};
	const Ref<Shader> shader = material.get_shader();
	if (shader.is_null()) {
		return 0.0;
	}
	std::array<double, names.size()> values{};
	for (std::size_t i = 0; i < names.size(); ++i) {
		const Variant default_value =
				RenderingServer::get_singleton()->shader_get_parameter_default(shader->get_rid(), names[i]);
		if (!is_number(default_value)) {
			return 0.0; // The shader does not include foliage.gdshaderinc.
		}
		values[i] = parameter(material, default_value, names[i]);
	}
	const auto [sway, flutter, bend, strength] = values;
	return (sway + flutter) * std::max(strength, max_wind_strength) + bend;
}

} // namespace

std::vector<Ref<Material>> materials_of(const LayerDrawing &drawing) {
	std::vector<Ref<Material>> materials;
	if (drawing.material_override.is_valid()) {
		materials.push_back(drawing.material_override);
		return materials;
	}
	const auto add_all = [&](auto &&mesh_of) {
		for (const std::vector<MeshAppearance> *appearances : {&drawing.meshes, &drawing.lod_meshes}) {
			for (const MeshAppearance &appearance : *appearances) {
				add_materials(mesh_of(appearance), materials);
			}
		}
	};
	add_all([](const MeshAppearance &appearance) { return appearance.mesh; });
	// Shadow materials come after all others.
	add_all([](const MeshAppearance &appearance) { return appearance.shadow.mesh; });
	return materials;
}

std::vector<Ref<Material>> materials_with(
		std::span<const SharedSnapshot> layers, const char *p_uniform, Variant::Type p_type) {
	const auto has_uniform = [&](const Ref<Material> &material) {
		const Ref<Shader> shader = shader_of(material);
		return shader.is_valid() &&
				RenderingServer::get_singleton()
						->shader_get_parameter_default(shader->get_rid(), p_uniform)
						.get_type() == p_type;
	};
	std::vector<Ref<Material>> result;
	for (const SharedSnapshot &layer : layers) {
		if (layer == nullptr) {
			continue;
		}
		for (const Ref<Material> &material : materials_of(layer->drawing)) {
			if (has_uniform(material) && std::ranges::find(result, material) == result.end()) {
				result.push_back(material);
			}
		}
	}
	return result;
}

bool use_instance_uniforms(std::span<const Ref<Material>> materials) {
	return std::ranges::any_of(materials, [](const Ref<Material> &material) {
		const Ref<Shader> shader = shader_of(material);
		const String code = shader.is_valid() ? static_cast<String>(shader->call("get_code")) : String();
		const std::string text = code.utf8().get_data();
		return text.find("instance uniform") != std::string::npos ||
				text.find("scatter_scale.gdshaderinc") != std::string::npos;
	});
}

double sway_reach(std::span<const Ref<Material>> materials) {
	double farthest = 0.0;
	for (const Ref<Material> &material : materials) {
		if (const auto *shader_material = Object::cast_to<ShaderMaterial>(material.ptr())) {
			farthest = std::max(farthest, sway_reach_of(*shader_material));
		}
	}
	return std::min(farthest, max_cull_margin);
}

} // namespace thicket
