#pragma once

#include "core/base/rect.hpp"
#include "core/rules/biome_map.hpp"
#include "core/rules/density_field.hpp"

#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The weight of those biomes that a layer belongs to, as a density: at each place the sum over all biomes of the biome's weight
/// there times the layer's density in it.
class BiomeDensity final : public DensityField {
public:
	/// `map` is not null; `densities` are 0 to 1.
	BiomeDensity(std::shared_ptr<const BiomeMap> map, const PerBiome<float> &densities);

	/// 0 for a position that is not finite, unless no biome at all has a density.
	Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override;

	/// True if the density is certainly 0 in all of `rect`, so that nothing has to be looked for there.
	bool none_in(const Rect &rect) const { return (map_->biomes_in(rect) & open_) == 0; }

	/// As BiomeMap::find_edits.
	bool find_edits(const BiomeDensity &before, std::vector<Rect> &r_areas) const {
		return map_->find_edits(*before.map_, before.densities_, densities_, r_areas);
	}

	/// The same map and the same densities: the same everywhere.
	friend bool operator==(const BiomeDensity &a, const BiomeDensity &b) {
		return a.map_ == b.map_ && a.densities_ == b.densities_;
	}

private:
	std::shared_ptr<const BiomeMap> map_;
	PerBiome<float> densities_;
	BiomeSet open_ = 0; ///< Those with a density above 0.
};

/// Where no water is: as far below any ground as can be.
inline constexpr double no_water = -std::numeric_limits<double>::infinity();

/// The height of the water's surface at each place, whether or not the ground there lies below it.
class WaterLevels {
public:
	/// The same level everywhere: world meters, finite or no_water.
	explicit WaterLevels(double level) { levels_.fill(level); }

	/// A level for each biome, which holds where the biome has the greatest weight, and one where no biome has. `map` is not
	/// null.
	WaterLevels(std::shared_ptr<const BiomeMap> map, const PerBiome<double> &levels);

	/// World meters, or no_water.
	double at(glm::dvec2 position) const;

	/// As BiomeMap::find_edits.
	bool find_edits(const WaterLevels &before, std::vector<Rect> &r_areas) const;

	friend bool operator==(const WaterLevels &, const WaterLevels &) = default;

private:
	std::shared_ptr<const BiomeMap> map_; ///< Null where all levels are the same.
	PerBiome<double> levels_{};
};

/// Appends the rectangles outside which nothing has changed between two of them, null for none, for edits of the one or the other.
/// False, with nothing appended, where anything may have.
template <class Values>
bool find_biome_edits(const Values *before, const Values *after, std::vector<Rect> &r_areas) {
	if (before == after) {
		// Fast path: one object on both sides has no edits.
		return true;
	}
	return before != nullptr && after != nullptr && after->find_edits(*before, r_areas);
}

} // namespace thicket
