#pragma once

#include <glm/vec2.hpp>

namespace thicket {

/// A half-open rectangle of whole pixels. x is the column and y is the row.
struct PixelRect {
	glm::ivec2 min{0};
	glm::ivec2 max{0};

	bool empty() const { return min.x >= max.x || min.y >= max.y; }
	glm::ivec2 size() const { return max - min; }
	friend bool operator==(const PixelRect &, const PixelRect &) = default;
};

} // namespace thicket
