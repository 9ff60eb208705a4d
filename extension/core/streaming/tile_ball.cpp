#include "core/streaming/tile_ball.hpp"

#include "core/base/tile_grid.hpp"

#include <algorithm>
#include <cmath>

namespace thicket {

void TileBall::set(const StreamLayer &layer, const glm::dvec3 &center, double reach) {
	const glm::dvec2 middle(center.x, center.z);
	if (!layer.in_space()) {
		first_slab_ = all_slabs;
		discs_.resize(1);
		discs_.front().set(layer.tile_size, middle, reach);
		return;
	}
	first_slab_ = slab_at(layer.tile_size, std::max(center.y - reach, layer.bottom));
	const std::int32_t last = slab_at(layer.tile_size, std::min(center.y + reach, layer.top));
	discs_.resize(static_cast<std::size_t>(std::max(last - first_slab_ + 1, 0)));
	std::int32_t slab = first_slab_;
	for (TileDisc &disc : discs_) {
		const TileSpace space = tile_space(layer.tile_size, {0, 0}, slab++);
		const double away = std::max({space.bottom - center.y, center.y - space.top, 0.0});
		disc.set(layer.tile_size, middle, std::sqrt(std::max(reach * reach - away * away, 0.0)));
	}
}

} // namespace thicket
