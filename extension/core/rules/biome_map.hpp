#pragma once

#include "core/base/planet.hpp"
#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/rules/clump_noise.hpp"
#include "core/rules/planet_cap.hpp"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// Maximum number of biomes in a map. A biome's index identifies it.
inline constexpr std::size_t max_biomes = 32;
inline constexpr std::uint8_t no_biome = 63;         ///< The index that means no biome.
inline constexpr int max_biome_map_pixels = 1 << 13; ///< Maximum width and height of a map.

/// A value for each biome, by index, and for no_biome.
template <class T>
using PerBiome = std::array<T, 64>;

/// A set of biomes: bit i represents biome i, and the last bit represents no_biome.
using BiomeSet = std::uint64_t;

constexpr BiomeSet biome_bit(std::uint8_t biome) { return BiomeSet{1} << (biome & 63U); }

/// The biome at positions outside the image.
enum class BiomeEdge : std::uint8_t {
	nothing, ///< no_biome applies outside.
	clamp,   ///< The biome of the nearest pixel applies.
};

/// The shape and softness of the borders between biomes. The same values apply to all borders of a
/// map.
struct BiomeBorders {
	/// Width in meters of the zone in which two biomes mix: 0 (sharp) to max_border_width.
	double width = 0.0;
	double noise = 0.0; ///< Maximum displacement of a border along each axis in meters, 0 to max_border_noise.
	/// Average distance between bends in meters, min_border_noise_size to max_border_noise_size.
	double noise_size = 40.0;
	std::uint64_t seed = 0; ///< Seed of the noise that bends the borders.

	friend bool operator==(const BiomeBorders &, const BiomeBorders &) = default;
};

inline constexpr double max_border_width = 1e4;
inline constexpr double max_border_noise = 1e4;
inline constexpr double min_border_noise_size = 1.0;
inline constexpr double max_border_noise_size = 1e5;

/// Returns an error for values that are not finite or outside the ranges above.
Status validate(const BiomeBorders &borders);

/// Number of taps. A tap is a position near a queried position at which the map is sampled. A
/// biome's weight is the fraction of the taps that lie in it, so the weights of all biomes and
/// no_biome add up to 1.
inline constexpr std::size_t biome_taps = 16;
using BiomeTaps = std::array<std::uint8_t, biome_taps>;

/// The biome at every position: an image of biome indices over a rectangle of the world, with
/// softened and bent borders. A pure function of the position, bit-identical on all platforms. The
/// map is immutable after `set`, so threads may share it.
class BiomeMap {
public:
	/// Creates a map without biomes.
	BiomeMap() = default;

	/// Sets the image and the borders. `pixels` are in row order, x fastest; each is below
	/// max_biomes or is no_biome. `area` is in world meters, finite and not empty. `size` is 1 to
	/// max_biome_map_pixels on both axes. Any other value is an error and leaves the map unchanged.
	Status set(glm::ivec2 size, std::span<const std::uint8_t> pixels, const Rect &area, BiomeEdge edge,
			const BiomeBorders &borders);

	/// Writes the biome at each tap around `position`. If `position` is not finite, all taps are
	/// no_biome.
	void taps_at(glm::dvec2 position, BiomeTaps &r_taps) const;

	/// Returns the biome with the greatest weight. In a tie, the result is the biome with the
	/// lowest index.
	std::uint8_t dominant_at(glm::dvec2 position) const;

	// On a planet, the image covers the whole sphere (see sphere_image_position), and the rectangle and
	// the edge have no effect. The borders are as wide and as bent on every side.

	/// Like `taps_at`, for a position relative to the center of a planet, of which only the direction
	/// matters.
	void taps_toward(double planet_radius, const glm::dvec3 &from_center, BiomeTaps &r_taps) const;

	/// Like `dominant_at`, on a planet.
	std::uint8_t dominant_toward(double planet_radius, const glm::dvec3 &from_center) const;

	/// Returns every biome with a weight above 0 in any direction of a cap. The set may contain a few
	/// more biomes.
	BiomeSet biomes_toward(double planet_radius, const PlanetCap &cap) const;

	/// Returns every biome with a weight above 0 anywhere in `rect`, edges included. The set may
	/// contain a few more biomes. For an inverted or infinite rectangle, it contains all biomes of
	/// the map.
	BiomeSet biomes_in(const Rect &rect) const;

	/// Compares a per-biome value on this map with the same value on the map `before`. Appends at
	/// most find_grid * find_grid rectangles that cover all changed pixels; outside them, the value
	/// is unchanged. On a planet, these are the rectangles of shadow_of. If the maps differ in size, area, edge or borders, the value may differ
	/// anywhere. The function then returns false and appends nothing.
	template <class T>
	bool find_edits(const BiomeMap &before, const PerBiome<T> &value_before, const PerBiome<T> &value,
			std::vector<Rect> &r_areas, const Planet &planet = {}) const;

	static constexpr int find_grid = 16;

	friend bool operator==(const BiomeMap &, const BiomeMap &);

private:
	/// For each biome of the old map, the biomes of this map with the same value.
	using SameValue = PerBiome<BiomeSet>;

	/// A range of pixels. `max` is exclusive.
	struct Pixels {
		glm::ivec2 min{0};
		glm::ivec2 max{0};
	};

	bool same_frame(const BiomeMap &other) const;
	bool find_edits(
			const BiomeMap &before, const SameValue &same, std::vector<Rect> &r_areas, const Planet &planet) const;
	Pixels edited_pixels(const BiomeMap &before, const SameValue &same, const Pixels &search_area) const;
	bool block_differs(const BiomeMap &before, const SameValue &same, glm::ivec2 block) const;
	Rect reached_from(const Pixels &pixels) const;
	PlanetCap cap_reached_from(double planet_radius, const Pixels &pixels) const;
	double reach_on_planet() const;
	BiomeSet biomes_in_blocks(const Pixels &pixels) const;
	std::uint8_t pixel_toward(const glm::dvec3 &from_center) const;
	glm::dvec3 bend(const glm::dvec3 &position) const;
	std::uint8_t pixel_at(glm::dvec2 position) const;
	std::uint8_t pixel(int x, int y) const {
		return pixels_[static_cast<std::size_t>(y) * width() + static_cast<std::size_t>(x)];
	}
	std::size_t width() const { return static_cast<std::size_t>(size_.x); }
	glm::ivec2 block_count() const;
	void find_blocks();
	template <class Position>
	double border_offset(const Position &position, std::size_t axis) const;

	glm::ivec2 size_{1};
	std::vector<std::uint8_t> pixels_{no_biome};
	Rect area_{{0.0, 0.0}, {1.0, 1.0}};
	BiomeEdge edge_ = BiomeEdge::nothing;
	BiomeBorders borders_;
	/// Distance in meters, per axis, from a position to the farthest pixel that may affect it.
	double reach_ = 0.0;
	/// One coarse and one fine noise per axis. Only planets use the third axis.
	std::array<ClumpNoise, 6> noise_{};
	std::vector<BiomeSet> blocks_{biome_bit(no_biome)}; ///< The biomes in each block of pixels, row by row.
};

/// Returns the displacement of the border along an axis, from -1 to 1.
template <class Position>
double BiomeMap::border_offset(const Position &position, std::size_t axis) const {
	constexpr double large_share = 0.7;
	const double large = noise_[2 * axis].at(position);
	const double small = noise_[2 * axis + 1].at(position);
	return 2.0 * (large_share * large + (1.0 - large_share) * small) - 1.0;
}

/// Returns the index with the greatest number of taps.
std::uint8_t dominant_of(const BiomeTaps &taps);

template <class T>
bool BiomeMap::find_edits(const BiomeMap &before, const PerBiome<T> &value_before, const PerBiome<T> &value,
		std::vector<Rect> &r_areas, const Planet &planet) const {
	SameValue same{};
	for (std::size_t was = 0; was < same.size(); ++was) {
		for (std::size_t is = 0; is < same.size(); ++is) {
			same[was] |= value_before[was] == value[is] ? biome_bit(static_cast<std::uint8_t>(is)) : 0;
		}
	}
	return find_edits(before, same, r_areas, planet);
}

} // namespace thicket
