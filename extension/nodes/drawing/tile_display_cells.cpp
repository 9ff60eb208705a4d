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

/// If there is no room for all cells, a tile that is farther than another by this factor gives way to it.
constexpr double gives_way = 1.1;

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

/// Queues a tile for a new division, if its distance requires one.
void TileDisplay::choose_division(const TileKey &key, DisplayedTile &r_tile) {
	const bool under_way = division_ && division_->key == key;
	if (!r_tile.to_divide && !under_way && division_of(key, r_tile, r_tile.across) != r_tile.across) {
		r_tile.to_divide = true;
		to_divide_.push_back(key);
	}
}

bool TileDisplay::settled() const {
	return schedule_.settled() && !has_divisions() && !has_fades() && leaving_hidden_ == leaving_.size();
}

bool TileDisplay::divide_step() {
	if (!division_ && !begin_division()) {
		return false;
	}
	if (division_) {
		continue_division();
	}
	return true;
}

/// Chooses the nearest of the waiting tiles. False if none waits; a tile for which there is no room stops waiting.
bool TileDisplay::begin_division() {
	if (over_limit()) {
		const Order farthest = *cells_beyond(-1.0).farthest;
		division_ = Division{key_of(farthest), 1, {}};
		return true;
	}
	while (!to_divide_.empty()) {
		double nearest = 0.0;
		std::size_t chosen = to_divide_.size();
		for (std::size_t at = 0; at < to_divide_.size(); ++at) {
			const double distance = distance_to(to_divide_[at].layer, tiles_.at(order(to_divide_[at])));
			if (chosen == to_divide_.size() || distance < nearest) {
				chosen = at;
				nearest = distance;
			}
		}
		const TileKey key = to_divide_[chosen];
		if (begin_division_of(key, tiles_.at(order(key)))) {
			return true;
		}
	}
	return false;
}

/// Divides a waiting tile, or makes room for it. False if it is to stay unchanged: it stops waiting.
bool TileDisplay::begin_division_of(const TileKey &key, DisplayedTile &r_tile) {
	const std::uint32_t across = division_of(key, r_tile, r_tile.across);
	const std::uint64_t rest = multimeshes_ - r_tile.multimesh_count();
	const std::uint64_t then = rest + r_tile.most_multimeshes(across);
	const bool grows = across > r_tile.across && then > limits_.max_multimeshes;
	if (grows) {
		const FartherCells farther = cells_beyond(gives_way * distance_to(key.layer, r_tile));
		if (then - limits_.max_multimeshes <= farther.spare) {
			division_ = Division{key_of(*farther.farthest), 1, {}};
			return true;
		}
	}
	r_tile.to_divide = false;
	std::erase(to_divide_, key);
	if (grows && std::ranges::find(denied_, key) == denied_.end()) {
		denied_.push_back(key);
	}
	if (grows || across == r_tile.across) {
		return false;
	}
	division_ = Division{key, across, {}};
	return true;
}

/// The tiles in cells that are farther away than `distance`.
TileDisplay::FartherCells TileDisplay::cells_beyond(double distance) const {
	FartherCells result;
	double farthest = distance;
	for (const Order &at : divided_) {
		const DisplayedTile &tile = tiles_.at(at);
		const double its = distance_to(std::get<0>(at), tile);
		if (its > distance) {
			result.spare += tile.multimesh_count() - std::min(tile.multimesh_count(), tile.most_multimeshes(1));
		}
		if (its > farthest) {
			farthest = its;
			result.farthest = &at;
		}
	}
	return result;
}

/// Uploads some cells of the tile that is being divided; shows them once all are uploaded.
void TileDisplay::continue_division() {
	Division &next = *division_;
	DisplayedTile &tile = tiles_.at(order(next.key));
	const LayerSnapshot *layer = layer_at(next.key.layer);
	if (layer == nullptr) {
		cancel_division();
		return;
	}
	const auto is_open = [&next] {
		return !next.parts.empty() && next.parts.back().is_open();
	};
	if (!is_open() && next.parts.size() == tile.parts.size()) {
		if (upload_others(next.key, tile, next.parts)) {
			finish_division(tile);
		}
		return;
	}
	if (!is_open()) {
		const DisplayedTile::Part &part = tile.parts[next.parts.size()];
		next.parts.emplace_back();
		if (!begin_part(tile, part.shown, part.lods, next.across, next.parts.back())) {
			cancel_division(); // There is no memory now: the next visit of the tile requests it again.
			return;
		}
	}
	if (is_open()) {
		upload_cells(tile, next.parts.size() - 1, layer->drawing, next.parts.back());
	}
}

/// Does everything in one call, so that no frame is drawn in between: shows the uploaded cells as they should be drawn, and hides the
/// previous ones.
void TileDisplay::finish_division(DisplayedTile &r_tile) {
	Division next = std::move(*division_);
	division_.reset();
	const std::size_t before = r_tile.cell_count();
	uncount(r_tile);
	r_tile.set_visible(false);
	const std::size_t lod = r_tile.finest_lod();
	for (std::size_t mesh = 0; mesh < next.parts.size(); ++mesh) {
		std::swap(r_tile.parts[mesh].cells, next.parts[mesh].cells);
		std::swap(r_tile.parts[mesh].division, next.parts[mesh].division);
		leave(std::move(next.parts[mesh].cells));
	}
	r_tile.across = next.across;
	r_tile.look_at_all = true;
	r_tile.set_lod(lod);
	note_division(order(next.key), r_tile);
	count(r_tile);
	refine(next.key, r_tile);
	r_tile.set_visible(visible_);
	if (r_tile.cell_count() < before) {
		multimeshes_gone();
	}
}

void TileDisplay::cancel_division() {
	if (division_) {
		for (DisplayedTile::Part &part : division_->parts) {
			leave(std::move(part.cells));
		}
		division_.reset();
	}
}

void TileDisplay::note_division(const Order &at, const DisplayedTile &tile) {
	if (tile.across > 1) {
		divided_.insert(at);
	} else {
		divided_.erase(at);
	}
}

/// There may now be room for tiles that were denied before.
void TileDisplay::multimeshes_gone() {
	for (const TileKey &key : std::exchange(denied_, {})) {
		if (const auto found = tiles_.find(order(key)); found != tiles_.end()) {
			choose_division(key, found->second);
		}
	}
}

} // namespace thicket
