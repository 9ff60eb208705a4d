#include "core/state/added_grid.hpp"

#include "core/base/tile_grid.hpp"
#include "core/state/instance_state.hpp"

namespace thicket {

/// Returns an entry that sorts before all instances in the square that contains `position`.
AddedGrid::Entry AddedGrid::corner_of(std::uint16_t layer, glm::dvec2 position) {
	constexpr double side = 64.0; // Edge length of a square in meters.
	const glm::ivec2 square = tile_at(side, position);
	return {layer, square.x, square.y, 0};
}

AddedGrid::Entry AddedGrid::entry_of(std::uint64_t id, glm::dvec2 position) {
	Entry entry = corner_of(layer_of(id), position);
	entry.id = id;
	return entry;
}

void AddedGrid::insert(std::uint64_t id, glm::dvec2 position) { entries_.insert(entry_of(id, position)); }

void AddedGrid::erase(std::uint64_t id, glm::dvec2 position) noexcept { entries_.erase(entry_of(id, position)); }

void AddedGrid::take(AddedGrid &r_from, std::uint64_t id, glm::dvec2 position) noexcept {
	entries_.insert(r_from.entries_.extract(entry_of(id, position)));
}

} // namespace thicket
