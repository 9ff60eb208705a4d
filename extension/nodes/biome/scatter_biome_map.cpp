#include "nodes/biome/scatter_biome_map.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/watch.hpp"
#include "nodes/ground/image_posts.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/classes/texture2d.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <array>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Builds a map with the same biome everywhere.
Status make_uniform(std::uint8_t biome, BiomeMap &r_map) {
	const std::array<std::uint8_t, 1> pixel{biome};
	return r_map.set({1, 1}, pixel, {{0.0, 0.0}, {1.0, 1.0}}, BiomeEdge::clamp, {});
}

bool is_in(const Ref<ScatterLayer> &p_layer, const TypedArray<ScatterLayer> &p_layers) {
	bool is_listed = false;
	for (int64_t index = 0; index < p_layers.size() && !is_listed; ++index) {
		is_listed = Ref<ScatterLayer>(p_layers[index]) == p_layer;
	}
	return is_listed;
}

} // namespace

void ScatterBiomeMap::set_biomes(const TypedArray<ScatterBiome> &p_biomes) {
	if (p_biomes.size() > static_cast<int64_t>(max_biomes)) {
		report(class_name, Status::wrong_size("biomes", p_biomes.size(), at_most(max_biomes, "entries")));
		return;
	}
	biomes_ = p_biomes;
	mark_outdated();
}

void ScatterBiomeMap::set_map_image(const Ref<Resource> &p_image) {
	const Ref<Image> image = p_image;
	const Ref<Texture2D> texture = p_image;
	if (p_image.is_valid() && image.is_null() && texture.is_null()) {
		report(class_name, Status::missing("map_image", "Set an image that has pixels"));
		return;
	}
	watch(image_.ptr(), "changed", this, "_image_changed", false);
	image_ = p_image;
	watch(image_.ptr(), "changed", this, "_image_changed", true);
	image_changed();
}

void ScatterBiomeMap::set_map_rect(const Rect2 &p_rect) {
	constexpr double limit = 1e9;
	constexpr double min_side = 1e-3;
	for (const real_t coordinate : {p_rect.position.x, p_rect.position.y}) {
		if (!accept_number(class_name, "map_rect", coordinate, -limit, limit)) {
			return;
		}
	}
	for (const real_t side : {p_rect.size.x, p_rect.size.y}) {
		if (!accept_number(class_name, "map_rect", side, min_side, limit)) {
			return;
		}
	}
	if (rect_ != p_rect) {
		rect_ = p_rect;
		mark_outdated();
	}
}

void ScatterBiomeMap::set_map_mode(MapMode p_mode) {
	if (accept_number(class_name, "map_mode", static_cast<double>(p_mode), MAP_MODE_COLORS, MAP_MODE_INDICES)) {
		mode_ = static_cast<BiomePixels>(p_mode);
		mark_outdated();
	}
}

void ScatterBiomeMap::set_map_edge(MapEdge p_edge) {
	if (accept_number(class_name, "map_edge", static_cast<double>(p_edge), MAP_EDGE_NOTHING, MAP_EDGE_CLAMP)) {
		edge_ = static_cast<BiomeEdge>(p_edge);
		mark_outdated();
	}
}

void ScatterBiomeMap::set_border(const char *p_name, double BiomeBorders::*p_member, double p_value) {
	BiomeBorders next = borders_;
	next.*p_member = p_value;
	const Status status = validate(next);
	report(class_name, status.ok() ? status : Status{status.code, p_name, p_value});
	if (status.ok() && !(next == borders_)) {
		borders_ = next;
		mark_outdated();
	}
}

void ScatterBiomeMap::set_border_seed(int64_t p_seed) {
	if (std::exchange(borders_.seed, static_cast<std::uint64_t>(p_seed)) != static_cast<std::uint64_t>(p_seed)) {
		mark_outdated();
	}
}

void ScatterBiomeMap::image_changed() {
	must_read_pixels_ = true;
	mark_outdated();
}

void ScatterBiomeMap::mark_outdated() {
	is_outdated_ = true;
	watch_biomes(false);
	watched_biomes_.clear();
	for (int64_t index = 0; index < biomes_.size(); ++index) {
		watched_biomes_.push_back(read_biome(biomes_[index]));
	}
	watch_biomes(true);
	emit_changed();
}

ScatterBiomeMap::WatchedBiome ScatterBiomeMap::read_biome(const Variant &p_biome) {
	WatchedBiome watched{p_biome, {}};
	if (watched.biome.is_valid()) {
		const TypedArray<ScatterLayer> layers = watched.biome->get_layers();
		for (int64_t index = 0; index < layers.size(); ++index) {
			watched.layers.emplace_back(layers[index]);
		}
	}
	return watched;
}

void ScatterBiomeMap::watch_biomes(bool p_watch) {
	for (const WatchedBiome &watched : watched_biomes_) {
		watch(watched.biome.ptr(), "changed", this, "_outdate", p_watch);
	}
}

bool ScatterBiomeMap::differs() const {
	bool is_same = static_cast<std::size_t>(biomes_.size()) == watched_biomes_.size();
	for (std::size_t index = 0; is_same && index < watched_biomes_.size(); ++index) {
		is_same = watched_biomes_[index] == read_biome(biomes_[static_cast<int64_t>(index)]);
	}
	return !is_same;
}

void ScatterBiomeMap::detect_changes() {
	if (differs()) {
		mark_outdated();
	}
}

std::size_t ScatterBiomeMap::biome_count() const {
	return std::min(static_cast<std::size_t>(biomes_.size()), max_biomes);
}

const ScatterBiome *ScatterBiomeMap::biome(std::size_t index) const {
	const Ref<ScatterBiome> entry = biomes_[static_cast<int64_t>(index)];
	return entry.ptr();
}

std::vector<BiomeColor> ScatterBiomeMap::colors() const {
	std::vector<BiomeColor> result;
	for (std::size_t index = 0; index < biome_count(); ++index) {
		if (const ScatterBiome *entry = biome(index)) {
			result.push_back(biome_color(static_cast<std::uint8_t>(index), entry->get_color()));
		}
	}
	return result;
}

Status ScatterBiomeMap::make(BiomeMap &r_map) {
	if (image_.is_null()) {
		return make_uniform(biome_count() > 0 ? 0 : no_biome, r_map);
	}
	if (std::exchange(must_read_pixels_, false)) {
		pixels_ = color_pixels(image_of(image_));
	}
	if (pixels_.size.x == 0) {
		return make_uniform(no_biome, r_map);
	}
	for (const int side : {pixels_.size.x, pixels_.size.y}) {
		if (side > max_biome_map_pixels) {
			return Status::out_of_range(
					"map_image", side, at_most(max_biome_map_pixels, "pixels on each side"), "Scale the image down");
		}
	}
	Status status = r_map.set(
			pixels_.size, biomes_of(pixels_, mode_, colors(), biome_count()), to_core(rect_), edge_, borders_);
	status.property = "map_image";
	return status;
}

void ScatterBiomeMap::refresh() {
	if (!std::exchange(is_outdated_, false)) {
		// The map is up to date.
		return;
	}
	const auto new_map = std::make_shared<BiomeMap>();
	status_ = make(*new_map);
	if (status_.ok() && !(*new_map == *map_)) {
		map_ = new_map;
	}
	const String error = status_.ok() ? String() : sentence(class_name, status_);
	if (!error.is_empty() && !(error == last_error_)) {
		ERR_PRINT(error);
	}
	last_error_ = error;
}

const std::shared_ptr<const BiomeMap> &ScatterBiomeMap::map() {
	refresh();
	return map_;
}

PerBiome<float> ScatterBiomeMap::densities_of(const Ref<ScatterLayer> &p_layer) const {
	PerBiome<float> result{};
	for (std::size_t index = 0; index < biome_count(); ++index) {
		if (const ScatterBiome *entry = biome(index); entry != nullptr && is_in(p_layer, entry->get_layers())) {
			result[index] = static_cast<float>(entry->get_density());
		}
	}
	return result;
}

PerBiome<float> ScatterBiomeMap::weights_for(const WorldInput &input) const {
	PerBiome<float> result{};
	const String name = String::utf8(input.name.c_str());
	for (std::size_t index = 0; index < biome_count(); ++index) {
		const ScatterBiome *entry = biome(index);
		const bool is_match = input.name.empty() ? index == static_cast<std::size_t>(input.number)
												 : entry != nullptr && entry->get_name() == name;
		result[index] = is_match ? 1.0F : 0.0F;
	}
	return result;
}

PerBiome<double> ScatterBiomeMap::water_levels(double node_level) const {
	PerBiome<double> result{};
	result.fill(node_level);
	for (std::size_t index = 0; index < biome_count(); ++index) {
		const ScatterBiome *entry = biome(index);
		if (entry != nullptr && entry->get_water_mode() != ScatterBiome::WATER_MODE_INHERIT) {
			result[index] =
					entry->get_water_mode() == ScatterBiome::WATER_MODE_OWN ? entry->get_water_level() : no_water;
		}
	}
	return result;
}

Ref<ScatterBiome> ScatterBiomeMap::get_biome_at(const Vector2 &p_position) {
	const std::uint8_t index = map()->dominant_at(to_core(p_position));
	return index < biome_count() ? Ref<ScatterBiome>(biomes_[index]) : Ref<ScatterBiome>();
}

PackedFloat32Array ScatterBiomeMap::get_weights_at(const Vector2 &p_position) {
	BiomeTaps taps{};
	map()->taps_at(to_core(p_position), taps);
	return weights_of(taps);
}

/// Returns the weight of each biome.
PackedFloat32Array ScatterBiomeMap::weights_of(const BiomeTaps &taps) const {
	std::vector<float> weights(biome_count(), 0.0F);
	for (const std::uint8_t index : taps) {
		if (index < weights.size()) {
			weights[index] += 1.0F / static_cast<float>(biome_taps);
		}
	}
	return packed_floats(weights);
}

bool ScatterBiomeMap::has_own_water() const {
	bool has_water = false;
	for (std::size_t index = 0; index < biome_count() && !has_water; ++index) {
		const ScatterBiome *entry = biome(index);
		has_water = entry != nullptr && entry->get_water_mode() == ScatterBiome::WATER_MODE_OWN;
	}
	return has_water;
}

void ScatterBiomeMap::add_color_problems(PackedStringArray &r_problems) const {
	const std::vector<BiomeColor> biome_colors = colors();
	for (const BiomeColor &color : biome_colors) {
		const auto first = std::ranges::find_if(biome_colors, [&color](const BiomeColor &other) {
			return other.red == color.red && other.green == color.green && other.blue == color.blue;
		});
		if (first->index != color.index) {
			r_problems.push_back(
					vformat("ScatterBiomeMap.biomes[%d] has no area: biomes[%d] has the same color. Change one color.",
							static_cast<int64_t>(color.index), static_cast<int64_t>(first->index)));
		}
	}
}

void ScatterBiomeMap::add_layer_problems(
		const TypedArray<ScatterLayer> &p_node_layers, PackedStringArray &r_problems) const {
	for (int64_t index = 0; index < p_node_layers.size(); ++index) {
		const Ref<ScatterLayer> layer = p_node_layers[index];
		bool in_biome = false;
		each_layers([&](const TypedArray<ScatterLayer> &p_layers) { in_biome = in_biome || is_in(layer, p_layers); });
		if (layer.is_valid() && in_biome) {
			r_problems.push_back(vformat(
					"Layer %d is also in a biome, but is placed everywhere. Remove it from one of the two lists.",
					index));
		}
	}
}

PackedStringArray ScatterBiomeMap::problems(const TypedArray<ScatterLayer> &p_node_layers) {
	refresh();
	PackedStringArray result;
	if (biomes_.is_empty()) {
		result.push_back("ScatterBiomeMap.biomes is empty: add a ScatterBiome.");
	}
	if (static_cast<std::size_t>(biomes_.size()) > max_biomes) {
		result.push_back(vformat(
				"ScatterBiomeMap.biomes has %d entries, of which only the first %d are used. Remove the others.",
				biomes_.size(), static_cast<int64_t>(max_biomes)));
	}
	const bool has_image = image_.is_valid();
	if (!last_error_.is_empty()) {
		result.push_back(last_error_);
	} else if (const String stripped_warning = stripped_problem(); !stripped_warning.is_empty()) {
		result.push_back(stripped_warning);
	} else if (has_image && pixels_.size.x == 0) {
		result.push_back("ScatterBiomeMap.map_image is empty: set an image that has pixels.");
	} else if (!has_image && biomes_.size() > 1) {
		result.push_back("ScatterBiomeMap.map_image is not set, so the first biome is everywhere. Set an image.");
	}
	if (has_image && mode_ == BiomePixels::colors) {
		add_color_problems(result);
	}
	add_layer_problems(p_node_layers, result);
	return result;
}

void ScatterBiomeMap::add_used(SceneUse::List &r_used) const {
	for (std::size_t index = 0; index < biome_count(); ++index) {
		r_used.add(Ref<ScatterBiome>(biomes_[static_cast<int64_t>(index)]));
	}
}

void ScatterBiomeMap::_bind_methods() {
	using Self = ScatterBiomeMap;
	bind_guarded<&Self::set_biomes>(D_METHOD("set_biomes", "biomes"));
	bind_guarded<&Self::get_biomes>(D_METHOD("get_biomes"));
	bind_guarded<&Self::get_biome_at>(D_METHOD("get_biome_at", "position"));
	bind_guarded<&Self::get_weights_at>(D_METHOD("get_weights_at", "position"));
	bind_guarded<&Self::mark_outdated>(ThreadUse::relayed, D_METHOD("_outdate"));
	bind_guarded<&Self::image_changed>(ThreadUse::relayed, D_METHOD("_image_changed"));
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "biomes", PROPERTY_HINT_ARRAY_TYPE,
						 vformat("%d/%d:ScatterBiome", Variant::OBJECT, PROPERTY_HINT_RESOURCE_TYPE)),
			"set_biomes", "get_biomes");
	bind_planets();
	bind_map();
	bind_borders();
}

void ScatterBiomeMap::bind_map() {
	using Self = ScatterBiomeMap;
	bind_guarded<&Self::embed_stripped_data>(D_METHOD("embed_stripped_data"));
	bind_guarded<&Self::set_map_image>(D_METHOD("set_map_image", "image"));
	bind_guarded<&Self::get_map_image>(D_METHOD("get_map_image"));
	bind_guarded<&Self::set_map_rect>(D_METHOD("set_map_rect", "rect"));
	bind_guarded<&Self::get_map_rect>(D_METHOD("get_map_rect"));
	bind_guarded<&Self::set_map_mode>(D_METHOD("set_map_mode", "mode"));
	bind_guarded<&Self::get_map_mode>(D_METHOD("get_map_mode"));
	bind_guarded<&Self::set_map_edge>(D_METHOD("set_map_edge", "edge"));
	bind_guarded<&Self::get_map_edge>(D_METHOD("get_map_edge"));
	ADD_GROUP("Map", "map_");
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "map_image", PROPERTY_HINT_RESOURCE_TYPE, "Image,Texture2D"),
			"set_map_image", "get_map_image");
	ADD_PROPERTY(
			PropertyInfo(Variant::RECT2, "map_rect", PROPERTY_HINT_NONE, "suffix:m"), "set_map_rect", "get_map_rect");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "map_mode", PROPERTY_HINT_ENUM, "Colors,Indices"), "set_map_mode",
			"get_map_mode");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "map_edge", PROPERTY_HINT_ENUM, "Nothing,Clamp"), "set_map_edge",
			"get_map_edge");
	BIND_ENUM_CONSTANT(MAP_MODE_COLORS);
	BIND_ENUM_CONSTANT(MAP_MODE_INDICES);
	BIND_ENUM_CONSTANT(MAP_EDGE_NOTHING);
	BIND_ENUM_CONSTANT(MAP_EDGE_CLAMP);
}

void ScatterBiomeMap::bind_borders() {
	using Self = ScatterBiomeMap;
	bind_guarded<&Self::set_border_width>(D_METHOD("set_border_width", "width"));
	bind_guarded<&Self::get_border_width>(D_METHOD("get_border_width"));
	bind_guarded<&Self::set_border_noise>(D_METHOD("set_border_noise", "noise"));
	bind_guarded<&Self::get_border_noise>(D_METHOD("get_border_noise"));
	bind_guarded<&Self::set_border_noise_size>(D_METHOD("set_border_noise_size", "size"));
	bind_guarded<&Self::get_border_noise_size>(D_METHOD("get_border_noise_size"));
	bind_guarded<&Self::set_border_seed>(D_METHOD("set_border_seed", "seed"));
	bind_guarded<&Self::get_border_seed>(D_METHOD("get_border_seed"));
	ADD_GROUP("Borders", "border_");
	ADD_PROPERTY(
			PropertyInfo(Variant::FLOAT, "border_width", PROPERTY_HINT_RANGE, "0,500,0.01,or_greater,exp,suffix:m"),
			"set_border_width", "get_border_width");
	ADD_PROPERTY(
			PropertyInfo(Variant::FLOAT, "border_noise", PROPERTY_HINT_RANGE, "0,500,0.01,or_greater,exp,suffix:m"),
			"set_border_noise", "get_border_noise");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "border_noise_size", PROPERTY_HINT_RANGE,
						 "1,1000,0.01,or_greater,exp,suffix:m"),
			"set_border_noise_size", "get_border_noise_size");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "border_seed"), "set_border_seed", "get_border_seed");
}

} // namespace thicket
