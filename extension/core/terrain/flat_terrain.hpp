#pragma once

#include "core/terrain/terrain.hpp"

namespace thicket {

/// Unbounded terrain with the same height everywhere.
class FlatTerrain final : public Terrain {
public:
	FlatTerrain() = default;

	/// `height` is in world meters. NAN makes a world without ground.
	explicit FlatTerrain(float height) : height_(height) {}

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

private:
	float height_ = 0.0f;
};

} // namespace thicket
