// This file applies a game's changes to the displayed tiles: removed and hand-placed instances, and
// instances that other code draws.

#include "core/base/guard.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/drawing/tile_display.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <new>
#include <optional>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

bool same_instances(const CompactMesh &a, const CompactMesh &b) {
	bool equal = a.size() == b.size();
	for (std::size_t i = 0; equal && i < a.size(); ++i) {
		equal = a.same(i, b, i);
	}
	return equal;
}

/// Determines for each cell of `next` which cell of `part` it can reuse.
std::vector<CellReuse> reuse_cells(const DisplayedTile::Part &part, const DisplayedTile::Part &next, bool is_whole) {
	if (!is_whole) {
		return thicket::reuse_cells(*part.displayed_mesh, part.division, *next.displayed_mesh, next.division);
	}
	if (!part.cells.empty()) {
		return {{0, false}}; // The visual is reused even if no instances are left.
	}
	return std::vector<CellReuse>(next.cell_count());
}

} // namespace

void TileDisplay::set_hidden(std::uint32_t layer, std::uint64_t id, const Rect &area, bool hidden) {
	const bool has_changed = hidden ? hidden_ids_.insert(id).second : hidden_ids_.erase(id) > 0;
	if (has_changed) {
		mark(layer, area);
	}
}

std::vector<std::shared_ptr<const CompactMesh>> TileDisplay::overlay(const DisplayedTile &tile) const {
	OverlaidMeshes meshes;
	report("TerrainScatter3D", overlaid(tile.tile, *tile.settings, tile.space, {state_, &hidden_ids_}, meshes));
	return meshes;
}

void TileDisplay::patch() {
	const RedrawQueue::Marks marks = redraws_.take();
	if (marks.empty()) {
		return;
	}
	for (auto &[key, tile] : tiles_) {
		if (marks.meet(key.layer, tile.space)) {
			redraw(key, tile);
		}
	}
}

void TileDisplay::redraw(const TileKey &key, DisplayedTile &r_tile) {
	try {
		redraws_.reserve_mark(); // `patch` must not throw here, or the amounts would be wrong.
		budget_.remove(r_tile.amounts());
		patch(key, r_tile);
		budget_.add(r_tile.amounts());
		refine(key, r_tile);
	} catch (const std::bad_alloc &) {
		redraws_.mark_all(); // The exception may have discarded marks.
		throw;
	}
}

void TileDisplay::mark_later(std::uint32_t layer, const Rect &area) {
	redraws_.begin_later();
	for (auto entry = first_tile_of(layer); entry != tiles_.end() && entry->first.layer == layer; ++entry) {
		if (meet(entry->second.space, area)) {
			redraws_.add_later(entry->first);
		}
	}
}

void TileDisplay::mark_all_later() {
	redraws_.begin_later();
	for (const auto &[key, tile] : tiles_) {
		redraws_.add_later(key);
	}
}

bool TileDisplay::patch_step() {
	while (const std::optional<TileKey> key = redraws_.next_queued()) {
		if (const auto entry = tiles_.find(*key); entry != tiles_.end()) {
			redraw(*key, entry->second);
			return true;
		}
	}
	return false;
}

/// Applies the overlay to a tile. The caller must update the counts and the LODs by distance. If
/// memory is insufficient, the tile stays unchanged and is marked again.
void TileDisplay::patch(const TileKey &key, DisplayedTile &r_tile) {
	bool is_patched = false;
	report("TerrainScatter3D", guarded("tile", r_tile.space.size().x, [&] { is_patched = patch_parts(key, r_tile); }));
	if (!is_patched) {
		mark(key.layer, r_tile.space);
	}
}

/// Applies the overlay to all parts of a tile. Returns false if memory is insufficient.
bool TileDisplay::patch_parts(const TileKey &key, DisplayedTile &r_tile) {
	const LayerSnapshot *layer = layers_.find(key.layer);
	const std::vector<std::shared_ptr<const CompactMesh>> displayed_meshes = overlay(r_tile);
	if (displayed_meshes.size() != r_tile.parts.size()) {
		return false;
	}
	if (divisions_.is_current(key)) {
		cancel_division(); // The uploads of the division are outdated.
	}
	r_tile.check_all_cells = true;
	for (std::size_t mesh = 0; mesh < displayed_meshes.size(); ++mesh) {
		DisplayedTile::Part &part = r_tile.parts[mesh];
		if (part.displayed_mesh == displayed_meshes[mesh] ||
				same_instances(*part.displayed_mesh, *displayed_meshes[mesh])) {
			// The renderer already has these instances.
			part.displayed_mesh = displayed_meshes[mesh];
		} else if (!patch_part(r_tile, mesh, layer, part, displayed_meshes[mesh])) {
			return false;
		}
		for (const DisplayedTile::Cell &cell : part.cells) {
			r_tile.min = glm::min(r_tile.min, cell.min);
			r_tile.max = glm::max(r_tile.max, cell.max);
		}
	}
	return true;
}

/// Displays the new instances of a mesh. Uploads only changed cells. If memory is insufficient,
/// leaves the part unchanged and returns false.
bool TileDisplay::patch_part(const DisplayedTile &tile, std::size_t mesh, const LayerSnapshot *layer,
		DisplayedTile::Part &r_part, std::shared_ptr<const CompactMesh> displayed_mesh) {
	DisplayedTile::Part next;
	if (!TileUploader::divide_part(tile, std::move(displayed_mesh), r_part.lods, tile.cells_per_edge, next)) {
		return false;
	}
	if (layer == nullptr || next.lods.empty()) {
		r_part.displayed_mesh = next.displayed_mesh;
		return true;
	}
	const std::vector<CellReuse> reuses = reuse_cells(r_part, next, tile.cells_per_edge == 1);
	std::vector<MeshUpload> uploads(reuses.size());
	std::vector<DisplayedTile::Cell> new_cells;
	new_cells.reserve(reuses.size());
	for (std::size_t cell = 0; cell < reuses.size(); ++cell) {
		if (reuses[cell].is_unchanged) {
			// The renderer already has these instances.
			continue;
		}
		uploads[cell] = to_upload(next, cell, tile.reach_of(mesh));
		if (!reuses[cell].old_cell) {
			new_cells.push_back(uploader_.make_cell(tile, next, layer->drawing, uploads[cell]));
		}
	}
	next.cells.reserve(reuses.size());
	std::vector<DisplayedTile::Cell> removed_cells;
	removed_cells.reserve(r_part.cells.size());
	std::vector<bool> is_reused(r_part.cells.size());
	// Nothing may throw from here on, because the cells move to the new part one by one.
	std::size_t next_new_cell = 0;
	for (std::size_t cell = 0; cell < reuses.size(); ++cell) {
		const auto &[old_cell, is_unchanged] = reuses[cell];
		if (!old_cell) {
			next.cells.push_back(std::move(new_cells[next_new_cell++]));
			next.cells.back().visual.set_visible(visible_);
			continue;
		}
		is_reused[*old_cell] = true;
		next.cells.push_back(std::move(r_part.cells[*old_cell]));
		if (!is_unchanged) {
			// The cell keeps its visuals and gets the new instances.
			uploader_.set_instances(uploads[cell], next.cells.back());
		}
	}
	for (std::size_t old_cell = 0; old_cell < r_part.cells.size(); ++old_cell) {
		if (!is_reused[old_cell]) {
			r_part.cells[old_cell].for_each_visual([](TileVisual &visual) { visual.set_visible(false); });
			removed_cells.push_back(std::move(r_part.cells[old_cell]));
		}
	}
	r_part = std::move(next);
	release_visuals(std::move(removed_cells));
	return true;
}

} // namespace thicket
