#pragma once

#include "core/base/rect.hpp"

#include <glm/vec2.hpp>

#include <cstdint>

namespace thicket {

/// Tile coordinates stay within +-max_tile_coordinate, so that they and their neighbors fit an int.
inline constexpr std::int32_t max_tile_coordinate = 1 << 30;

/// The tile that a position lies in: rounds down, so tile -1 ends where tile 0 begins. `tile_size` is meters, above 0,
/// and `position` is finite; what lies beyond max_tile_coordinate gets the outermost tile.
glm::ivec2 tile_at(double tile_size, glm::dvec2 position);

/// The half-open square of a tile. Neighbors share their edges to the bit, so their tiles share no point and leave
/// none out.
Rect tile_rect(double tile_size, glm::ivec2 tile);

/// The square of the distance from a position to the nearest point of a rectangle; 0 inside. Meters squared.
double distance_squared(const Rect &rect, glm::dvec2 position);

} // namespace thicket
