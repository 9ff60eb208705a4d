#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/base/tile_grid.hpp"
#include "core/query/instance_query.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace thicket {

/// Generous upper bounds for the relative rounding errors of a position computed in floats and in
/// doubles.
inline constexpr double float_rounding = 1e-6;
inline constexpr double double_rounding = 1e-15;

/// The range of a layer's valid tiles, and the largest distance of an instance from its tile.
class TileWindow {
public:
	/// Computes the range of tiles of a layer, which must be valid.
	explicit TileWindow(const QueryLayer &layer);

	/// Returns the tiles that touch a rectangle of any size, limited to tiles within the cells of
	/// the set.
	TileRange touching(const Rect &rect) const;

	/// A range of slabs, including both ends.
	struct Slabs {
		std::int32_t first = all_slabs;
		std::int32_t last = all_slabs;

		double count() const { return first > last ? 0.0 : 1.0 + last - first; }
	};

	/// Returns the slabs that touch both a range of heights and the layer's range of heights. If
	/// the layer's tiles are not cubes, returns only all_slabs.
	Slabs touching(double bottom, double top) const;

	/// Returns the space in which a tile's instances may be placed: the space of the tile, extended
	/// by `stray`.
	TileSpace standing_space(glm::ivec2 tile, std::int32_t slab) const;

	/// Returns the largest distance in meters of an instance from its tile:
	/// QueryLayer::max_offset plus rounding.
	double stray() const { return stray_; }

	/// Returns the number of points in a tile, estimated from the density of the set, or
	/// fewest_points if that is larger. For a cube, only a quarter of the density is used, because
	/// the surface touches only some of the cubes.
	double tile_points() const { return tile_points_; }

	/// The minimum number of points to assume for a tile, even if it is empty.
	static constexpr double fewest_points = 16.0;

private:
	double size_;
	double bottom_; ///< `bottom_` to `top_` are the heights of the layer; see QueryLayer.
	double top_;
	double stray_;
	double tile_points_;
	std::int32_t first_; ///< First and last tile on both axes.
	std::int32_t last_;
};

/// Returns an error for a layer with values outside their documented ranges, and for an invalid
/// point set.
Status validate(const QueryLayer &layer);

/// Finds the indices of the wanted layers that a filter selects, ascending and without duplicates.
/// A layer that does not exist and a wanted layer that is invalid are errors.
Status find_layers(
		std::span<const QueryLayer> layers, const QueryFilter &filter, std::vector<std::uint32_t> &r_indices);

/// Largest absolute coordinate and distance of a query, in meters.
inline constexpr double max_query_coordinate = 1e15;
inline constexpr double min_query_tile_size = 1e-2; ///< Minimum tile size of a query in meters.

/// The search area of a query. Its heights affect only layers whose tiles are cubes.
struct QueryArea {
	const char *property = "rect"; ///< Parameter that the error names if the area is too large.
	TileSpace space;
	glm::dvec3 center{0.0};
	/// Tiles farther than this from the center, in meters, are excluded.
	double radius = std::numeric_limits<double>::infinity();
};

/// Finds the tiles of some layers that may contain instances whose origin is in an area. The tiles
/// are ordered by layer and, within a layer, by distance from the area's center. Replaces
/// `r_tiles`. More than InstanceQuery::max_points in all tiles together are an error; `r_tiles` is
/// then empty.
Status find_tiles(std::span<const QueryLayer> layers, std::span<const std::uint32_t> indices, const QueryArea &area,
		std::vector<InstanceQuery::Tile> &r_tiles);

/// Returns an error for a position that is not finite or beyond max_query_coordinate.
Status check_position(const char *property, glm::dvec3 position);

inline double squared_length(glm::dvec3 v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

/// Returns a rectangle that contains all positions within `distance` of `center`, including its
/// border, with a margin for rounding.
Rect rect_around(glm::dvec2 center, double distance);

/// Returns a space that contains all positions within `distance` of `center`; see rect_around.
TileSpace space_around(const glm::dvec3 &center, double distance);

} // namespace thicket
