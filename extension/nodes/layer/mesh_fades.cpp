#include "nodes/layer/mesh_fades.hpp"

#include "nodes/model/mesh_merge.hpp"

#include <godot_cpp/classes/array_mesh.hpp>
#include <godot_cpp/classes/rendering_server.hpp>
#include <godot_cpp/classes/shader.hpp>
#include <godot_cpp/classes/shader_material.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstdint>
#include <map>

using namespace godot;

namespace thicket {

namespace {

/// Determines whether meshes can fade. Caches the result for each material, because meshes share
/// materials.
class FadeFinder {
public:
	explicit FadeFinder(const Ref<Material> &material_override) : override_(material_override) {}

	bool fades(const Ref<Mesh> &mesh);
	std::vector<std::uint64_t> surfaces;

private:
	static bool has_fade(const Ref<ShaderMaterial> &material);
	bool fades(const Ref<Material> &material);

	Ref<Material> override_;
	std::map<std::uint64_t, bool> cached_results_;
};

bool FadeFinder::has_fade(const Ref<ShaderMaterial> &material) {
	const StringName name("scatter_cross_fade");
	const Ref<Shader> shader = material.is_valid() ? material->get_shader() : Ref<Shader>();
	if (shader.is_null()) {
		return false;
	}
	const Variant default_value =
			RenderingServer::get_singleton()->shader_get_parameter_default(shader->get_rid(), name);
	const Variant value = material->get_shader_parameter(name);
	return default_value.get_type() == Variant::BOOL &&
			static_cast<bool>(value.get_type() == Variant::BOOL ? value : default_value);
}

bool FadeFinder::fades(const Ref<Material> &material) {
	if (material.is_null()) {
		return false;
	}
	const std::uint64_t id = material->get_instance_id();
	const auto entry = cached_results_.find(id);
	if (entry != cached_results_.end()) {
		return entry->second;
	}
	return cached_results_[id] = has_fade(material);
}

bool FadeFinder::fades(const Ref<Mesh> &mesh) {
	const int32_t count = mesh.is_valid() ? mesh->get_surface_count() : 0;
	bool all_fade = count > 0;
	std::vector<std::uint64_t> ids;
	for (int32_t surface = 0; surface < count && all_fade; ++surface) {
		const Ref<Material> material = override_.is_valid() ? override_ : mesh->surface_get_material(surface);
		all_fade = fades(material);
		ids.push_back(all_fade ? material->get_instance_id() : 0);
		if (const Ref<ArrayMesh> arrays = mesh; arrays.is_valid()) {
			ids.push_back(static_cast<std::uint64_t>(arrays->surface_get_array_len(surface)));
		}
	}
	if (!all_fade || uses_custom3(mesh)) {
		return false;
	}
	surfaces.insert(surfaces.end(), ids.begin(), ids.end());
	return true;
}

} // namespace

void add_fades(LayerDrawing &r_drawing) {
	FadeFinder finder(r_drawing.material_override);
	for (std::vector<MeshAppearance> *appearances : {&r_drawing.meshes, &r_drawing.lod_meshes}) {
		for (MeshAppearance &appearance : *appearances) {
			appearance.fades = finder.fades(appearance.mesh);
		}
	}
	r_drawing.surfaces = std::move(finder.surfaces);
}

} // namespace thicket
