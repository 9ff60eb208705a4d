#pragma once

#include "core/rules/biome_rules.hpp"
#include "nodes/biome/biome_image.hpp"
#include "nodes/biome/scatter_biome.hpp"

#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/vector2.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// Biomes, and an image that determines the area of each: BiomeMap as a resource of the engine. Several nodes may share one.
///
/// Every setter emits `changed`. A `changed` of a biome or of the image also makes the map emit it. Scripts share the
/// array of biomes and the biomes' arrays of layers. Changes that they make in place take effect at the next `notice`.
class ScatterBiomeMap : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterBiomeMap, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterBiomeMap";

	/// BiomePixels, for scripts.
	enum MapMode : std::int64_t {
		MAP_MODE_COLORS,
		MAP_MODE_INDICES,
	};

	/// BiomeEdge, for scripts.
	enum MapEdge : std::int64_t {
		MAP_EDGE_NOTHING,
		MAP_EDGE_CLAMP,
	};

	/// At most max_biomes. A null entry is land without a biome and keeps its index.
	void set_biomes(const godot::TypedArray<ScatterBiome> &p_biomes);
	godot::TypedArray<ScatterBiome> get_biomes() const { return biomes_; }

	/// An Image or a Texture2D, read again when it is set. If null, the first biome is everywhere.
	void set_map_image(const godot::Ref<godot::Resource> &p_image);
	godot::Ref<godot::Resource> get_map_image() const { return image_; }

	/// Replaces a texture with its image, because an export strips textures. False if there is none.
	bool embed_stripped_data();

	/// The area that the image covers, in world meters: x, and z as y. Each side is at least 0.001.
	void set_map_rect(const godot::Rect2 &p_rect);
	godot::Rect2 get_map_rect() const { return rect_; }
	void set_map_mode(MapMode p_mode);
	MapMode get_map_mode() const { return static_cast<MapMode>(mode_); }
	void set_map_edge(MapEdge p_edge);
	MapEdge get_map_edge() const { return static_cast<MapEdge>(edge_); }

	// See BiomeBorders for the meaning of these properties.
	void set_border_width(double p_width) { set_border("border_width", &BiomeBorders::width, p_width); }
	double get_border_width() const { return borders_.width; }
	void set_border_noise(double p_noise) { set_border("border_noise", &BiomeBorders::noise, p_noise); }
	double get_border_noise() const { return borders_.noise; }
	void set_border_noise_size(double p_size) { set_border("border_noise_size", &BiomeBorders::noise_size, p_size); }
	double get_border_noise_size() const { return borders_.noise_size; }
	void set_border_seed(int64_t p_seed);
	int64_t get_border_seed() const { return static_cast<int64_t>(borders_.seed); }

	/// The biome with the largest weight at a world position (x, z); null if there is none.
	godot::Ref<ScatterBiome> get_biome_at(const godot::Vector2 &p_position);

	/// Returns the weight of each biome at a world position, 0 to 1. If the sum is below 1, the rest belongs to no
	/// biome.
	godot::PackedFloat32Array get_weights_at(const godot::Vector2 &p_position);

	/// Calls `take` with the layers of each biome.
	template <class Take>
	void each_layers(const Take &take) const {
		for (std::size_t index = 0; index < biome_count(); ++index) {
			if (const ScatterBiome *here = biome(index)) {
				take(here->get_layers());
			}
		}
	}

	/// Adds the resources that the main thread reads along with the map, except for the layers of its biomes.
	void add_used(SceneUse::List &r_used) const;

	/// True if a script has changed one of the shared arrays since the last `notice`.
	bool differs() const;

	/// Reads the shared arrays. If they have changed, emits `changed`, which runs scripts.
	void notice();

	/// Returns the map for the current image and biomes, never null. Returns the same object until the map changes. If
	/// the image or the biomes are refused, prints one error and returns the last valid map.
	const std::shared_ptr<const BiomeMap> &map();

	/// The density of a layer in each biome; 0 for biomes that do not contain it.
	PerBiome<float> densities_of(const godot::Ref<ScatterLayer> &p_layer) const;

	/// The water level in each biome. `node_level` is the water level of the node (world meters or no_water).
	PerBiome<double> water_levels(double node_level) const;

	/// True if a biome has water at its own level.
	bool has_own_water() const;

	/// The feature that cannot work because an export has stripped its resource; empty if nothing was stripped.
	godot::String stripped_problem() const;

	/// Likely mistakes, for the editor's warnings. `p_own` are the layers of the node itself.
	godot::PackedStringArray problems(const godot::TypedArray<ScatterLayer> &p_own);

protected:
	static void _bind_methods();

private:
	/// A biome with its layers, as last seen.
	struct Seen {
		godot::Ref<ScatterBiome> biome;
		std::vector<godot::Ref<ScatterLayer>> layers;

		friend bool operator==(const Seen &, const Seen &) = default;
	};

	static void bind_map();
	static void bind_borders();
	static Seen look_at(const godot::Variant &p_biome);
	void set_border(const char *p_name, double BiomeBorders::*number, double p_value);
	void watch_biomes(bool p_watch);
	void outdate();
	void image_changed();
	void refresh();
	void add_color_problems(godot::PackedStringArray &r_problems) const;
	void add_layer_problems(const godot::TypedArray<ScatterLayer> &p_own, godot::PackedStringArray &r_problems) const;
	Status make(BiomeMap &r_map);
	std::vector<BiomeColor> colors() const;
	const ScatterBiome *biome(std::size_t index) const;
	std::size_t biome_count() const;

	godot::TypedArray<ScatterBiome> biomes_;
	std::vector<Seen> seen_;
	godot::Ref<godot::Resource> image_; ///< An Image or a Texture2D.
	godot::Rect2 rect_{0.0F, 0.0F, 1000.0F, 1000.0F};
	BiomePixels mode_ = BiomePixels::colors;
	BiomeEdge edge_ = BiomeEdge::clamp;
	BiomeBorders borders_{.width = 8.0, .noise = 12.0, .noise_size = 60.0};

	std::shared_ptr<const BiomeMap> map_ = std::make_shared<const BiomeMap>();
	ColorPixels pixels_;        ///< The pixels of the image, as last read.
	bool pixels_unread_ = true; ///< True if they may have changed. Reading them back makes the renderer wait.
	bool outdated_ = true;      ///< True if `map_` does not match the properties.
	Status status_;             ///< The error of the properties.
	godot::String complaint_;   ///< The last printed error; empty if there is none.
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterBiomeMap::MapMode)
VARIANT_ENUM_CAST(thicket::ScatterBiomeMap::MapEdge)
