// This file contains the properties of ScatterLayer in the group Distance, which control how
// drawing changes with distance.

#include "nodes/layer/scatter_layer_properties.hpp"

#include "nodes/common/engine_arrays.hpp"

#include <godot_cpp/core/memory.hpp>

#include <cstddef>

using namespace godot;

namespace thicket {

namespace {

constexpr NumberProperty view_distance{"view_distance", &StreamLayer::view_distance, 0.0, max_view_distance,
		PROPERTY_HINT_RANGE, "0,4096,0.1,or_greater,exp,suffix:m"};
constexpr NumberProperty draw_cell_size{"draw_cell_size", &LayerDrawing::draw_cell_size, 0.0, max_tile_size,
		PROPERTY_HINT_RANGE, "0,1024,0.1,or_greater,exp,suffix:m", 1.0};
constexpr NumberProperty lod_bias{
		"lod_bias", &LayerDrawing::lod_bias, 1e-3, 128.0, PROPERTY_HINT_RANGE, "0.001,128,0.001,exp"};
constexpr NumberProperty lod_fade{"lod_fade", &LodSettings::fade, 0.0, max_lod_fade, PROPERTY_HINT_RANGE, "0,0.5,0.01"};
constexpr NumberProperty thin_begin{"thin_begin", &LodSettings::thin_begin, 0.0, max_lod_distance, PROPERTY_HINT_RANGE,
		"0,4096,0.01,or_greater,exp,suffix:m"};
constexpr NumberProperty thin_end{"thin_end", &LodSettings::thin_end, 0.0, max_lod_distance, PROPERTY_HINT_RANGE,
		"0,4096,0.01,or_greater,exp,suffix:m"};
constexpr NumberProperty thin_density{
		"thin_density", &LodSettings::thin_density, 0.0, 1.0, PROPERTY_HINT_RANGE, "0,1,0.001"};
constexpr SwitchProperty thin_scale_up{"thin_scale_up", "is_thin_scale_up_enabled", &LodSettings::scale_compensation};

} // namespace

TypedArray<ScatterLod> ScatterLayer::get_mesh_lods(int64_t p_index) {
	read_models();
	TypedArray<ScatterLod> result;
	const LayerMeshes meshes = meshes_;
	const auto count = static_cast<int64_t>(meshes.size());
	if (p_index < 0 || p_index >= count) {
		report("ScatterLayer.get_mesh_lods",
				Status::out_of_range("index", p_index, between(0, count - 1, "an index of meshes")));
		return result;
	}
	LayerDrawing drawing;
	LodSettings lod;
	meshes.draw(drawing, lod);
	const auto add = [&](double distance, const MeshAppearance &appearance) {
		if (appearance.mesh.is_valid()) {
			const Ref<ScatterLod> new_lod(memnew(ScatterLod));
			new_lod->set_mesh(appearance.mesh);
			new_lod->set_distance(distance);
			new_lod->set_shadow_mesh(appearance.shadow.mesh);
			new_lod->set_cast_shadow(static_cast<ScatterLod::CastShadow>(appearance.shadow.setting));
			new_lod->set_appearance(appearance.lod_appearance);
			append(result, new_lod);
		}
	};
	const auto entry = static_cast<std::size_t>(p_index);
	add(0.0, drawing.meshes[entry]);
	for (std::size_t row = 0; row < lod.lod_distances.size(); ++row) {
		add(lod.lod_distances[row], drawing.lod_meshes[row * meshes.size() + entry]);
	}
	return result;
}

void ScatterLayer::add_lod_problems(PackedStringArray &r_problems) const {
	if (lod_.thin_density >= 1.0 && lod_.thin_end > 0.0) {
		r_problems.push_back("ScatterLayer.thin_end is not used: thin_density is 1. Lower thin_density.");
	}
	if (lod_.scale_compensation && lod_.thin_density >= 1.0) {
		r_problems.push_back("ScatterLayer.thin_scale_up is not used: thin_density is 1. Lower thin_density.");
	}
}

void ScatterLayer::bind_lod() {
	ADD_GROUP("Distance", "");
	bind_number<view_distance>();
	bind_number<draw_cell_size>();
	ADD_SUBGROUP("LOD", "lod_");
	bind_guarded<&ScatterLayer::get_mesh_lods>(D_METHOD("get_mesh_lods", "index"));
	bind_number<lod_fade>();
	bind_number<lod_bias>();
	ADD_SUBGROUP("Thinning", "thin_");
	bind_number<thin_density>();
	bind_number<thin_begin>();
	bind_number<thin_end>();
	bind_switch<thin_scale_up>();
}

} // namespace thicket
