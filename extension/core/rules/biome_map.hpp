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

inline constexpr std::size_t max_biomes = 32;        ///< Of one map; a biome is known by its index.
inline constexpr std::uint8_t no_biome = 63;         ///< The index where there is none.
inline constexpr int max_biome_map_pixels = 1 << 13; ///< On a side.

/// A value for each biome by its index, and for no_biome.
template <class T>
using PerBiome = std::array<T, 64>;

/// A set of biomes: bit i stands for biome i, the last bit for no_biome.
using BiomeSet = std::uint64_t;

constexpr BiomeSet biome_bit(std::uint8_t biome) { return BiomeSet{1} << (biome & 63U); }

/// What lies outside the image of a map.
enum class BiomeEdge : std::uint8_t {
	nothing, ///< No biome.
	clamp,   ///< The biome of the nearest pixel.
};

/// How biomes meet, the same for all borders of a map.
struct BiomeBorders {
	double width = 0.0; ///< Meters over which two biomes mix, 0 for a sharp line to max_border_width.
	double noise = 0.0; ///< Meters by which a border is moved at most along each axis, 0 to max_border_noise.
	double noise_size =
			40.0;           ///< Meters from one bend of a border to the next on average; min to max_border_noise_size.
	std::uint64_t seed = 0; ///< Of the bends.

	friend bool operator==(const BiomeBorders &, const BiomeBorders &) = default;
};

inline constexpr double max_border_width = 1e4;
inline constexpr double max_border_noise = 1e4;
inline constexpr double min_border_noise_size = 1.0;
inline constexpr double max_border_noise_size = 1e5;

/// Refuses what is not finite or outside the ranges above.
Status validate(const BiomeBorders &borders);

/// A place is asked at so many positions around it. The share of them that lie in a biome is the biome's weight there, so the
/// weights of all biomes and of no biome add up to 1.
inline constexpr std::size_t biome_taps = 16;
using BiomeTaps = std::array<std::uint8_t, biome_taps>;

/// Which biome lies where: an image of indices, laid over a rectangle of the world, whose borders are softened and bent. A pure
/// function of the position, to the same bits everywhere. Immutable after `set`, so threads may share one.
class BiomeMap {
public:
	/// No biome anywhere.
	BiomeMap() = default;

	/// `pixels` row by row, x fastest: each below max_biomes, or no_biome. `area` in world meters, finite and not empty;
	/// `size` 1 to max_biome_map_pixels on both axes. Anything else is refused and changes nothing.
	Status set(glm::ivec2 size, std::span<const std::uint8_t> pixels, const Rect &area, BiomeEdge edge,
			const BiomeBorders &borders);

	/// The biomes at the positions around one that decide about it; all no_biome for a position that is not finite.
	void taps_at(glm::dvec2 position, BiomeTaps &r_taps) const;

	/// The biome of the greatest weight; of two, the one of the lower index.
	std::uint8_t dominant_at(glm::dvec2 position) const;

	/// All biomes that may have a weight somewhere in `rect`, edges included, and perhaps some more. An inverted or infinite
	/// rectangle gives all that are in the map.
	BiomeSet biomes_in(const Rect &rect) const;

	/// Appends rectangles outside which a value for each biome is the same as it was on the map `before`: those that have to
	/// do with the pixels at which it is another, in at most find_grid squared parts. False, with nothing appended, if the two are not laid
	/// over the world in the same way: then it may differ anywhere.
	template <class T>
	bool find_edits(const BiomeMap &before, const PerBiome<T> &value_before, const PerBiome<T> &value,
			std::vector<Rect> &r_areas) const;

	static constexpr int find_grid = 16;

	friend bool operator==(const BiomeMap &, const BiomeMap &);

private:
	/// For each biome before, the biomes now for which the value is the same.
	using SameValue = PerBiome<BiomeSet>;

	/// Pixels, from the first to the one behind the last.
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
	double reach_ = 0.0; ///< Meters from a position to the farthest pixel that may decide about it, on each axis.
	std::array<ClumpNoise, 4> noise_{};                 ///< A large and a small one for each axis.
	std::vector<BiomeSet> blocks_{biome_bit(no_biome)}; ///< What lies in each square of `block` pixels, row by row.
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
