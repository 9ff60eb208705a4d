#pragma once

#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <span>

namespace thicket {

/// A density over the plane: noise, an image, a painted mask. Must be a pure function of the position: repeated queries, in any batch and
/// on any thread, return the same bits. Otherwise, separately generated tiles would not fit together.
class DensityField {
public:
	virtual ~DensityField() = default;

	/// Writes the density at `positions[i]` (world meters, x and z of the engine) to `r_density[i]`. The spans have equal length. The
	/// caller clamps values to [0, 1] and treats NAN as 0. Called from several threads concurrently.
	virtual Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const = 0;

protected:
	DensityField() = default;
	DensityField(const DensityField &) = default;
	DensityField &operator=(const DensityField &) = default;
	DensityField(DensityField &&) = default;
	DensityField &operator=(DensityField &&) = default;
};

/// A field's value, clamped to [0, 1]. NAN becomes 0.
inline double unit_density(float value) { return value > 0.0f ? std::min(double{value}, 1.0) : 0.0; }

} // namespace thicket
