#include "core/base/tile_grid.hpp"

#include <algorithm>
#include <cmath>

namespace thicket {

glm::ivec2 tile_at(double tile_size, glm::dvec2 position) {
	const auto coordinate = [tile_size](double along) {
		constexpr double outermost = max_tile_coordinate;
		double tile = std::floor(along / tile_size);
		// The division rounds, so the edges of tile_rect decide.
		if (along < tile * tile_size) {
			tile -= 1.0;
		} else if (along >= (tile + 1.0) * tile_size) {
			tile += 1.0;
		}
		return static_cast<std::int32_t>(std::clamp(tile, -outermost, outermost));
	};
	return {coordinate(position.x), coordinate(position.y)};
}

Rect tile_rect(double tile_size, glm::ivec2 tile) {
	// A product, not a sum, so that the end of one tile and the start of the next are the same expression.
	return {glm::dvec2(tile) * tile_size, glm::dvec2(tile + 1) * tile_size};
}

TileRange tiles_in(double tile_size, const Rect &rect) {
	if (rect.empty()) {
		return {};
	}
	const glm::ivec2 end = tile_at(tile_size, rect.max);
	const glm::dvec2 edge = tile_rect(tile_size, end).min;
	return {tile_at(tile_size, rect.min),
			{end.x - (edge.x < rect.max.x ? 0 : 1), end.y - (edge.y < rect.max.y ? 0 : 1)}};
}

double distance_squared(const Rect &rect, glm::dvec2 position) {
	const double x = std::max({rect.min.x - position.x, position.x - rect.max.x, 0.0});
	const double y = std::max({rect.min.y - position.y, position.y - rect.max.y, 0.0});
	return x * x + y * y;
}

} // namespace thicket
