#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <vector>

namespace thicket {

/// Values of a grid in row-major order: either 16-bit integers, or floats as in the source.
struct Posts {
	glm::ivec2 count{0};
	std::vector<std::uint16_t> steps; ///< Empty if the values are floats.
	std::vector<float> floats;
	const char *format = ""; ///< The format of the source, such as "16-bit PNG"; a string literal.
};

} // namespace thicket
