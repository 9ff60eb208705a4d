#pragma once

#include "core/base/rect.hpp"
#include "core/rules/biome_map.hpp"
#include "core/rules/density_field.hpp"

#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The weight of a layer's biomes as a density: at each position, the sum over all biomes of the biome's weight there times the layer's
/// density in that biome.
class BiomeDensity final : public DensityField {
public:
	/// `map` is not null. `densities` are 0 to 1.
	BiomeDensity(std::shared_ptr<const BiomeMap> map, const PerBiome<float> &densities);

	/// Returns 0 for a position that is not finite, unless no biome at all has a density.
	Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override;

	/// Whether the density is certainly 0 in all of `rect`, so that it needs no sampling.
	bool none_in(const Rect &rect) const { return (map_->biomes_in(rect) & open_) == 0; }

	/// See BiomeMap::find_edits.
	bool find_edits(const BiomeDensity &before, std::vector<Rect> &r_areas) const {
		return map_->find_edits(*before.map_, before.densities_, densities_, r_areas);
	}

	/// True for the same map object and equal densities.
	friend bool operator==(const BiomeDensity &a, const BiomeDensity &b) {
		return a.map_ == b.map_ && a.densities_ == b.densities_;
	}

private:
	std::shared_ptr<const BiomeMap> map_;
	PerBiome<float> densities_;
	BiomeSet open_ = 0; ///< The biomes with a density above 0.
};

/// The level without water: infinitely far below any ground.
inline constexpr double no_water = -std::numeric_limits<double>::infinity();

/// The height of the water surface at each position, whether or not the ground lies below it.
class WaterLevels {
public:
	/// One level everywhere: world meters, finite or no_water.
	explicit WaterLevels(double level) { levels_.fill(level); }

	/// One level per biome, which applies where that biome has the greatest weight, and one level for no_biome. `map` is not null.
	WaterLevels(std::shared_ptr<const BiomeMap> map, const PerBiome<double> &levels);

	/// World meters, or no_water.
	double at(glm::dvec2 position) const;

	/// See BiomeMap::find_edits.
	bool find_edits(const WaterLevels &before, std::vector<Rect> &r_areas) const;

	friend bool operator==(const WaterLevels &, const WaterLevels &) = default;

private:
	std::shared_ptr<const BiomeMap> map_; ///< Null if all levels are equal.
	PerBiome<double> levels_{};
};

/// Appends the rectangles outside which `before` and `after` are equal. Either may be null if there is none. Works for BiomeDensity and
/// WaterLevels. Returns false and appends nothing if any area may have changed.
template <class Values>
bool find_biome_edits(const Values *before, const Values *after, std::vector<Rect> &r_areas) {
	if (before == after) {
		// The same object on both sides has no edits.
		return true;
	}
	return before != nullptr && after != nullptr && after->find_edits(*before, r_areas);
}

} // namespace thicket
