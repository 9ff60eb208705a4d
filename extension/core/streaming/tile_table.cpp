#include "core/streaming/tile_table.hpp"

#include "core/base/reserve.hpp"
#include "core/base/split_mix.hpp"

namespace thicket {

std::size_t TileTable::home(glm::ivec3 at) const {
	const std::uint64_t word = std::uint64_t{static_cast<std::uint32_t>(at.x)} << 32 | static_cast<std::uint32_t>(at.y);
	const auto slab = std::uint64_t{static_cast<std::uint32_t>(at.z)} * split_mix_gamma;
	return static_cast<std::size_t>(split_mix(word ^ slab)) & (buckets_.size() - 1);
}

/// Returns the bucket of a tile, or the free bucket for inserting it. `buckets_` must not be empty.
std::size_t TileTable::bucket_of(glm::ivec3 at) const {
	std::size_t bucket = home(at);
	while (buckets_[bucket] != none && tiles_[buckets_[bucket]].at != at) {
		bucket = (bucket + 1) & (buckets_.size() - 1);
	}
	return bucket;
}

std::uint32_t TileTable::find(glm::ivec3 at) const { return buckets_.empty() ? none : buckets_[bucket_of(at)]; }

void TileTable::grow() {
	const std::size_t count = buckets_.empty() ? 64 : 2 * buckets_.size();
	std::vector<std::uint32_t>(count, none).swap(buckets_);
	for (std::uint32_t slot = 0; slot < tiles_.size(); ++slot) {
		if (tiles_[slot].exists) {
			buckets_[bucket_of(tiles_[slot].at)] = slot;
		}
	}
}

std::uint32_t TileTable::find_or_add(glm::ivec3 at) {
	if (2 * (size() + 1) > buckets_.size()) {
		grow();
	}
	std::uint32_t &entry = buckets_[bucket_of(at)];
	if (entry == none) {
		if (free_.empty()) {
			// An entry is reserved for every tile, so that `erase` does not allocate.
			reserve_more(free_, tiles_.size() + 1 - free_.size());
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
	const std::size_t mask = buckets_.size() - 1;
	std::size_t hole = bucket_of(tiles_[slot].at);
	buckets_[hole] = none;
	// Displaced tiles are moved back into the gap, so that linear probing still finds them.
	for (std::size_t bucket = (hole + 1) & mask; buckets_[bucket] != none; bucket = (bucket + 1) & mask) {
		const std::size_t from_home = (bucket - home(tiles_[buckets_[bucket]].at)) & mask;
		if (from_home >= ((bucket - hole) & mask)) {
			buckets_[hole] = buckets_[bucket];
			buckets_[bucket] = none;
			hole = bucket;
		}
	}
	tiles_[slot].exists = false;
	free_.push_back(slot);
}

void TileTable::clear() {
	tiles_.clear();
	free_.clear();
	buckets_.clear();
}

} // namespace thicket
