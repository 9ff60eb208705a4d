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

/// The largest shares of a number that floats and doubles round off on the way to a position, generously.
inline constexpr double float_rounding = 1e-6;
inline constexpr double double_rounding = 1e-15;

/// The cells of a set lie within so many meters of the origin: the same product as where the sampler refuses what lies
/// beyond.
double set_extent(const PointSet &set);

/// Which tiles of a layer there are, and how far off its tile an instance may stand.
class TileWindow {
public:
	/// `layer` is valid.
	explicit TileWindow(const QueryLayer &layer);

	/// The tiles that touch a rectangle, which may be as large as it likes; those alone that lie within the cells of
	/// the set.
	TileRange touching(const Rect &rect) const;

	/// The square of a tile, grown to where its instances may stand.
	Rect standing_area(glm::ivec2 tile) const;

	/// Meters from its tile, in the plane, at which an instance may stand: offset_along_normal, and what floats round
	/// off.
	double stray() const { return stray_; }

	/// Points in a tile, by the density of the set; fewest_points at least.
	double tile_points() const { return tile_points_; }

	/// What a tile costs, however empty it is.
	static constexpr double fewest_points = 16.0;

private:
	double size_;
	double stray_;
	double tile_points_;
	std::int32_t first_; ///< On both axes.
	std::int32_t last_;
};

/// Refuses a layer with a number outside the range that its docstring gives, and a point set that is refused.
Status validate(const QueryLayer &layer);

/// The wanted layers that a filter names, ascending, once each. Refuses one that is not there, and a wanted one that is
/// not valid.
Status find_layers(
		std::span<const QueryLayer> layers, const QueryFilter &filter, std::vector<std::uint32_t> &r_indices);

/// Meters; nothing is asked beyond.
inline constexpr double max_query_coordinate = 1e15;
inline constexpr double min_query_tile_size = 1e-2; ///< Meters.

/// Where something is looked for in the plane.
struct QueryArea {
	const char *property = "rect"; ///< What is refused if it is too large.
	Rect rect;
	glm::dvec2 center{0.0};
	double radius = std::numeric_limits<double>::infinity(); ///< Only within so many meters of the center.
};

/// The tiles of some layers that have to be looked at for all whose origin lies in an area, by layer and nearest to its
/// center first. Replaces `r_tiles`; refuses more than InstanceQuery::max_points in all of them, and then leaves none.
Status find_tiles(std::span<const QueryLayer> layers, std::span<const std::uint32_t> indices, const QueryArea &area,
		std::vector<InstanceQuery::Tile> &r_tiles);

/// Refuses a position that is not finite or beyond max_query_coordinate.
Status check_position(const char *property, glm::dvec3 position);

inline double squared_length(glm::dvec3 v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

/// A rectangle that holds all positions within `distance` of another, its border and what rounds off included.
Rect rect_around(glm::dvec2 center, double distance);

} // namespace thicket
