#include "core/drawing/division_queue.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

std::uint32_t DivisionQueue::first_division(
		std::uint32_t wanted_division, Multimeshes total, bool replaces_visible_tile, bool others_wait) {
	return total.count <= total.limit && (replaces_visible_tile || !others_wait) ? wanted_division : 1;
}

void DivisionQueue::choose(const TileKey &key, std::uint32_t displayed_division, std::uint32_t wanted_division) {
	if (displayed_division != wanted_division && !is_current(key)) {
		waiting_tiles_.insert(key);
	}
}

std::optional<DivisionQueue::Division> DivisionQueue::begin(const Tiles &tiles, Multimeshes total) {
	if (must_shrink(total)) {
		current_ = {*farther_than(-1.0, tiles).farthest, 1};
	}
	while (!current_ && !waiting_tiles_.empty()) {
		const TileKey key = nearest_waiting(tiles);
		if (begin_with(key, tiles, total)) {
			break;
		}
	}
	return current_;
}

TileKey DivisionQueue::nearest_waiting(const Tiles &tiles) const {
	const auto nearest =
			std::ranges::min_element(waiting_tiles_, {}, [&tiles](const TileKey &key) { return tiles.distance(key); });
	return *nearest;
}

/// Begins the division of a waiting tile, or first merges a farther tile to free multimeshes for
/// it. If the tile must stay as it is, removes it from the queue and returns false.
bool DivisionQueue::begin_with(const TileKey &key, const Tiles &tiles, Multimeshes total) {
	const std::uint32_t displayed_division = tiles.displayed_division(key);
	const std::uint32_t cells_per_edge = tiles.wanted_division(key);
	const std::uint64_t next_count = total.count - tiles.multimeshes(key) + tiles.multimesh_bound(key, cells_per_edge);
	const bool exceeds_limit = cells_per_edge > displayed_division && next_count > total.limit;
	if (exceeds_limit) {
		const FartherTiles farther = farther_than(yield_factor * tiles.distance(key), tiles);
		if (next_count - total.limit <= farther.freeable_count) {
			current_ = {*farther.farthest, 1};
			return true;
		}
	}
	waiting_tiles_.erase(key);
	if (exceeds_limit) {
		postponed_tiles_.insert(key);
	}
	if (exceeds_limit || cells_per_edge == displayed_division) {
		return false;
	}
	current_ = {key, cells_per_edge};
	return true;
}

/// Finds the divided tiles that are farther away than `distance`.
DivisionQueue::FartherTiles DivisionQueue::farther_than(double distance, const Tiles &tiles) const {
	FartherTiles result;
	double farthest = distance;
	for (const TileKey &key : divided_tiles_) {
		const double tile_distance = tiles.distance(key);
		if (tile_distance > distance) {
			const std::uint64_t count = tiles.multimeshes(key);
			result.freeable_count += count - std::min(count, tiles.multimesh_bound(key, 1));
		}
		if (tile_distance > farthest) {
			farthest = tile_distance;
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
		divided_tiles_.insert(key);
	} else {
		divided_tiles_.erase(key);
	}
}

void DivisionQueue::remove(const TileKey &key) {
	waiting_tiles_.erase(key);
	postponed_tiles_.erase(key);
	divided_tiles_.erase(key);
}

void DivisionQueue::capacity_gained(const Tiles &tiles) {
	for (const TileKey &key : std::exchange(postponed_tiles_, {})) {
		choose(key, tiles.displayed_division(key), tiles.wanted_division(key));
	}
}

void DivisionQueue::clear() {
	current_.reset();
	waiting_tiles_.clear();
	postponed_tiles_.clear();
	divided_tiles_.clear();
}

} // namespace thicket
