#include "core/rules/planet_mask.hpp"

#include "core/base/floating_point.hpp"

#include <algorithm>
#include <cmath>

namespace thicket {

Status PlanetMask::sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const {
	if (positions.size() != r_density.size()) {
		return Status::wrong_size("density", r_density.size(), exactly(positions.size()));
	}
	for (std::size_t i = 0; i < positions.size(); ++i) {
		const glm::dvec2 from = positions[i] - glm::dvec2(planet_.center.x, planet_.center.z);
		const double height = planet_.radius * planet_.radius - (from.x * from.x + from.y * from.y);
		r_density[i] = static_cast<float>(image_->toward({from.x, std::sqrt(std::max(height, 0.0)), from.y}));
	}
	return {};
}

Status PlanetMask::sample_in_space(
		std::span<const glm::dvec2> positions, std::span<const float> heights, std::span<float> r_density) const {
	if (positions.size() != r_density.size() || positions.size() != heights.size()) {
		return Status::wrong_size("density", r_density.size(), exactly(positions.size()));
	}
	for (std::size_t i = 0; i < positions.size(); ++i) {
		const glm::dvec3 position(positions[i].x, double{heights[i]}, positions[i].y);
		r_density[i] = static_cast<float>(image_->toward(position - planet_.center));
	}
	return {};
}

} // namespace thicket
