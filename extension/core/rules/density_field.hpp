#pragma once

#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <span>

namespace thicket {

/// A density over the plane: noise, an image, a painted mask. A pure function of the position: asked twice, in whatever
/// batch, on whatever thread, it gives the same bits, or tiles that were made apart would not fit.
class DensityField {
public:
	virtual ~DensityField() = default;

	/// Writes the density at `positions[i]` (world meters, x and z of the engine) to `r_density[i]`; the spans are of equal
	/// length. The caller holds values to [0, 1] and takes NAN for 0. Called from several threads at once.
	virtual Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const = 0;

protected:
	DensityField() = default;
	DensityField(const DensityField &) = default;
	DensityField &operator=(const DensityField &) = default;
	DensityField(DensityField &&) = default;
	DensityField &operator=(DensityField &&) = default;
};

/// What a field says, held to [0, 1]; NAN is 0.
inline double unit_density(float value) { return value > 0.0f ? std::min(double{value}, 1.0) : 0.0; }

} // namespace thicket
