#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstdint>

namespace thicket {

/// An instance as it is placed in the world.
struct PlacedInstance {
	std::uint64_t id = 0;
	std::uint32_t layer = 0; ///< Index in the query's list of layers, not the layer of the ID.
	std::uint32_t mesh = 0;
	glm::dvec3 position{0.0}; ///< Position of the instance in world meters.
	glm::mat3 basis{1.0f};    ///< Rotation and scale of the instance.
};

} // namespace thicket
