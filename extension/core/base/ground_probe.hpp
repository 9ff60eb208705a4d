#pragma once

#include <glm/vec2.hpp>

#include <cstddef>
#include <limits>

namespace thicket {

/// A world position in meters, with the ground height that was last queried there. Tiles store
/// probes to detect later whether the ground has changed.
struct GroundProbe {
	glm::dvec2 position{0.0};
	float height = std::numeric_limits<float>::quiet_NaN(); ///< Meters, or NAN if there is no ground.
};

/// Maximum number of probes stored per tile.
inline constexpr std::size_t max_ground_probes = 64;

} // namespace thicket
