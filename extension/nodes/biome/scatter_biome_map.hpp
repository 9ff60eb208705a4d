#pragma once

#include "core/rules/biome_rules.hpp"
#include "nodes/biome/biome_image.hpp"
#include "nodes/biome/scatter_biome.hpp"

#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/vector2.hpp>
#include <godot_cpp/variant/vector2i.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// A list of biomes and an image that defines the area of each. This is the Godot resource for
/// BiomeMap. Several nodes may share one.
///
/// Emits `changed` when a setter changes it, and when its image or one of its biomes emits
/// `changed`. Scripts share the array of biomes and the biomes' arrays of layers. If they modify an
/// array in place, the change takes effect at the next `detect_changes`.
class ScatterBiomeMap : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterBiomeMap, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterBiomeMap";

	/// The values of BiomePixels, for scripts.
	enum MapMode : std::int64_t {
		MAP_MODE_COLORS,
		MAP_MODE_INDICES,
	};

	/// The values of BiomeEdge, for scripts.
	enum MapEdge : std::int64_t {
		MAP_EDGE_NOTHING,
		MAP_EDGE_CLAMP,
	};

	/// Sets the biomes, at most max_biomes. A null entry means no biome, but keeps its index.
	void set_biomes(const godot::TypedArray<ScatterBiome> &p_biomes);
	godot::TypedArray<ScatterBiome> get_biomes() const { return biomes_; }

	/// Sets the map's image: an Image or a Texture2D. Rereads its pixels even if it is the same
	/// object. Without an image, the first biome covers the whole world.
	void set_map_image(const godot::Ref<godot::Resource> &p_image);
	godot::Ref<godot::Resource> get_map_image() const { return image_; }

	/// Replaces a texture with its image, because a dedicated server export strips textures.
	/// Returns false if there is no texture with pixels.
	bool embed_stripped_data();

	/// Sets the area that the image covers, in world meters; its y is the world's z. Positions are
	/// within +-1e9, sizes from 0.001 to 1e9.
	void set_map_rect(const godot::Rect2 &p_rect);
	godot::Rect2 get_map_rect() const { return rect_; }

	/// Sets how pixels encode biomes; see BiomePixels.
	void set_map_mode(MapMode p_mode);
	MapMode get_map_mode() const { return static_cast<MapMode>(mode_); }

	/// Sets how the map continues outside its image; see BiomeEdge.
	void set_map_edge(MapEdge p_edge);
	MapEdge get_map_edge() const { return static_cast<MapEdge>(edge_); }

	// These properties belong to BiomeBorders, which describes them.
	void set_border_width(double p_width) { set_border("border_width", &BiomeBorders::width, p_width); }
	double get_border_width() const { return borders_.width; }
	void set_border_noise(double p_noise) { set_border("border_noise", &BiomeBorders::noise, p_noise); }
	double get_border_noise() const { return borders_.noise; }
	void set_border_noise_size(double p_size) { set_border("border_noise_size", &BiomeBorders::noise_size, p_size); }
	double get_border_noise_size() const { return borders_.noise_size; }
	void set_border_seed(int64_t p_seed);
	int64_t get_border_seed() const { return static_cast<int64_t>(borders_.seed); }

	/// Returns the biome with the largest weight at a world position (x, z). Returns null where
	/// areas without a biome have the largest weight.
	godot::Ref<ScatterBiome> get_biome_at(const godot::Vector2 &p_position);

	/// Returns the weight of each biome at a world position (x, z), 0 to 1. If the sum is below 1,
	/// the remainder has no biome.
	godot::PackedFloat32Array get_weights_at(const godot::Vector2 &p_position);

	// On a planet, the image covers the whole sphere. Positions are relative to the planet's center in
	// meters, and only their direction matters.

	/// Like `get_biome_at`, on a planet.
	godot::Ref<ScatterBiome> get_biome_on_planet(double p_planet_radius, const godot::Vector3 &p_from_center);

	/// Like `get_weights_at`, on a planet.
	godot::PackedFloat32Array get_weights_on_planet(double p_planet_radius, const godot::Vector3 &p_from_center);

	/// Used by the editor's brush. Returns the pixels of an image of `p_size` within a distance of a
	/// position on a planet: the column, the row and the number of columns of each run of pixels.
	godot::PackedInt32Array planet_disc(double p_planet_radius, const godot::Vector3 &p_from_center, double p_radius,
			const godot::Vector2i &p_size) const;

	/// Calls `visit` with the array of layers of each biome.
	template <class Take>
	void each_layers(const Take &visit) const {
		for (std::size_t index = 0; index < biome_count(); ++index) {
			if (const ScatterBiome *entry = biome(index)) {
				visit(entry->get_layers());
			}
		}
	}

	/// Adds the biomes to `r_used`, because the main thread reads them along with the map. Does not
	/// add their layers.
	void add_used(SceneUse::List &r_used) const;

	/// Returns true if one of the shared arrays has changed since it was last read.
	bool differs() const;

	/// Rereads the shared arrays if they have changed, and emits `changed`, which may run scripts.
	void detect_changes();

	/// Returns the map for the current image and biomes, never null. Returns the same object until
	/// the map changes. If the current settings are invalid, prints an error once and returns the
	/// last valid map.
	const std::shared_ptr<const BiomeMap> &map();

	/// Returns the density factor of a layer in each biome; 0 for biomes that do not list the
	/// layer.
	PerBiome<float> densities_of(const godot::Ref<ScatterLayer> &p_layer) const;

	/// Returns 1 for each biome that an input of an expression refers to, by its name or its index,
	/// and 0 for the others.
	PerBiome<float> weights_for(const WorldInput &input) const;

	/// Returns the water level in each biome, in world meters or no_water. `node_level` is the
	/// level of the node, which biomes may inherit.
	PerBiome<double> water_levels(double node_level) const;

	/// Returns true if any biome has its own water level.
	bool has_own_water() const;

	/// Returns a warning about the missing biomes if an export has stripped the image; otherwise an
	/// empty string.
	godot::String stripped_problem() const;

	/// Returns a message for each likely mistake, for the editor's warnings. `p_node_layers`
	/// contains the layers of the node's list.
	godot::PackedStringArray problems(const godot::TypedArray<ScatterLayer> &p_node_layers);

protected:
	static void _bind_methods();

private:
	/// A biome and its layers when they were last read.
	struct WatchedBiome {
		godot::Ref<ScatterBiome> biome;
		std::vector<godot::Ref<ScatterLayer>> layers;

		friend bool operator==(const WatchedBiome &, const WatchedBiome &) = default;
	};

	static void bind_map();
	static void bind_planets();
	godot::PackedFloat32Array weights_of(const BiomeTaps &taps) const;
	static void bind_borders();
	static WatchedBiome read_biome(const godot::Variant &p_biome);
	void set_border(const char *p_name, double BiomeBorders::*p_member, double p_value);
	void watch_biomes(bool p_watch);
	void mark_outdated();
	void image_changed();
	void refresh();
	void add_color_problems(godot::PackedStringArray &r_problems) const;
	void add_layer_problems(
			const godot::TypedArray<ScatterLayer> &p_node_layers, godot::PackedStringArray &r_problems) const;
	Status make(BiomeMap &r_map);
	std::vector<BiomeColor> colors() const;
	const ScatterBiome *biome(std::size_t index) const;
	std::size_t biome_count() const;

	godot::TypedArray<ScatterBiome> biomes_;
	std::vector<WatchedBiome> watched_biomes_;
	godot::Ref<godot::Resource> image_; ///< An Image or a Texture2D.
	godot::Rect2 rect_{0.0F, 0.0F, 1000.0F, 1000.0F};
	BiomePixels mode_ = BiomePixels::colors;
	BiomeEdge edge_ = BiomeEdge::clamp;
	BiomeBorders borders_{.width = 8.0, .noise = 12.0, .noise_size = 60.0};

	std::shared_ptr<const BiomeMap> map_ = std::make_shared<const BiomeMap>();
	ColorPixels pixels_; ///< The pixels of the image when it was last read.
	/// True if `pixels_` may be outdated. Avoids rereading, because reading back a texture stalls
	/// the renderer.
	bool must_read_pixels_ = true;
	bool is_outdated_ = true;  ///< True if `map_` does not match the properties.
	Status status_;            ///< The result of building the map from the current properties.
	godot::String last_error_; ///< The last printed error; empty after a success.
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterBiomeMap::MapMode)
VARIANT_ENUM_CAST(thicket::ScatterBiomeMap::MapEdge)
