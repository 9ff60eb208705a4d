#pragma once

#include <glm/vec2.hpp>

#include <cstddef>
#include <limits>

namespace thicket {

/// A position of the world, in meters, and the height that the ground had there.
struct GroundProbe {
	glm::dvec2 position{0.0};
	float height = std::numeric_limits<float>::quiet_NaN(); ///< Meters; NAN for no ground.
};

/// The most probes that are kept of a tile.
inline constexpr std::size_t max_ground_probes = 64;

} // namespace thicket
