#include "core/state/added_grid.hpp"

#include "core/base/tile_grid.hpp"

#include <algorithm>

namespace thicket {

AddedGrid::Square AddedGrid::square_of(glm::dvec2 position) {
	constexpr double side = 64.0; // Meters.
	const glm::ivec2 square = tile_at(side, position);
	return {square.x, square.y};
}

void AddedGrid::insert(std::uint64_t id, glm::dvec2 position) { squares_[square_of(position)].push_back(id); }

void AddedGrid::erase(std::uint64_t id, glm::dvec2 position) {
	const auto square = squares_.find(square_of(position));
	if (square != squares_.end()) {
		std::erase(square->second, id);
		if (square->second.empty()) {
			squares_.erase(square);
		}
	}
}

} // namespace thicket
