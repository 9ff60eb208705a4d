#include "core/terrain/flat_terrain.hpp"

#include <cmath>

namespace thicket {

Status FlatTerrain::sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	for (std::size_t i = 0; i < positions.size(); ++i) {
		const bool somewhere = std::isfinite(positions[i].x) && std::isfinite(positions[i].y);
		r_ground[i] = somewhere ? Ground{height_, {0.0f, 1.0f, 0.0f}} : Ground{};
	}
	return {};
}

} // namespace thicket
