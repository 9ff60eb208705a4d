// How tiles are divided for drawing: near ones into cells, each with its own box, mesh and share, and far ones not at all.

#include "nodes/common/property_check.hpp"
#include "nodes/drawing/tile_display.hpp"

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

// The largest upload of one step, so that it takes a small part of a frame's time.
constexpr std::size_t cells_per_step = 4;
constexpr std::size_t instances_per_step = 4096;

} // namespace

/// Prepares a part for the upload of its cells. False if there is not enough memory.
bool TileDisplay::begin_part(const DisplayedTile &tile, std::shared_ptr<const CompactMesh> shown,
		std::vector<MeshLook> lods, std::uint32_t across, DisplayedTile::Part &r_part) const {
	r_part.shown = std::move(shown);
	r_part.lods = std::move(lods);
	if (across == 1 || r_part.lods.empty()) {
		return true;
	}
	const Status status = divide(*r_part.shown, tile.tile->origin, tile.rect, across, r_part.division);
	report("TerrainScatter3D", status);
	return status.ok();
}

TileVisual TileDisplay::make_visual(const DisplayedTile &tile, const DisplayedTile::Part &part,
		const LayerDrawing &drawing, const MeshUpload &upload) {
	VisualContext context = context_;
	context.origin = tile.tile->origin;
	TileVisual visual(context, tile.settings->instance_data, part.lods, upload);
	visual.apply(drawing);
	++upload_count_;
	return visual;
}

DisplayedTile::Cell TileDisplay::make_cell(const DisplayedTile &tile, const DisplayedTile::Part &part,
		const LayerDrawing &drawing, const MeshUpload &upload) {
	DisplayedTile::Cell cell(make_visual(tile, part, drawing, upload));
	cell.set_box(upload.aabb);
	return cell;
}

/// Uploads some more cells of a part, hidden.
void TileDisplay::upload_cells(
		const DisplayedTile &tile, std::size_t mesh, const LayerDrawing &drawing, DisplayedTile::Part &r_part) {
	const std::size_t all = r_part.cell_count();
	std::size_t instances = 0;
	for (std::size_t cells = 0; cells < cells_per_step && instances < instances_per_step; ++cells) {
		const std::size_t next = r_part.cells.size();
		if (next >= all) {
			return;
		}
		instances += r_part.ranks_of(next).size();
		r_part.cells.push_back(make_cell(tile, r_part, drawing, to_upload(r_part, next, tile.reach_of(mesh))));
	}
}

/// The wanted division of a tile that currently has the division `shown`; 0 for a tile that is not visible.
std::uint32_t TileDisplay::division_of(const TileKey &key, const DisplayedTile &tile, std::uint32_t shown) const {
	const LayerSnapshot *layer = layer_at(key.layer);
	return layer != nullptr && tile.draws_anything()
			? division_at(layer->cells, layer->lod, distance_to(key.layer, tile), shown)
			: 1;
}

double TileDisplay::TileMeasures::distance(const TileKey &key) const {
	return display_.distance_to(key.layer, tile(key));
}

std::uint32_t TileDisplay::TileMeasures::wanted(const TileKey &key) const {
	return display_.division_of(key, tile(key), tile(key).across);
}

bool TileDisplay::settled() const {
	return schedule_.settled() && !has_divisions() && !has_fades() && leaving_hidden_ == leaving_.size();
}

bool TileDisplay::divide_step() {
	if (!divisions_.current() && !divisions_.begin(TileMeasures(*this), all_multimeshes())) {
		return false;
	}
	continue_division();
	return true;
}

/// Uploads some cells of the tile that is being divided; shows them once all are uploaded.
void TileDisplay::continue_division() {
	const auto [key, across] = *divisions_.current();
	DisplayedTile &tile = tiles_.at(key);
	const LayerSnapshot *layer = layer_at(key.layer);
	if (layer == nullptr) {
		cancel_division();
		return;
	}
	const auto is_open = [this] {
		return !next_parts_.empty() && next_parts_.back().is_open();
	};
	if (!is_open() && next_parts_.size() == tile.parts.size()) {
		if (upload_others(key, tile, next_parts_)) {
			finish_division(tile);
		}
		return;
	}
	if (!is_open()) {
		const DisplayedTile::Part &part = tile.parts[next_parts_.size()];
		next_parts_.emplace_back();
		if (!begin_part(tile, part.shown, part.lods, across, next_parts_.back())) {
			cancel_division(); // There is no memory now: the next visit of the tile requests it again.
			return;
		}
	}
	if (is_open()) {
		upload_cells(tile, next_parts_.size() - 1, layer->drawing, next_parts_.back());
	}
}

/// Does everything in one call, so that no frame is drawn in between: shows the uploaded cells as they should be drawn, and hides the
/// previous ones.
void TileDisplay::finish_division(DisplayedTile &r_tile) {
	const auto [key, across] = *divisions_.current();
	std::vector<DisplayedTile::Part> next = std::exchange(next_parts_, {});
	const std::size_t before = r_tile.cell_count();
	budget_.remove(r_tile.amounts());
	r_tile.set_visible(false);
	const std::size_t lod = r_tile.finest_lod();
	for (std::size_t mesh = 0; mesh < next.size(); ++mesh) {
		std::swap(r_tile.parts[mesh].cells, next[mesh].cells);
		std::swap(r_tile.parts[mesh].division, next[mesh].division);
		leave(std::move(next[mesh].cells));
	}
	r_tile.across = across;
	r_tile.look_at_all = true;
	r_tile.set_lod(lod);
	divisions_.finish();
	budget_.add(r_tile.amounts());
	refine(key, r_tile);
	r_tile.set_visible(visible_);
	if (r_tile.cell_count() < before) {
		divisions_.room_gained(TileMeasures(*this));
	}
}

void TileDisplay::cancel_division() {
	for (DisplayedTile::Part &part : next_parts_) {
		leave(std::move(part.cells));
	}
	next_parts_.clear();
	divisions_.cancel();
}

} // namespace thicket
