#pragma once

#include <glm/vec2.hpp>

#include <cstddef>
#include <limits>

namespace thicket {

/// A world position, in meters, and the height of the ground at that position when it was probed.
struct GroundProbe {
	glm::dvec2 position{0.0};
	float height = std::numeric_limits<float>::quiet_NaN(); ///< Meters; NAN if there is no ground.
};

/// The most probes that are kept for a tile.
inline constexpr std::size_t max_ground_probes = 64;

} // namespace thicket
