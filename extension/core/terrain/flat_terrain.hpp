#pragma once

#include "core/terrain/terrain.hpp"

namespace thicket {

/// Unbounded terrain with the same height everywhere.
class FlatTerrain final : public Terrain {
public:
	FlatTerrain() = default;

	/// Creates a terrain. `height` is in world meters. NAN means that there is no ground anywhere.
	explicit FlatTerrain(float height) : height_(height) {}

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

private:
	float height_ = 0.0f;
};

} // namespace thicket
