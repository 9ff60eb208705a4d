// This file divides tiles for drawing. Near tiles are divided into cells, each with its own bounds,
// mesh and density. Far tiles are drawn as a whole.

#include "nodes/drawing/tile_display.hpp"

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

/// Returns the required division of a tile. `current_division` is 0 for a tile that has not been
/// displayed yet.
std::uint32_t TileDisplay::division_of(
		const TileKey &key, const DisplayedTile &tile, std::uint32_t current_division) const {
	const LayerSnapshot *layer = layers_.find(key.layer);
	return layer != nullptr && tile.draws_anything()
			? division_at(layer->cells, layer->lod, distance_to(key.layer, tile), current_division)
			: 1;
}

double TileDisplay::TileMeasures::distance(const TileKey &key) const {
	return display_.distance_to(key.layer, tile(key));
}

std::uint32_t TileDisplay::TileMeasures::wanted_division(const TileKey &key) const {
	return display_.division_of(key, tile(key), tile(key).cells_per_edge);
}

bool TileDisplay::settled() const {
	return schedule_.settled() && !has_divisions() && !has_fades() && leaving_visuals_.are_hidden();
}

bool TileDisplay::divide_step() {
	if (!divisions_.current() && !divisions_.begin(TileMeasures(*this), total_multimeshes())) {
		return false;
	}
	continue_division();
	return true;
}

/// Uploads some cells of the tile that is being divided. Shows them when all are uploaded.
void TileDisplay::continue_division() {
	const auto [key, cells_per_edge] = *divisions_.current();
	DisplayedTile &tile = tiles_.at(key);
	const LayerSnapshot *layer = layers_.find(key.layer);
	if (layer == nullptr) {
		cancel_division();
		return;
	}
	const auto is_open = [this] {
		return !next_parts_.empty() && next_parts_.back().is_open();
	};
	if (!is_open() && next_parts_.size() == tile.parts.size()) {
		if (drawer_.add_visuals(key, tile, next_parts_)) {
			finish_division(tile);
		}
		return;
	}
	if (!is_open()) {
		const DisplayedTile::Part &part = tile.parts[next_parts_.size()];
		next_parts_.emplace_back();
		if (!TileUploader::divide_part(tile, part.displayed_mesh, part.lods, cells_per_edge, next_parts_.back())) {
			// Out of memory. The next visit of the tile requests the division again.
			cancel_division();
			return;
		}
	}
	if (is_open()) {
		uploader_.upload_cells(tile, next_parts_.size() - 1, layer->drawing, next_parts_.back());
	}
}

/// Shows the uploaded cells and hides the previous ones. Does both in one call, so that no frame is
/// drawn in between.
void TileDisplay::finish_division(DisplayedTile &r_tile) {
	const auto [key, cells_per_edge] = *divisions_.current();
	std::vector<DisplayedTile::Part> next = std::exchange(next_parts_, {});
	const std::size_t previous_count = r_tile.cell_count();
	budget_.remove(r_tile.amounts());
	r_tile.set_visible(false);
	const std::size_t lod = r_tile.finest_lod();
	for (std::size_t mesh = 0; mesh < next.size(); ++mesh) {
		std::swap(r_tile.parts[mesh].cells, next[mesh].cells);
		std::swap(r_tile.parts[mesh].division, next[mesh].division);
		release_visuals(std::move(next[mesh].cells));
	}
	r_tile.cells_per_edge = cells_per_edge;
	r_tile.check_all_cells = true;
	r_tile.set_lod(lod);
	divisions_.finish();
	budget_.add(r_tile.amounts());
	refine(key, r_tile);
	r_tile.set_visible(visible_);
	if (r_tile.cell_count() < previous_count) {
		divisions_.capacity_gained(TileMeasures(*this));
	}
}

void TileDisplay::cancel_division() {
	for (DisplayedTile::Part &part : next_parts_) {
		release_visuals(std::move(part.cells));
	}
	next_parts_.clear();
	divisions_.cancel();
}

} // namespace thicket
