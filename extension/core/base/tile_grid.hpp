#pragma once

#include "core/base/rect.hpp"

#include <glm/vec2.hpp>

#include <cstdint>

namespace thicket {

/// Tile coordinates stay within +-max_tile_coordinate, so that they and their neighbors fit an int.
inline constexpr std::int32_t max_tile_coordinate = 1 << 30;

/// A rectangle of tiles, both ends included.
struct TileRange {
	glm::ivec2 first{0};
	glm::ivec2 last{-1};

	bool empty() const { return first.x > last.x || first.y > last.y; }

	/// A double: an integer may be too small for it.
	double count() const { return empty() ? 0.0 : (1.0 + last.x - first.x) * (1.0 + last.y - first.y); }

	friend bool operator==(const TileRange &, const TileRange &) = default;
};

/// The tile that a position lies in: rounds down, so tile -1 ends where tile 0 begins. `tile_size` is meters, above 0,
/// and `position` is finite; what lies beyond max_tile_coordinate gets the outermost tile.
glm::ivec2 tile_at(double tile_size, glm::dvec2 position);

/// The half-open square of a tile. Neighbors share their edges to the bit, so their tiles share no point and leave
/// none out.
Rect tile_rect(double tile_size, glm::ivec2 tile);

/// The tiles that have points of a half-open rectangle, none for an empty one. A tile that only shares an edge with the end of the rectangle is not
/// among them. `rect` is finite; what lies beyond max_tile_coordinate gets the outermost tiles.
TileRange tiles_in(double tile_size, const Rect &rect);

/// The square of the distance from a position to the nearest point of a rectangle; 0 inside. Meters squared.
double distance_squared(const Rect &rect, glm::dvec2 position);

} // namespace thicket
