#include "nodes/scatter/scatter_problems.hpp"

#include <godot_cpp/core/object.hpp>

#include <optional>
#include <set>
#include <string>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// What is wrong with one layer, whatever the others are.
void add_problems_of(ScatterLayer &layer, const String &p_where, const Ref<ScatterTerrain> &p_terrain, bool has_water,
		PackedStringArray &r_problems) {
	for (const String &problem : layer.problems()) {
		r_problems.push_back(p_where + problem);
	}
	if (layer.get_ground_textures().size() > 0 && p_terrain.is_valid() && p_terrain->problem().is_empty() &&
			!p_terrain->has_textures()) {
		r_problems.push_back(
				p_where + String("ScatterLayer.ground_textures has no effect: the terrain has no textures."));
	}
	if (layer.needs_water() && !has_water) {
		r_problems.push_back(p_where +
				String("nothing stands: min_water_depth asks for water, and there is none. Set "
					   "TerrainScatter3D.water_enabled."));
	}
}

} // namespace

void add_terrain_problems(const Ref<ScatterTerrain> &p_terrain, PackedStringArray &r_problems) {
	if (p_terrain.is_null()) {
		r_problems.push_back("No terrain: set TerrainScatter3D.terrain to a ScatterTerrain to show anything.");
	} else if (const String problem = p_terrain->problem(); !problem.is_empty()) {
		r_problems.push_back(problem);
	} else if (const String remark = p_terrain->remark(); !remark.is_empty()) {
		r_problems.push_back(remark);
	}
}

void add_layer_problems(const TypedArray<ScatterLayer> &p_layers, const Ref<ScatterTerrain> &p_terrain, bool has_water,
		PackedStringArray &r_problems) {
	if (p_layers.is_empty()) {
		r_problems.push_back("No layers: add a ScatterLayer to TerrainScatter3D.layers.");
	}
	std::vector<std::optional<LayerLinks>> links;
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		const Ref<ScatterLayer> layer = p_layers[index];
		links.push_back(layer.is_valid() ? std::optional(layer->links()) : std::nullopt);
	}
	std::vector<const LayerLinks *> names;
	for (const std::optional<LayerLinks> &layer : links) {
		names.push_back(layer ? &*layer : nullptr);
	}
	std::set<int64_t> ids;
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		const String where = "Layer " + String::num_int64(index) + ": ";
		const Ref<ScatterLayer> layer = p_layers[index];
		if (layer.is_null()) {
			r_problems.push_back(where + String("empty, shows nothing."));
			continue;
		}
		add_problems_of(*layer.ptr(), where, p_terrain, has_water, r_problems);
		for (const std::string &problem : name_problems(names, static_cast<std::size_t>(index))) {
			r_problems.push_back(where + String::utf8(problem.c_str()));
		}
		const int64_t id = layer->own_id();
		if (!ids.insert(id >= 0 ? id : index).second) {
			r_problems.push_back(where +
					String("has the same layer_id as another: both use the same random numbers and ids. "
						   "Set one to -1 for an id of its own."));
		}
	}
}

} // namespace thicket
