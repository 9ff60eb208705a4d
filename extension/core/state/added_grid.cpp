#include "core/state/added_grid.hpp"

#include "core/base/tile_grid.hpp"

namespace thicket {

AddedGrid::Entry AddedGrid::entry_of(std::uint64_t id, glm::dvec2 position) {
	constexpr double side = 64.0; // Meters.
	const glm::ivec2 square = tile_at(side, position);
	return {square.x, square.y, id};
}

void AddedGrid::insert(std::uint64_t id, glm::dvec2 position) { entries_.insert(entry_of(id, position)); }

void AddedGrid::erase(std::uint64_t id, glm::dvec2 position) noexcept { entries_.erase(entry_of(id, position)); }

void AddedGrid::take(AddedGrid &r_from, std::uint64_t id, glm::dvec2 position) noexcept {
	entries_.insert(r_from.entries_.extract(entry_of(id, position)));
}

} // namespace thicket
