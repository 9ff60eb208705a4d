#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <span>

namespace thicket {

/// The slope at a position by central differences, for ground sources that return only heights and that take positions as floats. All
/// coordinates are floats, so a height difference is divided by the exact distance between the queried positions. Far from the origin,
/// where floats are more than a millimeter apart, the positions move apart as far as necessary, and slopes stay correct.
class SlopeStencil {
public:
	/// World meters, finite.
	explicit SlopeStencil(glm::dvec2 position);

	/// The position itself, rounded to floats. Its height is needed where a neighbor has none.
	glm::dvec2 center() const { return center_; }

	/// The positions whose heights are needed: before and behind the position along x, then along z. Up to 10^6 m from
	/// the origin, these positions are 0.5 m away.
	const std::array<glm::dvec2, 4> &positions() const { return positions_; }

	/// The unit normal, y up, from the height at the center and the heights at the positions, in their order. One-sided where a
	/// neighbor's height is not finite. Level along an axis on which both are missing.
	glm::vec3 normal(float here, std::span<const float, 4> around) const;

private:
	glm::dvec2 center_;
	std::array<glm::dvec2, 4> positions_;
};

} // namespace thicket
