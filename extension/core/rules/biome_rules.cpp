#include "core/rules/biome_rules.hpp"

#include "core/base/floating_point.hpp"
#include "core/rules/planet_positions.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

/// Returns the smallest rectangle that contains all positions. It is not finite if any position is
/// not.
Rect bounds_of(std::span<const glm::dvec2> positions) {
	Rect bounds{positions.front(), positions.front()};
	for (const glm::dvec2 position : positions) {
		// Unlike std::min, this comparison keeps a NAN.
		bounds.min = {position.x < bounds.min.x || std::isnan(position.x) ? position.x : bounds.min.x,
				position.y < bounds.min.y || std::isnan(position.y) ? position.y : bounds.min.y};
		bounds.max = glm::max(bounds.max, position);
	}
	return bounds;
}

} // namespace

BiomeDensity::BiomeDensity(std::shared_ptr<const BiomeMap> map, const PerBiome<float> &densities) :
		map_(std::move(map)), densities_(densities) {
	for (std::size_t biome = 0; biome < densities_.size(); ++biome) {
		permitted_biomes_ |= densities_[biome] > 0.0F ? biome_bit(static_cast<std::uint8_t>(biome)) : 0;
	}
}

Status BiomeDensity::sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const {
	if (positions.size() != r_density.size()) {
		return Status::wrong_size("density", r_density.size(), exactly(positions.size()));
	}
	if (positions.empty()) {
		return {};
	}
	if (const Rect bounds = bounds_of(positions); bounds.finite()) {
		const BiomeSet nearby_biomes = map_->biomes_in(bounds);
		if ((nearby_biomes & permitted_biomes_) == 0 || std::has_single_bit(nearby_biomes)) {
			// Most tiles lie within one biome, so this case has a fast path.
			std::ranges::fill(r_density, densities_[static_cast<std::size_t>(std::countr_zero(nearby_biomes))]);
			return {};
		}
	}
	for (std::size_t i = 0; i < positions.size(); ++i) {
		BiomeTaps taps{};
		map_->taps_at(positions[i], taps);
		r_density[i] = density_of(taps);
	}
	return {};
}

/// Returns the average density of the taps.
float BiomeDensity::density_of(const BiomeTaps &taps) const {
	double sum = 0.0;
	for (const std::uint8_t biome : taps) {
		sum += double{densities_[biome]};
	}
	return static_cast<float>(sum / static_cast<double>(biome_taps));
}

Status BiomeDensity::sample_on(const Planet &planet, const PositionBatch &batch, std::span<float> r_density) const {
	if (batch.positions.size() != r_density.size()) {
		return Status::wrong_size("density", r_density.size(), exactly(batch.positions.size()));
	}
	for (std::size_t i = 0; i < batch.positions.size(); ++i) {
		BiomeTaps taps{};
		map_->taps_toward(planet.radius, from_planet_center(planet, batch, i), taps);
		r_density[i] = density_of(taps);
	}
	return {};
}

WaterLevels::WaterLevels(std::shared_ptr<const BiomeMap> map, const PerBiome<double> &levels) : levels_(levels) {
	if (std::ranges::all_of(levels, [&levels](double level) { return level == levels.front(); })) {
		// All biomes have the same level, so the map is not needed.
		return;
	}
	map_ = std::move(map);
}

double WaterLevels::at(glm::dvec2 position) const {
	return map_ == nullptr ? levels_.front() : levels_[map_->dominant_at(position)];
}

double WaterLevels::at(const Planet &planet, const glm::dvec3 &position) const {
	return map_ == nullptr ? levels_.front() : levels_[map_->dominant_toward(planet.radius, position - planet.center)];
}

bool WaterLevels::find_edits(const Planet &planet, const WaterLevels &before, std::vector<Rect> &r_areas) const {
	const std::shared_ptr<const BiomeMap> &map = map_ != nullptr ? map_ : before.map_;
	if (map == nullptr) {
		return levels_ == before.levels_;
	}
	// A uniform level can be compared using the map of the other object.
	return map->find_edits(before.map_ != nullptr ? *before.map_ : *map, before.levels_, levels_, r_areas, planet);
}

} // namespace thicket
