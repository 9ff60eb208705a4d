#pragma once

#include "core/base/rect.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>

namespace thicket {

/// Tile coordinates are in [-max_tile_coordinate, max_tile_coordinate], so that they and their
/// neighbors fit in an int.
inline constexpr std::int32_t max_tile_coordinate = 1 << 30;

/// A rectangle of tiles, including both ends.
struct TileRange {
	glm::ivec2 first{0};
	glm::ivec2 last{-1};

	bool empty() const { return first.x > last.x || first.y > last.y; }

	/// Returns the number of tiles, as a double, because it may not fit in an integer.
	double count() const { return empty() ? 0.0 : (1.0 + last.x - first.x) * (1.0 + last.y - first.y); }

	friend bool operator==(const TileRange &, const TileRange &) = default;
};

/// Returns the tile that contains a position. Coordinates are rounded down, so tile -1 ends where
/// tile 0 begins. `tile_size` must be above 0, in meters, and `position` must be finite. Positions
/// beyond max_tile_coordinate belong to the outermost tile.
glm::ivec2 tile_at(double tile_size, glm::dvec2 position);

/// Returns the half-open square of a tile. The shared edges of neighbors are bit-identical, so
/// every point lies in exactly one tile.
Rect tile_rect(double tile_size, glm::ivec2 tile);

/// The half-open part of space that a tile covers: a rectangle of the map, and a range of world y
/// in meters. The tiles of layers on planets are cubes. All other tiles cover all heights.
struct TileSpace : Rect {
	double bottom = -std::numeric_limits<double>::infinity();
	double top = std::numeric_limits<double>::infinity();

	TileSpace() = default;
	/// Converts a rectangle to a space that covers all heights.
	constexpr TileSpace(const Rect &rect) : Rect(rect) {} // NOLINT(google-explicit-constructor)
	constexpr TileSpace(glm::dvec2 p_min, glm::dvec2 p_max) : Rect{p_min, p_max} {}
	constexpr TileSpace(const Rect &rect, double p_bottom, double p_top) : Rect(rect), bottom(p_bottom), top(p_top) {}

	constexpr bool covers_all_heights() const {
		return bottom == -std::numeric_limits<double>::infinity() && top == std::numeric_limits<double>::infinity();
	}
	constexpr bool contains_height(double y) const { return bottom <= y && y < top; }

	/// Returns the space extended by `margin` meters on all sides.
	TileSpace grown(double margin) const { return {{min - margin, max + margin}, bottom - margin, top + margin}; }
};

/// The slab number of a tile that covers all heights.
inline constexpr std::int32_t all_slabs = std::numeric_limits<std::int32_t>::min();

/// Returns the space of a tile. The cubes in a column of the map are numbered by slab: slab s
/// covers the heights from s * tile_size to (s + 1) * tile_size. The shared faces of neighbors are
/// bit-identical.
TileSpace tile_space(double tile_size, glm::ivec2 tile, std::int32_t slab = all_slabs);

/// Returns the slab that contains a height. The conditions of tile_at() apply.
std::int32_t slab_at(double tile_size, double height);

/// Returns the tiles that overlap a half-open rectangle, or an empty range for an empty rectangle.
/// Tiles that only touch the end of the rectangle are excluded. `rect` must be finite. Parts beyond
/// max_tile_coordinate belong to the outermost tiles.
TileRange tiles_in(double tile_size, const Rect &rect);

/// Returns the squared distance from a position to the nearest point of a rectangle, in square
/// meters. Returns 0 if the position lies inside.
double distance_squared(const Rect &rect, glm::dvec2 position);

/// Returns the squared distance from a position to the nearest point of a tile's space, in square
/// meters. Returns 0 if the position lies inside.
double distance_squared(const TileSpace &space, const glm::dvec3 &position);

} // namespace thicket
