#include "core/streaming/layer_tiles.hpp"

#include "core/base/tile_grid.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

namespace thicket {

namespace {

/// How far a viewer may move, in tiles, before its tiles are looked at again; wanted tiles are looked for so much
/// farther out that none in view is missed in between.
constexpr double slack_tiles = 0.125;

/// A tile is kept out to this many view distances, and one tile more.
constexpr double keep_factor = 1.1;

bool row_order(glm::ivec2 a, glm::ivec2 b) { return a.y != b.y ? a.y < b.y : a.x < b.x; }

bool touch(const Rect &a, const Rect &b) {
	return a.min.x < b.max.x && b.min.x < a.max.x && a.min.y < b.max.y && b.min.y < a.max.y;
}

} // namespace

void LayerTiles::configure(const StreamLayer &settings, std::uint32_t new_grid, StreamChanges &r_changes) {
	changed_ = changed_ || settings_ != settings;
	if (settings_.tile_size != settings.tile_size) {
		for (Tile &tile : tiles_) {
			cancel(tile, r_changes);
			if (tile.shown) {
				retired_.push_back({key(tile.at), tile_rect(settings_.tile_size, tile.at)});
			}
		}
		tiles_.clear();
		grid_ = new_grid;
	}
	settings_ = settings;
}

void LayerTiles::invalidate(const Rect &area) {
	for (Tile &tile : tiles_) {
		if (touch(tile_rect(settings_.tile_size, tile.at), area)) {
			tile.current = false;
			tile.late = tile.ticket != 0;
		}
	}
}

void LayerTiles::cancel_all(StreamChanges &r_changes) {
	for (Tile &tile : tiles_) {
		cancel(tile, r_changes);
	}
}

void LayerTiles::clear(StreamChanges &r_changes) {
	for (const Tile &tile : tiles_) {
		release(tile, r_changes);
	}
	for (const Retired &retired : retired_) {
		r_changes.drop.push_back(retired.key);
	}
	tiles_.clear();
	retired_.clear();
	changed_ = true;
}

bool LayerTiles::look(std::span<const Viewer> viewers, StreamChanges &r_changes) {
	if (!changed_ && viewers_stayed(viewers)) {
		return false;
	}
	changed_ = false;
	viewers_.assign(viewers.begin(), viewers.end());
	find_wanted();

	// Both lists are in row order: merge them. A tile in both keeps its state.
	merged_.clear();
	auto wanted = wanted_.cbegin();
	for (Tile &tile : tiles_) {
		for (; wanted != wanted_.cend() && row_order(wanted->at, tile.at); ++wanted) {
			merged_.push_back(*wanted);
		}
		const bool is_wanted = wanted != wanted_.cend() && wanted->at == tile.at;
		const Rect rect = tile_rect(settings_.tile_size, tile.at);
		// Out of view there is no reason to begin a tile, only to keep what has been begun.
		const bool is_begun = tile.shown || tile.ticket != 0;
		if (is_wanted || (is_begun && kept(rect))) {
			tile.distance_squared = nearest_squared(rect);
			merged_.push_back(tile);
		} else {
			release(tile, r_changes);
		}
		wanted += is_wanted ? 1 : 0;
	}
	merged_.insert(merged_.end(), wanted, wanted_.cend());
	tiles_.swap(merged_);
	return true;
}

bool LayerTiles::viewers_stayed(std::span<const Viewer> viewers) const {
	const double slack = slack_tiles * settings_.tile_size;
	return std::ranges::equal(viewers, viewers_, [slack](const Viewer &now, const Viewer &then) {
		const glm::dvec2 moved = now.position - then.position;
		return now.radius_scale == then.radius_scale && moved.x * moved.x + moved.y * moved.y <= slack * slack;
	});
}

/// The tiles in view of any viewer, once each, into `wanted_`.
void LayerTiles::find_wanted() {
	const double size = settings_.tile_size;
	wanted_.clear();
	for (const Viewer &viewer : viewers_) {
		const double reach = settings_.view_distance * viewer.radius_scale + slack_tiles * size;
		const glm::ivec2 first = tile_at(size, viewer.position - reach);
		const glm::ivec2 last = tile_at(size, viewer.position + reach);
		for (int y = first.y; y <= last.y; ++y) {
			for (int x = first.x; x <= last.x; ++x) {
				const double squared = distance_squared(tile_rect(size, {x, y}), viewer.position);
				if (squared <= reach * reach) {
					wanted_.push_back({.at = {x, y}, .distance_squared = squared});
				}
			}
		}
	}
	if (viewers_.size() == 1) {
		return; // In row order already.
	}
	// The nearest first among equals, so that it is the one that stays.
	std::ranges::sort(wanted_, [](const Tile &a, const Tile &b) {
		return a.at != b.at ? row_order(a.at, b.at) : a.distance_squared < b.distance_squared;
	});
	const auto same_tile = [](const Tile &a, const Tile &b) {
		return a.at == b.at;
	};
	wanted_.erase(std::unique(wanted_.begin(), wanted_.end(), same_tile), wanted_.end());
}

double LayerTiles::nearest_squared(const Rect &rect) const {
	double nearest = std::numeric_limits<double>::infinity();
	for (const Viewer &viewer : viewers_) {
		nearest = std::min(nearest, distance_squared(rect, viewer.position));
	}
	return nearest;
}

/// Whether a tile that is begun is near enough to a viewer to be kept.
bool LayerTiles::kept(const Rect &rect) const {
	return std::ranges::any_of(viewers_, [&](const Viewer &viewer) {
		const double reach = keep_factor * settings_.view_distance * viewer.radius_scale + settings_.tile_size;
		return distance_squared(rect, viewer.position) <= reach * reach;
	});
}

/// Says what has to be undone for a tile that goes.
void LayerTiles::release(const Tile &tile, StreamChanges &r_changes) {
	Tile gone = tile;
	cancel(gone, r_changes);
	if (tile.shown) {
		r_changes.drop.push_back(key(tile.at));
	}
}

void LayerTiles::cancel(Tile &tile, StreamChanges &r_changes) {
	if (tile.ticket != 0) {
		r_changes.cancel.push_back({key(tile.at), tile_rect(settings_.tile_size, tile.at), tile.ticket});
		tile.ticket = 0;
		tile.late = false;
		--pending_;
	}
}

void LayerTiles::drop_covered(StreamChanges &r_changes) {
	std::erase_if(retired_, [&](const Retired &retired) {
		const bool covered = !is_missing_under(retired.rect);
		if (covered) {
			r_changes.drop.push_back(retired.key);
		}
		return covered;
	});
}

/// Whether a tile that touches `rect` is wanted and not yet on show.
bool LayerTiles::is_missing_under(const Rect &rect) const {
	if (tiles_.empty()) {
		return false;
	}
	const glm::ivec2 first = tile_at(settings_.tile_size, rect.min);
	const glm::ivec2 last = tile_at(settings_.tile_size, rect.max);
	// Rows that have tiles at all: a retired tile may be far larger than the tiles that are wanted.
	const int first_row = std::max(first.y, tiles_.front().at.y);
	const int last_row = std::min(last.y, tiles_.back().at.y);
	for (int row = first_row; row <= last_row; ++row) {
		auto tile = std::ranges::lower_bound(tiles_, glm::ivec2(first.x, row), row_order, &Tile::at);
		for (; tile != tiles_.end() && tile->at.y == row && tile->at.x <= last.x; ++tile) {
			if (!tile->shown && touch(tile_rect(settings_.tile_size, tile->at), rect)) {
				return true;
			}
		}
	}
	return false;
}

void LayerTiles::add_waiting(std::vector<Waiting> &r_waiting) const {
	for (const Tile &tile : tiles_) {
		if (tile.waiting()) {
			r_waiting.push_back({tile.distance_squared, layer_, tile.at});
		}
	}
}

TileRequest LayerTiles::request(glm::ivec2 at, std::uint64_t ticket) {
	if (Tile *tile = find(at)) {
		tile->ticket = ticket;
		++pending_;
	}
	return {key(at), tile_rect(settings_.tile_size, at), ticket};
}

bool LayerTiles::finish(const TileRequest &request, bool &r_again) {
	// A ticket is never given twice, so it also tells a tile of this grid from one of another.
	Tile *tile = find(request.key.tile);
	if (tile == nullptr || request.ticket == 0 || tile->ticket != request.ticket) {
		return false;
	}
	tile->ticket = 0;
	tile->shown = true;
	tile->current = !tile->late;
	tile->late = false;
	r_again = !tile->current;
	--pending_;
	return true;
}

LayerTiles::Tile *LayerTiles::find(glm::ivec2 at) {
	const auto found = std::ranges::lower_bound(tiles_, at, row_order, &Tile::at);
	return found != tiles_.end() && found->at == at ? &*found : nullptr;
}

void LayerTiles::count(StreamCounts &r_counts) const {
	for (const Tile &tile : tiles_) {
		r_counts.waiting += tile.waiting() ? 1 : 0;
		r_counts.shown += tile.shown ? 1 : 0;
	}
	r_counts.pending += pending_;
	r_counts.shown += retired_.size();
}

} // namespace thicket
