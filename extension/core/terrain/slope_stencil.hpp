#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <span>

namespace thicket {

/// Computes the slope at a position by central differences, for ground sources that return only
/// heights and take positions as floats. All coordinates are rounded to floats, so height
/// differences are divided by the exact distance between the queried positions. Far from the
/// origin, where floats are coarse, the positions are farther apart so that slopes stay correct.
class SlopeStencil {
public:
	/// Chooses the positions around `position`, which is in world meters and must be finite.
	explicit SlopeStencil(glm::dvec2 position);

	/// Returns the position itself, rounded to floats. `normal` needs its height if a neighbor has
	/// none.
	glm::dvec2 center() const { return center_; }

	/// Returns the positions whose heights are needed: before and after the center along x, then
	/// along z. Up to 10^6 m from the origin, they are 0.5 m away from the center.
	const std::array<glm::dvec2, 4> &positions() const { return positions_; }

	/// Returns the unit normal, y up, from the height at the center and the heights at positions(),
	/// in the same order. If a neighbor's height is not finite, the difference is one-sided. If
	/// neither neighbor on an axis has a finite height, the slope along that axis is 0.
	glm::vec3 normal(float here, std::span<const float, 4> around) const;

private:
	glm::dvec2 center_;
	std::array<glm::dvec2, 4> positions_;
};

} // namespace thicket
