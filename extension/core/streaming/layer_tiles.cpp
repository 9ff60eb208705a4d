#include "core/streaming/layer_tiles.hpp"

#include "core/base/guard.hpp"
#include "core/base/reserve.hpp"
#include "core/base/tile_grid.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

bool touch(const TileSpace &a, const TileSpace &b) {
	return a.min.x < b.max.x && b.min.x < a.max.x && a.min.y < b.max.y && b.min.y < a.max.y && a.bottom < b.top &&
			b.bottom < a.top;
}

} // namespace

StreamCounts LayerTiles::counts() const {
	StreamCounts counts = counts_;
	counts.visible += retired_.size();
	return counts;
}

TileSpace LayerTiles::space(glm::ivec3 at) const { return tile_space(settings_.tile_size, glm::ivec2(at), at.z); }

void LayerTiles::erase(std::uint32_t slot) {
	change(slot, [](StreamedTile &tile) { tile.exists = false; });
	tiles_.erase(slot);
}

void LayerTiles::add_max_changes(std::size_t &r_cancel, std::size_t &r_drop) const {
	r_cancel += counts_.pending;
	r_drop += counts_.visible + retired_.size();
}

void LayerTiles::reserve_retired() { reserve_more(retired_, counts_.visible); }

void LayerTiles::configure(const StreamLayer &settings, std::uint32_t new_grid, StreamChanges &r_changes) {
	if (settings_.tile_size != settings.tile_size || settings_.bottom != settings.bottom ||
			settings_.top != settings.top) {
		for (std::uint32_t slot = 0; slot < tiles_.slots().size(); ++slot) {
			if (const StreamedTile &tile = tiles_[slot]; tile.exists) {
				cancel(slot, r_changes);
				if (tile.visible) {
					retired_.push_back({key(tile.at), space(tile.at)});
				}
			}
		}
		tiles_.clear();
		viewer_states_.clear();
		counts_ = {};
		grid_ = new_grid;
	}
	const bool same_ground = settings_.center == settings.center && settings_.nearest == settings.nearest &&
			settings_.farthest == settings.farthest;
	settings_ = settings;
	if (!same_ground) {
		begin_anew(); // Cubes that had no ground before may have some now.
	}
}

void LayerTiles::invalidate(const Rect &area) {
	for (std::uint32_t slot = 0; slot < tiles_.slots().size(); ++slot) {
		if (tiles_[slot].exists && touch(space(tiles_[slot].at), area)) {
			const bool queued = !tiles_[slot].current;
			change(slot, [](StreamedTile &tile) {
				tile.current = false;
				tile.late = tile.ticket != 0;
			});
			if (queued) {
				// The tile is already queued. Queuing it again would fill the queues while a user
				// drags a slider.
				continue;
			}
			queue_up(slot);
		}
	}
}

void LayerTiles::drop_unseen(const Rect &area, StreamChanges &r_changes) {
	if (viewer_states_.empty()) {
		return; // The views are unknown until the next call to `update_viewers`.
	}
	for (std::uint32_t slot = 0; slot < tiles_.slots().size(); ++slot) {
		const StreamedTile &tile = tiles_[slot];
		if (tile.exists && tile.visible && touch(space(tile.at), area) && !seen(tile.at)) {
			release(slot, r_changes);
		}
	}
}

void LayerTiles::cancel_all(StreamChanges &r_changes) {
	for (std::uint32_t slot = 0; slot < tiles_.slots().size(); ++slot) {
		const StreamedTile &tile = tiles_[slot];
		if (!tile.exists || tile.ticket == 0) {
			continue;
		}
		cancel(slot, r_changes);
		if (tile.visible || seen(tile.at)) {
			queue_up(slot);
		} else {
			erase(slot);
		}
	}
}

void LayerTiles::clear(StreamChanges &r_changes) {
	for (std::uint32_t slot = 0; slot < tiles_.slots().size(); ++slot) {
		if (tiles_[slot].exists) {
			release(slot, r_changes);
		}
	}
	for (const Retired &retired : retired_) {
		r_changes.drop.push_back(retired.key);
	}
	forget();
}

void LayerTiles::forget() {
	tiles_.clear();
	viewer_states_.clear();
	retired_.clear();
	ready_slots_.clear();
	counts_ = {};
	torn_ = sweeping_ = false;
}

bool LayerTiles::update_viewers(std::span<const TrackedViewer> viewers, std::size_t &r_new, StreamChanges &r_changes) {
	if (torn_) {
		begin_anew();
	}
	torn_ = true; // Reset when this function completes.
	const bool updated = check_all(viewers, r_new, r_changes);
	if (sweeping_ && !behind_) {
		leave_all(r_changes);
		sweeping_ = false;
	}
	torn_ = false;
	return updated;
}

/// Treats all viewers as new, but keeps the tiles.
void LayerTiles::begin_anew() {
	viewer_states_.clear();
	first_viewer_ = 0;
	sweeping_ = true;
}

/// Releases tiles outside every viewer's keep range, the range of distances in which tiles are
/// kept. Outdated tiles within that range are queued.
void LayerTiles::leave_all(StreamChanges &r_changes) {
	for (std::uint32_t slot = 0; slot < tiles_.slots().size(); ++slot) {
		const StreamedTile &tile = tiles_[slot];
		if (tile.exists && !in_keep_range(tile.at)) {
			release(slot, r_changes);
		} else if (tile.exists && !tile.begun() && !(seen(tile.at) && settings_.may_have_ground(space(tile.at)))) {
			erase(slot);
		} else if (tile.exists && tile.begun() && !tile.current) {
			add_to_queues(slot);
		}
	}
}

bool LayerTiles::check_all(std::span<const TrackedViewer> viewers, std::size_t &r_new, StreamChanges &r_changes) {
	const std::size_t count = std::max(viewer_states_.size(), viewers.size());
	viewer_states_.resize(count);
	bool updated = false;
	behind_ = false;
	for (std::size_t offset = 0; offset < count; ++offset) {
		const std::size_t index = (first_viewer_ + offset) % count;
		const TrackedViewer *viewer = index < viewers.size() ? &viewers[index] : nullptr;
		ViewerState &state = viewer_states_[index];
		if (is_where(state, viewer != nullptr ? &viewer->now : nullptr)) {
			// The view is extended by slack_tiles, so no new tile has come into view.
			continue;
		}
		if (r_new >= max_new && viewer != nullptr) {
			first_viewer_ = behind_ ? first_viewer_ : index;
			behind_ = true;
			continue;
		}
		const std::size_t before = tiles_.size();
		move(state, viewer);
		enter(state);
		r_new += tiles_.size() - before;
		updated = true;
	}
	// All tiles are added before any is removed, because a tile that leaves one viewer's range may
	// enter another's.
	for (ViewerState &state : viewer_states_) {
		if (std::exchange(state.moved, false)) {
			leave(state, r_changes);
		}
	}
	viewer_states_.resize(viewers.size());
	return updated;
}

/// Returns a viewer's view distance in this layer, in meters.
double LayerTiles::view_of(const Viewer &viewer) const {
	return std::min(settings_.view_distance * viewer.radius_scale, settings_.view_tile_limit() * settings_.tile_size);
}

/// Returns the position from which distances to this layer's tiles are measured. The viewer's
/// height is used only if the tiles are cubes.
glm::dvec3 LayerTiles::position_of(const Viewer &viewer) const {
	return {viewer.position.x, settings_.in_space() ? viewer.height : 0.0, viewer.position.y};
}

/// Returns true if a viewer still has the view distance that `state` recorded and is within the
/// slack of the recorded position. `viewer` is null for a removed viewer; the function then returns
/// true if `state` has already been cleared.
bool LayerTiles::is_where(const ViewerState &state, const Viewer *viewer) const {
	if (viewer == nullptr) {
		return state.seen < 0.0;
	}
	const double slack = slack_tiles * settings_.tile_size;
	const glm::dvec3 step = position_of(*viewer) - state.position;
	return state.seen == view_of(*viewer) + slack && glm::dot(step, step) <= slack * slack;
}

bool LayerTiles::follows(std::span<const Viewer> viewers) const {
	return std::ranges::equal(viewer_states_, viewers,
			[this](const ViewerState &state, const Viewer &viewer) { return is_where(state, &viewer); });
}

/// Updates a viewer's position, view and keep range. `viewer` is null if it was removed.
void LayerTiles::move(ViewerState &state, const TrackedViewer *viewer) {
	sort(state); // Limits the size of a queue that has not been sorted since the last move.
	std::swap(state.view, state.old_view);
	std::swap(state.keep, state.old_keep);
	state.moved = true;
	if (viewer == nullptr) {
		state.seen = -1.0;
		state.view.clear();
		state.keep.clear();
		return;
	}
	const double size = settings_.tile_size;
	const double view = view_of(viewer->now);
	const glm::dvec3 position = position_of(viewer->now);
	const glm::dvec3 step = position - state.position;
	state.queue.move(std::sqrt(glm::dot(step, step)));
	state.position = position;
	state.seen = view + slack_tiles * size;
	state.view.set(settings_, state.position, state.seen);
	state.keep.set(settings_, state.position, keep_factor * view + size);
}

void LayerTiles::enter(ViewerState &state) {
	state.view.visit_without(state.old_view, [&](glm::ivec3 at) {
		if (!settings_.may_have_ground(space(at))) {
			return;
		}
		const std::size_t before = tiles_.size();
		reserve_more(ready_slots_, before + 1 - ready_slots_.size()); // The memory for `ready` is reserved here.
		const std::uint32_t slot = tiles_.find_or_add(at);
		counts_.waiting += tiles_.size() - before;
		if (!tiles_[slot].current) {
			state.queue.add(slot, at);
		}
	});
}

void LayerTiles::leave(const ViewerState &state, StreamChanges &r_changes) {
	state.old_view.visit_without(state.view, [&](glm::ivec3 at) {
		// A tile that has not been started yet is not needed outside the view.
		const std::uint32_t slot = tiles_.find(at);
		if (slot != TileTable::none && !tiles_[slot].begun() && !seen(at)) {
			erase(slot);
		}
	});
	state.old_keep.visit_without(state.keep, [&](glm::ivec3 at) {
		const std::uint32_t slot = tiles_.find(at);
		if (slot == TileTable::none) {
			return;
		}
		if (!in_keep_range(at)) {
			release(slot, r_changes);
		} else if (tiles_[slot].begun() && !tiles_[slot].current) {
			add_to_queues(slot); // The tile may have been only in this viewer's queue.
		}
	});
}

bool LayerTiles::seen(glm::ivec3 at) const {
	return std::ranges::any_of(viewer_states_, [at](const ViewerState &state) { return state.view.contains(at); });
}

bool LayerTiles::in_keep_range(glm::ivec3 at) const {
	return std::ranges::any_of(viewer_states_, [at](const ViewerState &state) { return state.keep.contains(at); });
}

/// Removes a tile and records the changes for the caller.
void LayerTiles::release(std::uint32_t slot, StreamChanges &r_changes) {
	if (tiles_[slot].visible) {
		r_changes.drop.push_back(key(tiles_[slot].at)); // This statement comes first, because it may throw.
	}
	cancel(slot, r_changes);
	erase(slot);
}

void LayerTiles::cancel(std::uint32_t slot, StreamChanges &r_changes) {
	if (tiles_[slot].ticket == 0) {
		return;
	}
	// If memory runs out, the caller is not notified and finishes work whose answer is rejected.
	static_cast<void>(guarded("cancel", 1.0, [&] { r_changes.cancel.push_back(request_of(slot)); }));
	forget_ready(slot);
	change(slot, [](StreamedTile &tile) {
		tile.ticket = 0;
		tile.late = false;
	});
}

void LayerTiles::drop_covered(StreamChanges &r_changes) {
	reserve_more(r_changes.drop, retired_.size());
	std::erase_if(retired_, [&](const Retired &retired) {
		const bool covered = !is_missing_under(retired.space);
		if (covered) {
			r_changes.drop.push_back(retired.key);
		}
		return covered;
	});
}

/// Returns true if any wanted tile that touches `under` is not shown yet.
bool LayerTiles::is_missing_under(const TileSpace &under) const {
	const auto is_missing = [&](const StreamedTile &tile) {
		return tile.exists && !tile.visible && touch(space(tile.at), under);
	};
	const glm::ivec2 first = tile_at(settings_.tile_size, under.min);
	const glm::ivec2 last = tile_at(settings_.tile_size, under.max);
	const double tiles = (static_cast<double>(last.x) - first.x + 1.0) * (static_cast<double>(last.y) - first.y + 1.0);
	if (settings_.in_space() || tiles > static_cast<double>(tiles_.size())) {
		// Searches the table for cubes, and if it has fewer tiles than `under` touches.
		return std::ranges::any_of(tiles_.slots(), is_missing);
	}
	for (int y = first.y; y <= last.y; ++y) {
		for (int x = first.x; x <= last.x; ++x) {
			const std::uint32_t slot = tiles_.find({x, y, all_slabs});
			if (slot != TileTable::none && is_missing(tiles_[slot])) {
				return true;
			}
		}
	}
	return false;
}

} // namespace thicket
