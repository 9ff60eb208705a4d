#pragma once

#include "core/base/planet.hpp"
#include "core/base/rect.hpp"
#include "core/base/tile_grid.hpp"
#include "core/rules/biome_map.hpp"
#include "core/rules/density_field.hpp"

#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// A layer's density by biome. At each position, the density is the average of the layer's
/// densities in the biomes, weighted by the biomes' weights there.
class BiomeDensity final : public DensityField {
public:
	/// Creates the field. `map` must not be null. `densities` are 0 to 1.
	BiomeDensity(std::shared_ptr<const BiomeMap> map, const PerBiome<float> &densities);

	/// At a position that is not finite, returns the density of no_biome.
	Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override;

	/// Like `sample_at`, on a planet.
	Status sample_on(const Planet &planet, const PositionBatch &batch, std::span<float> r_density) const;

	/// Returns true if the density on a planet is 0 everywhere in `space`; see none_in.
	bool none_on(const Planet &planet, const TileSpace &space) const {
		return (map_->biomes_toward(planet.radius, cap_around(planet, space)) & permitted_biomes_) == 0;
	}

	/// Returns true if the density is 0 everywhere in `rect`, so that sampling can be skipped. May
	/// return false even if the density is 0.
	bool none_in(const Rect &rect) const { return (map_->biomes_in(rect) & permitted_biomes_) == 0; }

	/// Finds changes in the density; see BiomeMap::find_edits.
	bool find_edits(const Planet &planet, const BiomeDensity &before, std::vector<Rect> &r_areas) const {
		return map_->find_edits(*before.map_, before.densities_, densities_, r_areas, planet);
	}

	/// The map is compared by address, not by content.
	friend bool operator==(const BiomeDensity &a, const BiomeDensity &b) {
		return a.map_ == b.map_ && a.densities_ == b.densities_;
	}

private:
	float density_of(const BiomeTaps &taps) const;

	std::shared_ptr<const BiomeMap> map_;
	PerBiome<float> densities_;
	BiomeSet permitted_biomes_ = 0; ///< The biomes with a density above 0.
};

/// The water level where there is no water: infinitely far below any ground.
inline constexpr double no_water = -std::numeric_limits<double>::infinity();

/// The height of the water surface at each position, even if the ground is above it.
class WaterLevels {
public:
	/// Creates the same level everywhere. `level` is in world meters, finite or no_water.
	explicit WaterLevels(double level) { levels_.fill(level); }

	/// Creates one level per biome and one for no_biome. Each applies where its biome has the
	/// greatest weight. `map` must not be null.
	WaterLevels(std::shared_ptr<const BiomeMap> map, const PerBiome<double> &levels);

	/// Returns the level in world meters, or no_water.
	double at(glm::dvec2 position) const;

	/// Returns the level at a world position on a planet, as an altitude, or no_water.
	double at(const Planet &planet, const glm::dvec3 &position) const;

	/// Finds changes in the levels; see BiomeMap::find_edits.
	bool find_edits(const Planet &planet, const WaterLevels &before, std::vector<Rect> &r_areas) const;

	friend bool operator==(const WaterLevels &, const WaterLevels &) = default;

private:
	std::shared_ptr<const BiomeMap> map_; ///< Null if all levels are equal.
	PerBiome<double> levels_{};
};

/// Appends rectangles outside which `before` and `after` are equal. `Values` is BiomeDensity or
/// WaterLevels; either pointer may be null. `planet` need not exist. If the values may differ anywhere,
/// the function returns false and appends nothing.
template <class Values>
bool find_biome_edits(const Planet &planet, const Values *before, const Values *after, std::vector<Rect> &r_areas) {
	if (before == after) {
		// The same object on both sides has no edits.
		return true;
	}
	return before != nullptr && after != nullptr && after->find_edits(planet, *before, r_areas);
}

} // namespace thicket
