#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/rules/clump_noise.hpp"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

inline constexpr std::size_t max_biomes = 32;        ///< Per map. A biome is identified by its index.
inline constexpr std::uint8_t no_biome = 63;         ///< The index for "no biome".
inline constexpr int max_biome_map_pixels = 1 << 13; ///< On each side.

/// A value for each biome, by index, and for no_biome.
template <class T>
using PerBiome = std::array<T, 64>;

/// A set of biomes: bit i represents biome i, and the last bit represents no_biome.
using BiomeSet = std::uint64_t;

constexpr BiomeSet biome_bit(std::uint8_t biome) { return BiomeSet{1} << (biome & 63U); }

/// How a map continues outside its image.
enum class BiomeEdge : std::uint8_t {
	nothing, ///< No biome.
	clamp,   ///< The biome of the nearest pixel.
};

/// How biomes meet. Applies to all borders of a map.
struct BiomeBorders {
	double width = 0.0;       ///< Meters over which two biomes mix: 0 for a sharp line, up to max_border_width.
	double noise = 0.0;       ///< Maximum displacement of a border along each axis in meters, 0 to max_border_noise.
	double noise_size = 40.0; ///< Average distance between bends of a border in meters; min to max_border_noise_size.
	std::uint64_t seed = 0;   ///< Seed of the bends.

	friend bool operator==(const BiomeBorders &, const BiomeBorders &) = default;
};

inline constexpr double max_border_width = 1e4;
inline constexpr double max_border_noise = 1e4;
inline constexpr double min_border_noise_size = 1.0;
inline constexpr double max_border_noise_size = 1e5;

/// Refuses values that are not finite or outside the ranges above.
Status validate(const BiomeBorders &borders);

/// The map is read at this many positions around a queried position. The share of them that lie in a biome is the biome's weight there,
/// so the weights of all biomes and of no_biome add up to 1.
inline constexpr std::size_t biome_taps = 16;
using BiomeTaps = std::array<std::uint8_t, biome_taps>;

/// The biome at every position: an image of biome indices over a rectangle of the world, with softened and bent borders. A pure function
/// of the position, bit-identical everywhere. Immutable after `set`, so threads may share one.
class BiomeMap {
public:
	/// A map without biomes.
	BiomeMap() = default;

	/// `pixels` are in row order, x fastest; each is below max_biomes or is no_biome. `area` is in world meters, finite and not empty.
	/// `size` is 1 to max_biome_map_pixels on both axes. Anything else is refused and changes nothing.
	Status set(glm::ivec2 size, std::span<const std::uint8_t> pixels, const Rect &area, BiomeEdge edge,
			const BiomeBorders &borders);

	/// The biomes at the tap positions around a position. All are no_biome if the position is not finite.
	void taps_at(glm::dvec2 position, BiomeTaps &r_taps) const;

	/// The biome with the greatest weight. In a tie, the one with the lower index.
	std::uint8_t dominant_at(glm::dvec2 position) const;

	/// All biomes that may have a weight somewhere in `rect`, edges included, and possibly a few more. Returns all biomes of the map for
	/// an inverted or infinite rectangle.
	BiomeSet biomes_in(const Rect &rect) const;

	/// Appends rectangles outside which a value per biome is unchanged since the map `before`. The rectangles cover the
	/// pixels whose value differs, in at most find_grid squared parts. Returns false and appends nothing if the two
	/// maps cover the world differently, because the value may then differ anywhere.
	template <class T>
	bool find_edits(const BiomeMap &before, const PerBiome<T> &value_before, const PerBiome<T> &value,
			std::vector<Rect> &r_areas) const;

	static constexpr int find_grid = 16;

	friend bool operator==(const BiomeMap &, const BiomeMap &);

private:
	/// For each biome before, the biomes now that have the same value.
	using SameValue = PerBiome<BiomeSet>;

	/// A range of pixels. `max` is exclusive.
	struct Pixels {
		glm::ivec2 min{0};
		glm::ivec2 max{0};
	};

	bool same_frame(const BiomeMap &other) const;
	bool find_edits(const BiomeMap &before, const SameValue &same, std::vector<Rect> &r_areas) const;
	Pixels edited_pixels(const BiomeMap &before, const SameValue &same, const Pixels &among) const;
	bool block_differs(const BiomeMap &before, const SameValue &same, glm::ivec2 block) const;
	Rect reached_from(const Pixels &pixels) const;
	std::uint8_t pixel_at(glm::dvec2 position) const;
	std::uint8_t pixel(int x, int y) const {
		return pixels_[static_cast<std::size_t>(y) * width() + static_cast<std::size_t>(x)];
	}
	std::size_t width() const { return static_cast<std::size_t>(size_.x); }
	glm::ivec2 block_count() const;
	void find_blocks();
	double waver(glm::dvec2 position, std::size_t axis) const;

	glm::ivec2 size_{1};
	std::vector<std::uint8_t> pixels_{no_biome};
	Rect area_{{0.0, 0.0}, {1.0, 1.0}};
	BiomeEdge edge_ = BiomeEdge::nothing;
	BiomeBorders borders_;
	double reach_ = 0.0; ///< Distance on each axis from a position to the farthest pixel that may affect it, in meters.
	std::array<ClumpNoise, 4> noise_{};                 ///< One large and one small noise per axis.
	std::vector<BiomeSet> blocks_{biome_bit(no_biome)}; ///< The biomes in each square of `block` pixels, row by row.
};

template <class T>
bool BiomeMap::find_edits(const BiomeMap &before, const PerBiome<T> &value_before, const PerBiome<T> &value,
		std::vector<Rect> &r_areas) const {
	SameValue same{};
	for (std::size_t was = 0; was < same.size(); ++was) {
		for (std::size_t is = 0; is < same.size(); ++is) {
			same[was] |= value_before[was] == value[is] ? biome_bit(static_cast<std::uint8_t>(is)) : 0;
		}
	}
	return find_edits(before, same, r_areas);
}

} // namespace thicket
