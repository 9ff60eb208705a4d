#include "core/streaming/layer_tiles.hpp"

#include "core/base/guard.hpp"
#include "core/base/reserve.hpp"
#include "core/base/tile_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

bool touch(const Rect &a, const Rect &b) {
	return a.min.x < b.max.x && b.min.x < a.max.x && a.min.y < b.max.y && b.min.y < a.max.y;
}

} // namespace

StreamCounts LayerTiles::counts() const {
	StreamCounts counts = counts_;
	counts.shown += retired_.size();
	return counts;
}

Rect LayerTiles::rect(glm::ivec2 at) const { return tile_rect(settings_.tile_size, at); }

void LayerTiles::erase(std::uint32_t slot) {
	change(slot, [](StreamedTile &tile) { tile.exists = false; });
	tiles_.erase(slot);
}

void LayerTiles::add_room(std::size_t &r_cancel, std::size_t &r_drop) const {
	r_cancel += counts_.pending;
	r_drop += counts_.shown + retired_.size();
}

void LayerTiles::make_room() { reserve_more(retired_, counts_.shown); }

void LayerTiles::configure(const StreamLayer &settings, std::uint32_t new_grid, StreamChanges &r_changes) {
	if (settings_.tile_size != settings.tile_size) {
		for (std::uint32_t slot = 0; slot < tiles_.slots().size(); ++slot) {
			if (const StreamedTile &tile = tiles_[slot]; tile.exists) {
				cancel(slot, r_changes);
				if (tile.shown) {
					retired_.push_back({key(tile.at), rect(tile.at)});
				}
			}
		}
		tiles_.clear();
		sights_.clear();
		counts_ = {};
		grid_ = new_grid;
	}
	settings_ = settings;
}

void LayerTiles::invalidate(const Rect &area) {
	for (std::uint32_t slot = 0; slot < tiles_.slots().size(); ++slot) {
		if (tiles_[slot].exists && touch(rect(tiles_[slot].at), area)) {
			const bool queued = !tiles_[slot].current;
			change(slot, [](StreamedTile &tile) {
				tile.current = false;
				tile.late = tile.ticket != 0;
			});
			if (queued) {
				// The tile already waits. Otherwise a dragged slider would fill the queues in every frame.
				continue;
			}
			queue_up(slot);
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
		if (tile.shown || seen(tile.at)) {
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
	sights_.clear();
	retired_.clear();
	made_.clear();
	counts_ = {};
	torn_ = sweeping_ = false;
}

bool LayerTiles::look(std::span<const TrackedViewer> viewers, std::size_t &r_new, StreamChanges &r_changes) {
	if (torn_) {
		begin_anew();
	}
	torn_ = true; // Reset when this function completes.
	const bool looked = look_at_all(viewers, r_new, r_changes);
	if (sweeping_ && !behind_) {
		leave_all(r_changes);
		sweeping_ = false;
	}
	torn_ = false;
	return looked;
}

/// Treats all viewers as new. The tiles are kept.
void LayerTiles::begin_anew() {
	sights_.clear();
	first_sight_ = 0;
	sweeping_ = true;
}

/// Releases tiles that no viewer sees or keeps, and queues the tiles that a viewer keeps and that are not current.
void LayerTiles::leave_all(StreamChanges &r_changes) {
	for (std::uint32_t slot = 0; slot < tiles_.slots().size(); ++slot) {
		const StreamedTile &tile = tiles_[slot];
		if (tile.exists && !kept(tile.at)) {
			release(slot, r_changes);
		} else if (tile.exists && !tile.begun() && !seen(tile.at)) {
			erase(slot);
		} else if (tile.exists && tile.begun() && !tile.current) {
			add_to_queues(slot);
		}
	}
}

bool LayerTiles::look_at_all(std::span<const TrackedViewer> viewers, std::size_t &r_new, StreamChanges &r_changes) {
	const std::size_t count = std::max(sights_.size(), viewers.size());
	sights_.resize(count);
	bool looked = false;
	behind_ = false;
	for (std::size_t turn = 0; turn < count; ++turn) {
		const std::size_t index = (first_sight_ + turn) % count;
		const TrackedViewer *viewer = index < viewers.size() ? &viewers[index] : nullptr;
		Sight &sight = sights_[index];
		if (is_where(sight, viewer != nullptr ? &viewer->now : nullptr)) {
			// Within the slack, no tile comes into view that was not seen before.
			continue;
		}
		if (r_new >= max_new && viewer != nullptr) {
			first_sight_ = behind_ ? first_sight_ : index;
			behind_ = true;
			continue;
		}
		const std::size_t before = tiles_.size();
		move(sight, viewer);
		enter(sight);
		r_new += tiles_.size() - before;
		looked = true;
	}
	// All additions come before all removals, because one viewer may enter a tile that a different one leaves.
	for (Sight &sight : sights_) {
		if (std::exchange(sight.moved, false)) {
			leave(sight, r_changes);
		}
	}
	sights_.resize(viewers.size());
	return looked;
}

/// A viewer's view distance in meters.
double LayerTiles::view_of(const Viewer &viewer) const {
	return std::min(settings_.view_distance * viewer.radius_scale, max_view_tiles * settings_.tile_size);
}

/// Whether a viewer (null if it is gone) has the same position, within the slack, and the same view distance as at the last look.
bool LayerTiles::is_where(const Sight &sight, const Viewer *viewer) const {
	if (viewer == nullptr) {
		return sight.seen < 0.0;
	}
	const double slack = slack_tiles * settings_.tile_size;
	const glm::dvec2 step = viewer->position - sight.position;
	return sight.seen == view_of(*viewer) + slack && step.x * step.x + step.y * step.y <= slack * slack;
}

bool LayerTiles::follows(std::span<const Viewer> viewers) const {
	return std::ranges::equal(
			sights_, viewers, [this](const Sight &sight, const Viewer &viewer) { return is_where(sight, &viewer); });
}

/// Stores a viewer's position and view distance.
void LayerTiles::move(Sight &sight, const TrackedViewer *viewer) {
	sort(sight); // It may not have been sorted since the last move. Sorting now limits its size.
	std::swap(sight.view, sight.old_view);
	std::swap(sight.keep, sight.old_keep);
	sight.moved = true;
	if (viewer == nullptr) {
		sight.seen = -1.0;
		sight.view.clear();
		sight.keep.clear();
		return;
	}
	const double size = settings_.tile_size;
	const double view = view_of(viewer->now);
	const glm::dvec2 step = viewer->now.position - sight.position;
	sight.queue.move(std::sqrt(step.x * step.x + step.y * step.y));
	sight.position = viewer->now.position;
	sight.seen = view + slack_tiles * size;
	sight.view.set(size, sight.position, sight.seen);
	sight.keep.set(size, sight.position, keep_factor * view + size);
}

void LayerTiles::enter(Sight &sight) {
	sight.view.visit_without(sight.old_view, [&](glm::ivec2 at) {
		const std::size_t before = tiles_.size();
		reserve_more(made_, before + 1 - made_.size()); // Any of them may become ready.
		const std::uint32_t slot = tiles_.find_or_add(at);
		counts_.waiting += tiles_.size() - before;
		if (!tiles_[slot].current) {
			sight.queue.add(slot, at);
		}
	});
}

void LayerTiles::leave(const Sight &sight, StreamChanges &r_changes) {
	sight.old_view.visit_without(sight.view, [&](glm::ivec2 at) {
		// Out of view, there is no reason to start a tile, only to keep one that was started.
		const std::uint32_t slot = tiles_.find(at);
		if (slot != TileTable::none && !tiles_[slot].begun() && !seen(at)) {
			erase(slot);
		}
	});
	sight.old_keep.visit_without(sight.keep, [&](glm::ivec2 at) {
		const std::uint32_t slot = tiles_.find(at);
		if (slot == TileTable::none) {
			return;
		}
		if (!kept(at)) {
			release(slot, r_changes);
		} else if (tiles_[slot].begun() && !tiles_[slot].current) {
			add_to_queues(slot); // Only this viewer's queue may have had it.
		}
	});
}

bool LayerTiles::seen(glm::ivec2 at) const {
	return std::ranges::any_of(sights_, [at](const Sight &sight) { return sight.view.contains(at); });
}

bool LayerTiles::kept(glm::ivec2 at) const {
	return std::ranges::any_of(sights_, [at](const Sight &sight) { return sight.keep.contains(at); });
}

/// Records the changes needed to remove a tile, and forgets it.
void LayerTiles::release(std::uint32_t slot, StreamChanges &r_changes) {
	if (tiles_[slot].shown) {
		r_changes.drop.push_back(key(tiles_[slot].at)); // First, because it may fail.
	}
	cancel(slot, r_changes);
	erase(slot);
}

void LayerTiles::cancel(std::uint32_t slot, StreamChanges &r_changes) {
	if (tiles_[slot].ticket == 0) {
		return;
	}
	// If memory runs out, the work continues for no purpose: its answer is refused.
	static_cast<void>(guarded("cancel", 1.0, [&] { r_changes.cancel.push_back(request_of(slot)); }));
	forget_made(slot);
	change(slot, [](StreamedTile &tile) {
		tile.ticket = 0;
		tile.late = false;
	});
}

void LayerTiles::drop_covered(StreamChanges &r_changes) {
	reserve_more(r_changes.drop, retired_.size());
	std::erase_if(retired_, [&](const Retired &retired) {
		const bool covered = !is_missing_under(retired.rect);
		if (covered) {
			r_changes.drop.push_back(retired.key);
		}
		return covered;
	});
}

/// Whether a tile that touches `under` is wanted and not shown yet.
bool LayerTiles::is_missing_under(const Rect &under) const {
	const auto is_missing = [&](const StreamedTile &tile) {
		return tile.exists && !tile.shown && touch(rect(tile.at), under);
	};
	const glm::ivec2 first = tile_at(settings_.tile_size, under.min);
	const glm::ivec2 last = tile_at(settings_.tile_size, under.max);
	const double tiles = (static_cast<double>(last.x) - first.x + 1.0) * (static_cast<double>(last.y) - first.y + 1.0);
	if (tiles > static_cast<double>(tiles_.size())) {
		// There are fewer known tiles than tiles that `under` touches.
		return std::ranges::any_of(tiles_.slots(), is_missing);
	}
	for (int y = first.y; y <= last.y; ++y) {
		for (int x = first.x; x <= last.x; ++x) {
			const std::uint32_t slot = tiles_.find({x, y});
			if (slot != TileTable::none && is_missing(tiles_[slot])) {
				return true;
			}
		}
	}
	return false;
}

} // namespace thicket
