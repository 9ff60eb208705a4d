#pragma once

#include "core/base/status.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <span>

namespace thicket {

/// Positions at which densities are evaluated, in world meters. They are either all on top of the
/// ground, or all on surfaces. On surfaces, each position has a height.
struct PositionBatch {
	std::span<const glm::dvec2> positions;
	std::span<const float> heights{}; ///< One for each position on surfaces; empty on top of the ground.

	bool in_space() const { return !heights.empty(); }
	glm::dvec3 in_space(std::size_t i) const { return {positions[i].x, double{heights[i]}, positions[i].y}; }
};

/// A density over the plane, such as an image or a painted mask, or in space, such as noise. It
/// must be a pure function of the position: a query returns bit-identical results in any batch and
/// on any thread. Otherwise, separately generated tiles would not match at their borders.
class DensityField {
public:
	virtual ~DensityField() = default;

	/// Writes the density at `positions[i]` (world meters, Godot's x and z) to `r_density[i]`. The
	/// spans have equal length. The caller clamps values to [0, 1] and treats NAN as 0. Several
	/// threads may call the function concurrently.
	virtual Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const = 0;

	/// Like `sample`, for positions on surfaces. `heights[i]` is the world height of `positions[i]`
	/// in meters. By default, the density does not depend on the height.
	virtual Status sample_in_space(std::span<const glm::dvec2> positions,
			[[maybe_unused]] std::span<const float> heights, std::span<float> r_density) const {
		return sample(positions, r_density);
	}

	/// Calls one of the two functions above, depending on `batch`.
	Status sample_at(const PositionBatch &batch, std::span<float> r_density) const {
		return batch.in_space() ? sample_in_space(batch.positions, batch.heights, r_density)
								: sample(batch.positions, r_density);
	}

protected:
	DensityField() = default;
	DensityField(const DensityField &) = default;
	DensityField &operator=(const DensityField &) = default;
	DensityField(DensityField &&) = default;
	DensityField &operator=(DensityField &&) = default;
};

/// Returns a field's value, clamped to [0, 1]. NAN becomes 0.
inline double unit_density(float value) { return value > 0.0f ? std::min(double{value}, 1.0) : 0.0; }

} // namespace thicket
