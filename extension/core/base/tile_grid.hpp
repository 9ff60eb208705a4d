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

	/// A double, because the count may not fit an integer.
	double count() const { return empty() ? 0.0 : (1.0 + last.x - first.x) * (1.0 + last.y - first.y); }

	friend bool operator==(const TileRange &, const TileRange &) = default;
};

/// The tile that contains a position. Rounds down, so tile -1 ends where tile 0 begins. `tile_size` is in meters and
/// above 0, and `position` is finite. Positions beyond max_tile_coordinate belong to the outermost tile.
glm::ivec2 tile_at(double tile_size, glm::dvec2 position);

/// The half-open square of a tile. Neighbors have bit-identical shared edges, so no point lies in two tiles or in none.
Rect tile_rect(double tile_size, glm::ivec2 tile);

/// The tiles that contain points of a half-open rectangle; none for an empty rectangle. Leaves out a tile that only
/// touches the end of the rectangle. `rect` is finite. Parts beyond max_tile_coordinate belong to the outermost tiles.
TileRange tiles_in(double tile_size, const Rect &rect);

/// The squared distance from a position to the nearest point of a rectangle, in square meters; 0 inside.
double distance_squared(const Rect &rect, glm::dvec2 position);

} // namespace thicket
