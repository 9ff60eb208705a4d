#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <span>

namespace thicket {

/// The slope at a position by central differences, for sources of ground that give heights and nothing else and that take
/// positions as floats. All coordinates are floats, so what a source is asked for is what the slope is divided by: far
/// from the origin, where floats lie more than a millimeter apart, the positions move apart as far as they must, but no
/// slope comes out wrong.
class SlopeStencil {
public:
	/// World meters, finite.
	explicit SlopeStencil(glm::dvec2 position);

	/// The position itself as a float has it. Its height is wanted where a neighbor has none.
	glm::dvec2 center() const { return center_; }

	/// Where heights are wanted: before and behind the position along x, then along z; 0.5 m from it up to 10^6 m from the
	/// origin.
	const std::array<glm::dvec2, 4> &positions() const { return positions_; }

	/// The unit normal, y up, from the height at the center and at the positions, in their order. One-sided where a
	/// neighbor's height is not finite; level along an axis on which both are missing.
	glm::vec3 normal(float here, std::span<const float, 4> around) const;

private:
	glm::dvec2 center_;
	std::array<glm::dvec2, 4> positions_;
};

} // namespace thicket
