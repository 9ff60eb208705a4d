#include "core/drawing/division_queue.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

std::uint32_t DivisionQueue::first_division(
		std::uint32_t wanted, Multimeshes then, bool replaces_visible_tile, bool others_wait) {
	return then.count <= then.limit && (replaces_visible_tile || !others_wait) ? wanted : 1;
}

void DivisionQueue::choose(const TileKey &key, std::uint32_t displayed, std::uint32_t wanted) {
	if (displayed != wanted && !is_current(key)) {
		waiting_.insert(key);
	}
}

std::optional<DivisionQueue::Division> DivisionQueue::begin(const Tiles &tiles, Multimeshes all) {
	if (must_shrink(all)) {
		current_ = {*farther_than(-1.0, tiles).farthest, 1};
	}
	while (!current_ && !waiting_.empty()) {
		const TileKey key = nearest_waiting(tiles);
		if (begin_with(key, tiles, all)) {
			break;
		}
	}
	return current_;
}

TileKey DivisionQueue::nearest_waiting(const Tiles &tiles) const {
	const auto nearest =
			std::ranges::min_element(waiting_, {}, [&tiles](const TileKey &key) { return tiles.distance(key); });
	return *nearest;
}

/// Begins the division of a waiting tile, or first merges a farther tile to free multimeshes for
/// it. If the tile must stay as it is, removes it from the queue and returns false.
bool DivisionQueue::begin_with(const TileKey &key, const Tiles &tiles, Multimeshes all) {
	const std::uint32_t displayed = tiles.displayed(key);
	const std::uint32_t cells_per_edge = tiles.wanted(key);
	const std::uint64_t then = all.count - tiles.multimeshes(key) + tiles.multimesh_bound(key, cells_per_edge);
	const bool exceeds = cells_per_edge > displayed && then > all.limit;
	if (exceeds) {
		const FartherTiles farther = farther_than(yield_factor * tiles.distance(key), tiles);
		if (then - all.limit <= farther.spare) {
			current_ = {*farther.farthest, 1};
			return true;
		}
	}
	waiting_.erase(key);
	if (exceeds) {
		refused_.insert(key);
	}
	if (exceeds || cells_per_edge == displayed) {
		return false;
	}
	current_ = {key, cells_per_edge};
	return true;
}

/// Finds the divided tiles that are farther away than `distance`.
DivisionQueue::FartherTiles DivisionQueue::farther_than(double distance, const Tiles &tiles) const {
	FartherTiles result;
	double farthest = distance;
	for (const TileKey &key : divided_) {
		const double its = tiles.distance(key);
		if (its > distance) {
			const std::uint64_t now = tiles.multimeshes(key);
			result.spare += now - std::min(now, tiles.multimesh_bound(key, 1));
		}
		if (its > farthest) {
			farthest = its;
			result.farthest = &key;
		}
	}
	return result;
}

void DivisionQueue::finish() {
	show(current_->key, current_->cells_per_edge);
	current_.reset();
}

void DivisionQueue::show(const TileKey &key, std::uint32_t cells_per_edge) {
	if (cells_per_edge > 1) {
		divided_.insert(key);
	} else {
		divided_.erase(key);
	}
}

void DivisionQueue::remove(const TileKey &key) {
	waiting_.erase(key);
	refused_.erase(key);
	divided_.erase(key);
}

void DivisionQueue::capacity_gained(const Tiles &tiles) {
	for (const TileKey &key : std::exchange(refused_, {})) {
		choose(key, tiles.displayed(key), tiles.wanted(key));
	}
}

void DivisionQueue::clear() {
	current_.reset();
	waiting_.clear();
	refused_.clear();
	divided_.clear();
}

} // namespace thicket
