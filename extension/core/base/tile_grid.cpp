#include "core/base/tile_grid.hpp"

#include <algorithm>
#include <cmath>

namespace thicket {

std::int32_t slab_at(double tile_size, double height) {
	constexpr double outermost = max_tile_coordinate;
	double tile = std::floor(height / tile_size);
	// The division above is rounded, so the exact edges of tile_rect() decide.
	if (height < tile * tile_size) {
		tile -= 1.0;
	} else if (height >= (tile + 1.0) * tile_size) {
		tile += 1.0;
	}
	return static_cast<std::int32_t>(std::clamp(tile, -outermost, outermost));
}

glm::ivec2 tile_at(double tile_size, glm::dvec2 position) {
	return {slab_at(tile_size, position.x), slab_at(tile_size, position.y)};
}

Rect tile_rect(double tile_size, glm::ivec2 tile) {
	// The end is a product, not the start plus tile_size, so that it is bit-identical to the start
	// of the next tile.
	return {glm::dvec2(tile) * tile_size, glm::dvec2(tile + 1) * tile_size};
}

TileSpace tile_space(double tile_size, glm::ivec2 tile, std::int32_t slab) {
	const Rect rect = tile_rect(tile_size, tile);
	return slab == all_slabs ? TileSpace(rect) : TileSpace(rect, slab * tile_size, (slab + 1.0) * tile_size);
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

double distance_squared(const TileSpace &space, const glm::dvec3 &position) {
	const double horizontal = distance_squared(static_cast<const Rect &>(space), glm::dvec2(position.x, position.z));
	const double y = std::max({space.bottom - position.y, position.y - space.top, 0.0});
	return horizontal + y * y;
}

} // namespace thicket
