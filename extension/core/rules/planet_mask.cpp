#include "core/rules/planet_mask.hpp"

#include "core/base/floating_point.hpp"
#include "core/rules/planet_positions.hpp"

namespace thicket {

Status PlanetMask::sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const {
	if (positions.size() != r_density.size()) {
		return Status::wrong_size("density", r_density.size(), exactly(positions.size()));
	}
	sample_batch({positions}, r_density);
	return {};
}

Status PlanetMask::sample_in_space(
		std::span<const glm::dvec2> positions, std::span<const float> heights, std::span<float> r_density) const {
	if (positions.size() != r_density.size() || positions.size() != heights.size()) {
		return Status::wrong_size("density", r_density.size(), exactly(positions.size()));
	}
	sample_batch({positions, heights}, r_density);
	return {};
}

void PlanetMask::sample_batch(const PositionBatch &batch, std::span<float> r_density) const {
	for (std::size_t i = 0; i < batch.positions.size(); ++i) {
		r_density[i] = static_cast<float>(image_->toward(from_planet_center(planet_, batch, i)));
	}
}

} // namespace thicket
