#include "core/streaming/tile_disc.hpp"

#include "core/base/tile_grid.hpp"

#include <cmath>

namespace thicket {

void TileDisc::set(double tile_size, glm::dvec2 center, double reach) {
	rows_.clear();
	first_row_ = tile_at(tile_size, center - reach).y;
	const int last_row = tile_at(tile_size, center + reach).y;
	for (int y = first_row_; y <= last_row; ++y) {
		const double below = static_cast<double>(y) * tile_size - center.y;
		const double above = center.y - static_cast<double>(y + 1) * tile_size;
		const double away = std::max({below, above, 0.0});
		const double half = std::sqrt(std::max(reach * reach - away * away, 0.0));
		rows_.push_back({tile_at(tile_size, center - half).x, tile_at(tile_size, center + half).x});
	}
}

} // namespace thicket
