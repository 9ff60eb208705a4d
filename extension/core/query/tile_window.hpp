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

/// Generous upper bounds for the relative rounding errors of floats and doubles in the computation of a position.
inline constexpr double float_rounding = 1e-6;
inline constexpr double double_rounding = 1e-15;

/// The cells of a set lie within this many meters of the origin. It is the same product as in the sampler, which refuses anything beyond.
double set_extent(const PointSet &set);

/// The range of a layer's tiles, and how far from its tile an instance may be placed.
class TileWindow {
public:
	/// `layer` must be valid.
	explicit TileWindow(const QueryLayer &layer);

	/// The tiles that touch a rectangle of any size. Only tiles that lie within the cells of the set are included.
	TileRange touching(const Rect &rect) const;

	/// The square of a tile, expanded to where its instances may be placed.
	Rect standing_area(glm::ivec2 tile) const;

	/// The largest distance in meters, in the plane, of an instance from its tile: offset_along_normal, plus float rounding.
	double stray() const { return stray_; }

	/// Points in a tile, estimated from the density of the set; at least fewest_points.
	double tile_points() const { return tile_points_; }

	/// The minimum cost of a tile, even if it is empty.
	static constexpr double fewest_points = 16.0;

private:
	double size_;
	double stray_;
	double tile_points_;
	std::int32_t first_; ///< On both axes.
	std::int32_t last_;
};

/// Refuses a layer with a number outside its documented range, and an invalid point set.
Status validate(const QueryLayer &layer);

/// Finds the wanted layers that a filter names, ascending, each once. Refuses a layer that does not exist, and a wanted layer that is not
/// valid.
Status find_layers(
		std::span<const QueryLayer> layers, const QueryFilter &filter, std::vector<std::uint32_t> &r_indices);

/// Meters; queries do not reach beyond.
inline constexpr double max_query_coordinate = 1e15;
inline constexpr double min_query_tile_size = 1e-2; ///< Meters.

/// The search area of a query, in the plane.
struct QueryArea {
	const char *property = "rect"; ///< The name of the refused parameter if the area is too large.
	Rect rect;
	glm::dvec2 center{0.0};
	double radius = std::numeric_limits<double>::infinity(); ///< Only within this many meters of the center.
};

/// Finds the tiles of some layers that must be searched for all instances whose origin lies in an area. The tiles are
/// ordered by layer, and nearest to the area's center first. Replaces `r_tiles`. Refuses more than
/// InstanceQuery::max_points in all of them, and then leaves `r_tiles` empty.
Status find_tiles(std::span<const QueryLayer> layers, std::span<const std::uint32_t> indices, const QueryArea &area,
		std::vector<InstanceQuery::Tile> &r_tiles);

/// Refuses a position that is not finite or beyond max_query_coordinate.
Status check_position(const char *property, glm::dvec3 position);

inline double squared_length(glm::dvec3 v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

/// A rectangle that contains all positions within `distance` of a position, including its border and rounding.
Rect rect_around(glm::dvec2 center, double distance);

} // namespace thicket
