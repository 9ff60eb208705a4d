#include "core/streaming/tile_table.hpp"

#include "core/base/reserve.hpp"
#include "core/base/split_mix.hpp"

namespace thicket {

std::size_t TileTable::home(glm::ivec2 at) const {
	const std::uint64_t word = std::uint64_t{static_cast<std::uint32_t>(at.x)} << 32 | static_cast<std::uint32_t>(at.y);
	return static_cast<std::size_t>(split_mix(word)) & (places_.size() - 1);
}

/// Where a tile is, or the free place where it would be put. The table is not empty.
std::size_t TileTable::place_of(glm::ivec2 at) const {
	std::size_t place = home(at);
	while (places_[place] != none && tiles_[places_[place]].at != at) {
		place = (place + 1) & (places_.size() - 1);
	}
	return place;
}

std::uint32_t TileTable::find(glm::ivec2 at) const { return places_.empty() ? none : places_[place_of(at)]; }

void TileTable::grow() {
	const std::size_t places = places_.empty() ? 64 : 2 * places_.size();
	std::vector<std::uint32_t>(places, none).swap(places_);
	for (std::uint32_t slot = 0; slot < tiles_.size(); ++slot) {
		if (tiles_[slot].exists) {
			places_[place_of(tiles_[slot].at)] = slot;
		}
	}
}

std::uint32_t TileTable::find_or_add(glm::ivec2 at) {
	if (2 * (size() + 1) > places_.size()) {
		grow();
	}
	std::uint32_t &entry = places_[place_of(at)];
	if (entry == none) {
		if (free_.empty()) {
			reserve_more(free_, tiles_.size() + 1 - free_.size()); // For all of them: `erase` takes no memory.
			tiles_.emplace_back();
			free_.push_back(static_cast<std::uint32_t>(tiles_.size() - 1));
		}
		entry = free_.back();
		free_.pop_back();
		tiles_[entry] = StreamedTile{};
		tiles_[entry].at = at;
		tiles_[entry].exists = true;
	}
	return entry;
}

void TileTable::erase(std::uint32_t slot) noexcept {
	const std::size_t mask = places_.size() - 1;
	std::size_t hole = place_of(tiles_[slot].at);
	places_[hole] = none;
	// What was put behind the hole because its own place was taken moves up, or it would not be found again.
	for (std::size_t place = (hole + 1) & mask; places_[place] != none; place = (place + 1) & mask) {
		const std::size_t from_home = (place - home(tiles_[places_[place]].at)) & mask;
		if (from_home >= ((place - hole) & mask)) {
			places_[hole] = places_[place];
			places_[place] = none;
			hole = place;
		}
	}
	tiles_[slot].exists = false;
	free_.push_back(slot);
}

void TileTable::clear() {
	tiles_.clear();
	free_.clear();
	places_.clear();
}

} // namespace thicket
