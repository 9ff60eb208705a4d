#include "core/sampling/block_cache.hpp"

#include "core/base/instance_id.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <mutex>
#include <tuple>
#include <utility>

namespace thicket {

namespace {

/// Maximum number of entries. Most entries only record a request for a block and take a few dozen
/// bytes each.
constexpr std::size_t max_entries = 1024;

static_assert(BlockCache::widest_window(max_levels) <= SettledBlock::width, "a window touches four blocks at most");

std::int32_t block_at(std::int32_t cell) {
	return cell >= 0 ? cell / SettledBlock::width : -((-cell + SettledBlock::width - 1) / SettledBlock::width);
}

CellRect cells_of_block(glm::ivec2 block) {
	const glm::ivec2 first = block * SettledBlock::width;
	return {glm::max(first, glm::ivec2(-cell_limit)), glm::min(first + SettledBlock::width, glm::ivec2(cell_limit))};
}

} // namespace

SettledBlock::SettledBlock(const LevelGrid &grid, const CellRect &cells) : cells_(cells) {
	const glm::ivec2 size = cells.size();
	std::uint32_t count = 0;
	for (std::int32_t y = 0; y < size.y; ++y) {
		Row &row = rows_[static_cast<std::size_t>(y)];
		const LevelGrid::PointOffset *points = grid.point.data() + grid.index_of(cells.min + glm::ivec2(0, y));
		row.begin = count;
		for (std::int32_t x = 0; x < size.x; ++x) {
			row.points[static_cast<std::size_t>(x / 32)] |= (points[x] != LevelGrid::no_point ? 1u : 0u) << x % 32;
		}
		for (const std::uint32_t word : row.points) {
			count += static_cast<std::uint32_t>(std::popcount(word));
		}
	}
	points_.resize(count);
	Point *to = points_.data();
	for (std::int32_t y = 0; y < size.y; ++y) {
		const std::uint32_t first = grid.index_of(cells.min + glm::ivec2(0, y));
		for (std::uint32_t word = 0; word < words; ++word) {
			for (std::uint32_t rest = rows_[static_cast<std::size_t>(y)].points[word]; rest != 0; rest &= rest - 1) {
				const std::uint32_t index = first + word * 32 + static_cast<std::uint32_t>(std::countr_zero(rest));
				*to++ = {grid.point[index], grid.dart[index]};
			}
		}
	}
}

bool BlockCache::Key::operator<(const Key &other) const {
	const auto tied = [](const Key &key) {
		return std::tie(key.set.seed, key.set.radius, key.set.levels, key.set.layer, key.set.period.x, key.set.period.y,
				key.block.x, key.block.y);
	};
	return tied(*this) < tied(other);
}

std::size_t BlockCache::bytes() const {
	const std::lock_guard lock(mutex_);
	return bytes_;
}

/// Returns true if a block that shares an edge with this one is present or being computed. The
/// caller must hold the lock.
bool BlockCache::is_made_beside(const Key &key) const {
	for (const glm::ivec2 step : {glm::ivec2(-1, 0), glm::ivec2(1, 0), glm::ivec2(0, -1), glm::ivec2(0, 1)}) {
		const auto beside = entries_.find({key.set, key.block + step});
		if (beside != entries_.end() && (beside->second.block != nullptr || beside->second.in_work)) {
			return true;
		}
	}
	return false;
}

/// Evicts the least recently used entries until the limits are met. The caller must hold the lock.
void BlockCache::trim() {
	while (bytes_ > limit_ || entries_.size() > max_entries) {
		auto oldest = entries_.end();
		for (auto each = entries_.begin(); each != entries_.end(); ++each) {
			const bool counts = bytes_ <= limit_ || each->second.block != nullptr;
			if (counts && !each->second.in_work &&
					(oldest == entries_.end() || each->second.used < oldest->second.used)) {
				oldest = each;
			}
		}
		if (oldest == entries_.end()) {
			return; // All blocks are being computed.
		}
		bytes_ -= oldest->second.block != nullptr ? oldest->second.block->bytes() : 0;
		entries_.erase(oldest);
	}
}

SettledWindow::SettledWindow(BlockCache &cache, const PointSet &set, const CellRect &window) :
		cache_(cache), window_(window) {
	const glm::ivec2 first(block_at(window.min.x), block_at(window.min.y));
	const glm::ivec2 last(block_at(window.max.x - 1), block_at(window.max.y - 1));
	for (std::int32_t y = first.y; y <= last.y; ++y) {
		for (std::int32_t x = first.x; x <= last.x; ++x) {
			slots_[count_++].key = {set, {x, y}};
		}
	}
	const std::lock_guard lock(cache_.mutex_);
	std::array<BlockCache::Entry *, 4> entries{};
	served_ = true;
	for (std::size_t slot = 0; slot < count_; ++slot) {
		const auto [entry, is_new] = cache_.entries_.try_emplace(slots_[slot].key);
		entries[slot] = &entry->second;
		entry->second.used = ++cache_.clock_;
		served_ = served_ && (!is_new || cache_.is_made_beside(slots_[slot].key)) && !entry->second.in_work;
	}
	if (!served_) {
		cache_.trim();
		return;
	}
	for (std::size_t slot = 0; slot < count_; ++slot) {
		slots_[slot].block = entries[slot]->block;
		slots_[slot].claimed = entries[slot]->in_work = slots_[slot].block == nullptr;
	}
}

SettledWindow::~SettledWindow() {
	if (std::ranges::none_of(slots_, &Slot::claimed)) {
		// There is nothing to release, so the lock is not needed.
		return;
	}
	const std::lock_guard lock(cache_.mutex_);
	for (const Slot &slot : slots_) {
		if (slot.claimed) {
			cache_.entries_.at(slot.key).in_work = false; // The entry exists, because trim() keeps entries in work.
		}
	}
}

bool SettledWindow::next_missing(CellRect &r_cells) {
	const auto slot = std::ranges::find(slots_, true, &Slot::claimed);
	if (slot == slots_.end()) {
		return false;
	}
	missing_ = static_cast<std::size_t>(slot - slots_.begin());
	r_cells = cells_of_block(slot->key.block);
	return true;
}

void SettledWindow::settle(const LevelGrid &grid) {
	Slot &slot = slots_[missing_];
	slot.block = std::make_shared<const SettledBlock>(grid, cells_of_block(slot.key.block));
	const std::lock_guard lock(cache_.mutex_);
	BlockCache::Entry &entry = cache_.entries_.at(slot.key);
	entry.block = slot.block;
	entry.in_work = slot.claimed = false;
	cache_.bytes_ += slot.block->bytes();
	cache_.trim();
}

} // namespace thicket
