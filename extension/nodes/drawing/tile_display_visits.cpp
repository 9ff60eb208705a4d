// This file updates displayed tiles when viewers move or limits change. It determines which tiles
// to update and when.

#include "nodes/drawing/tile_display.hpp"

#include <optional>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The approximate number of multimeshes that one step checks, which takes a few microseconds. Few
/// of the checked tiles need a change.
constexpr std::size_t cells_per_step = 32;

} // namespace

void TileDisplay::count_drawn(DrawCounter &r_counter) const {
	for (const auto &[key, tile] : tiles_) {
		const glm::dvec3 origin = tile.tile->origin;
		for (const DisplayedTile::Part &part : tile.parts) {
			for (const DisplayedTile::Cell &cell : part.cells) {
				const glm::dvec3 min = origin + glm::dvec3(cell.min);
				const glm::dvec3 max = origin + glm::dvec3(cell.max);
				r_counter.add(cell.visual.mesh(), visible_ ? cell.drawing.drawn_count : 0, min, max);
				for (const TileVisual &extra_visual : cell.extra_visuals) {
					r_counter.add(extra_visual.mesh(), visible_ ? extra_visual.drawn_count() : 0, min, max);
				}
			}
		}
	}
}

void TileDisplay::set_viewers(std::span<const Viewer> viewers) {
	const bool viewers_jumped = schedule_.move(viewers);
	if (budget_.begin_frame() || viewers_jumped) {
		visit_all();
	}
	for (const TileKey &key : budget_.take_cut()) {
		if (const auto entry = tiles_.find(key); entry != tiles_.end()) {
			entry->second.check_all_cells = true;
			schedule_.add(key, 0.0);
		}
	}
}

void TileDisplay::visit_all() {
	schedule_.clear();
	budget_.take_cut(); // All tiles are visited below, including the cut ones.
	for (auto &[key, tile] : tiles_) {
		tile.check_all_cells = true;
		schedule_.add(key, 0.0);
	}
}

bool TileDisplay::lod_step() {
	std::size_t visited_cells = 0;
	while (visited_cells < cells_per_step) {
		const std::optional<TileKey> key = schedule_.next();
		if (!key) {
			break;
		}
		if (const auto entry = tiles_.find(*key); entry != tiles_.end()) {
			refine(*key, entry->second);
			visited_cells += entry->second.cell_count() + 1;
		}
	}
	return visited_cells > 0;
}

void TileDisplay::apply_drawing(const TileKey &key, DisplayedTile &r_tile) {
	if (r_tile.drawing_version == layers_.version(key.layer)) {
		// The renderer already has these settings.
		return;
	}
	r_tile.drawing_version = layers_.version(key.layer);
	++redrawn_count_;
	for (DisplayedTile::Part &part : r_tile.parts) {
		for (DisplayedTile::Cell &cell : part.cells) {
			cell.for_each_visual([&](TileVisual &visual) { visual.apply(layers_.find(key.layer)->drawing); });
		}
	}
}

Sight TileDisplay::sight_of(std::uint32_t layer) const {
	const LayerSnapshot *snapshot = layers_.find(layer);
	return snapshot != nullptr ? snapshot->lod.sight() : Sight();
}

DistanceRange TileDisplay::distances_to(std::uint32_t layer, const DisplayedTile &tile) const {
	const glm::dvec3 origin = tile.tile->origin;
	return schedule_.distances_to(origin + glm::dvec3(tile.min), origin + glm::dvec3(tile.max), sight_of(layer));
}

double TileDisplay::average_height() const {
	double sum = 0.0;
	std::size_t count = 0;
	for (const auto &[key, tile] : tiles_) {
		if (tile.draws_anything()) {
			sum += tile.tile->origin.y + 0.5 * (static_cast<double>(tile.min.y) + static_cast<double>(tile.max.y));
			++count;
		}
	}
	return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

/// Updates a tile to its layer's settings and its distance, and schedules its next visit.
void TileDisplay::refine(const TileKey &key, DisplayedTile &r_tile) {
	const LayerSnapshot *layer = layers_.find(key.layer);
	if (!r_tile.draws_anything() || layer == nullptr) {
		schedule_.remove(key);
		return;
	}
	apply_drawing(key, r_tile);
	const DistanceRange distance = distances_to(key.layer, r_tile);
	double margin = 0.0;
	if (!drawer_.draw(key, r_tile, margin)) {
		budget_.record_cut(key);
	}
	r_tile.check_all_cells = false;
	if (drawer_.lacks_visuals(key, r_tile) && !std::exchange(r_tile.needs_fade_visuals, true)) {
		tiles_to_fade_.push_back(key);
	}
	divisions_.choose(key, r_tile.cells_per_edge, division_of(key, r_tile, r_tile.cells_per_edge));
	const double cell_size = r_tile.cells_per_edge > 1 ? r_tile.space.size().x / r_tile.cells_per_edge : 0.0;
	schedule_.add(key, visit_margin(margin, cell_size, division_margin(layer->cells, layer->lod, distance.near)));
}

bool TileDisplay::fade_step() {
	bool chain_completed = false;
	if (drawer_.fades().make_some(chain_completed)) {
		if (chain_completed) {
			visit_all();
		}
		return true;
	}
	if (tiles_to_fade_.empty()) {
		return false;
	}
	const TileKey key = tiles_to_fade_.back();
	DisplayedTile &tile = tiles_.at(key);
	if (layers_.find(key.layer) == nullptr || drawer_.add_visuals(key, tile)) {
		tile.needs_fade_visuals = false;
		tiles_to_fade_.pop_back();
	}
	return true;
}

} // namespace thicket
