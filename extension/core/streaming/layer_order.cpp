// This file determines the order in which the tiles of a layer are requested and shown.

#include "core/base/guard.hpp"
#include "core/base/tile_grid.hpp"
#include "core/streaming/layer_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thicket {

namespace {

/// A tile may be shown before missing tiles that are nearer by up to this many tiles. Distances of
/// missing tiles may be outdated by `slack_tiles`, so the total tolerance is one tile.
constexpr double tolerance_tiles = 1.0 - slack_tiles;

} // namespace

/// Adds a tile to the queues of all viewers that are near enough to keep it.
void LayerTiles::add_to_queues(std::uint32_t slot) {
	const glm::ivec3 at = tiles_[slot].at;
	for (ViewerState &state : viewer_states_) {
		if (state.keep.contains(at)) {
			state.queue.add(slot, at);
		}
	}
}

/// Queues a tile to be requested again. If memory runs out, the next call to `update_viewers`
/// rebuilds the queues.
void LayerTiles::queue_up(std::uint32_t slot) noexcept {
	const Status status = guarded("tiles", 1.0, [&] { add_to_queues(slot); });
	torn_ = torn_ || !status.ok();
}

/// Updates the distance of a queue entry. Returns false if the entry is no longer needed.
bool LayerTiles::measure(const ViewerState &state, TileQueue::Entry &entry) const {
	const StreamedTile &tile = tiles_[entry.slot];
	if (!tile.exists || tile.at != entry.at || tile.current) {
		return false;
	}
	entry.distance_squared = distance_squared(space(entry.at), state.position);
	return state.view.contains(entry.at) || (tile.begun() && state.keep.contains(entry.at));
}

void LayerTiles::sort(ViewerState &state) {
	state.queue.sort([&](TileQueue::Entry &entry) { return measure(state, entry); });
}

/// Returns the viewer's nearest queued tile for which `fits` returns true, or null if there is
/// none.
template <class Fits>
const TileQueue::Entry *LayerTiles::first(ViewerState &state, std::size_t cursor, Fits &&fits) {
	return state.queue.first(
			cursor, [&](TileQueue::Entry &entry) { return measure(state, entry); },
			[&](const TileQueue::Entry &entry) {
				const StreamedTile &tile = tiles_[entry.slot];
				return tile.exists && tile.at == entry.at && fits(tile);
			});
}

std::optional<LayerTiles::Candidate> LayerTiles::next_waiting(std::size_t viewer) {
	const TileQueue::Entry *entry =
			first(viewer_states_[viewer], 0, [](const StreamedTile &tile) { return tile.waiting(); });
	return entry != nullptr ? std::optional(Candidate{entry->distance_squared, entry->slot}) : std::nullopt;
}

TileRequest LayerTiles::request(std::uint32_t slot, std::uint64_t ticket, std::uint32_t viewer, double traveled) {
	change(slot, [&](StreamedTile &tile) {
		tile.ticket = ticket;
		tile.viewer = viewer;
		tile.traveled = traveled;
	});
	return request_of(slot);
}

TileRequest LayerTiles::request_of(std::uint32_t slot) const {
	const StreamedTile &tile = tiles_[slot];
	return {key(tile.at), space(tile.at), tile.ticket};
}

/// Returns the slot of the tile for which this request is pending, or TileTable::none if it is not
/// pending.
std::uint32_t LayerTiles::find_pending(const TileRequest &request) const {
	// Tickets are never reused, so the ticket also distinguishes tiles of different grids.
	const std::uint32_t slot = tiles_.find({request.key.tile, request.key.slab});
	const bool same = slot != TileTable::none && request.ticket != 0 && tiles_[slot].ticket == request.ticket;
	return same ? slot : TileTable::none;
}

bool LayerTiles::ready(const TileRequest &request) {
	const std::uint32_t slot = find_pending(request);
	if (slot != TileTable::none && !std::exchange(tiles_[slot].is_ready, true)) {
		ready_slots_.push_back(slot); // `enter` has reserved the memory.
	}
	return slot != TileTable::none;
}

void LayerTiles::forget_ready(std::uint32_t slot) {
	if (std::exchange(tiles_[slot].is_ready, false)) {
		std::erase(ready_slots_, slot);
	}
}

/// Returns the distance in meters from a viewer to the nearest tile in its view that is not shown,
/// or infinity if there is none.
double LayerTiles::first_missing(ViewerState &state) {
	const TileQueue::Entry *entry =
			first(state, 1, [&](const StreamedTile &tile) { return !tile.visible && state.view.contains(tile.at); });
	return entry != nullptr ? std::sqrt(entry->distance_squared) : std::numeric_limits<double>::infinity();
}

/// Returns true if a ready tile may be shown now: no tile that this viewer still lacks is much
/// nearer. A tile that replaces a visible one may always be shown.
bool LayerTiles::is_next_for_viewer(
		std::size_t viewer, const TrackedViewer &tracked, const StreamedTile &tile, double distance_squared) {
	if (tile.visible) {
		return true;
	}
	const double traveled = tile.viewer == viewer ? tracked.traveled_since(tile.traveled) : 0.0;
	const double limit = first_missing(viewer_states_[viewer]) + tolerance_tiles * settings_.tile_size + traveled;
	return distance_squared <= limit * limit;
}

std::optional<LayerTiles::Candidate> LayerTiles::next_ready(std::size_t viewer, const TrackedViewer &tracked) {
	std::optional<Candidate> nearest;
	if (behind_ || viewer >= viewer_states_.size()) {
		return nearest; // Nearer tiles may not have been found yet.
	}
	for (const std::uint32_t slot : ready_slots_) {
		const StreamedTile &tile = tiles_[slot];
		if (!viewer_states_[viewer].keep.contains(tile.at)) {
			continue;
		}
		const double squared = distance_squared(space(tile.at), position_of(tracked.now));
		if (nearest && squared >= nearest->distance_squared) {
			// A nearer tile has already been found.
			continue;
		}
		if (is_next_for_viewer(viewer, tracked, tile, squared)) {
			nearest = Candidate{squared, slot};
		}
	}
	return nearest;
}

bool LayerTiles::is_next_for_any_viewer(const StreamedTile &tile, std::span<const TrackedViewer> viewers) {
	for (std::size_t i = 0; i < std::min(viewers.size(), viewer_states_.size()) && !behind_; ++i) {
		const double squared = distance_squared(space(tile.at), position_of(viewers[i].now));
		if (viewer_states_[i].keep.contains(tile.at) && is_next_for_viewer(i, viewers[i], tile, squared)) {
			return true;
		}
	}
	return false;
}

std::size_t LayerTiles::count_waiting(std::span<const TrackedViewer> viewers) {
	return static_cast<std::size_t>(std::ranges::count_if(
			ready_slots_, [&](std::uint32_t slot) { return !is_next_for_any_viewer(tiles_[slot], viewers); }));
}

bool LayerTiles::may_show(const TileRequest &request, std::span<const TrackedViewer> viewers) {
	const std::uint32_t slot = find_pending(request);
	return slot != TileTable::none && is_next_for_any_viewer(tiles_[slot], viewers);
}

bool LayerTiles::finish(const TileRequest &request) {
	const std::uint32_t slot = find_pending(request);
	if (slot == TileTable::none) {
		return false;
	}
	forget_ready(slot);
	change(slot, [](StreamedTile &tile) {
		tile.ticket = 0;
		tile.visible = true;
		tile.current = !tile.late;
		tile.late = false;
	});
	if (!tiles_[slot].current) {
		queue_up(slot);
	}
	return true;
}

} // namespace thicket
