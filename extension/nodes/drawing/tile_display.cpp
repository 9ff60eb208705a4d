#include "nodes/drawing/tile_display.hpp"

#include <algorithm>
#include <limits>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Returns the LODs of a mesh as its layer defines them; empty for a mesh that is not drawn.
std::vector<MeshAppearance> drawn_lods(const LayerSnapshot *layer, std::size_t mesh) {
	return layer != nullptr && layer->drawing.draws(mesh) ? lods_of(layer->drawing, mesh)
														  : std::vector<MeshAppearance>();
}

} // namespace

void TileDisplay::set_world_frame(const WorldFrame &frame) {
	uploader_.set_world_frame(frame);
	leaving_visuals_.set_frame(frame);
	for (auto &[key, tile] : tiles_) {
		tile.set_frame(frame);
	}
	for (DisplayedTile::Part &part : next_parts_) {
		for (DisplayedTile::Cell &cell : part.cells) {
			cell.for_each_visual([&frame](TileVisual &visual) { visual.set_frame(frame); });
		}
	}
}

void TileDisplay::set_visible(bool visible) {
	if (visible_ == visible) {
		return;
	}
	visible_ = visible;
	drawer_.set_visible(visible);
	for (auto &[key, tile] : tiles_) {
		tile.set_visible(visible);
	}
}

void TileDisplay::set_layers(const std::vector<SharedSnapshot> &layers) {
	const bool any_changed = layers_.set(layers);
	drawer_.fades().set_layers(layers);
	if (any_changed) {
		cancel_division();
		visit_all();
	}
}

void TileDisplay::begin(TileUpload &r_upload, bool others_wait) const {
	static const auto empty_tile = std::make_shared<const CompactTile>();
	const TileJob &job = *r_upload.job;
	const TileKey &key = job.request.key;
	DisplayedTile &tile = r_upload.tile;
	// A tile that could not be generated is treated as empty.
	tile.tile = job.tile != nullptr ? job.tile : empty_tile;
	tile.settings = job.layer->settings;
	tile.owner = job.layer->links.identity;
	tile.mesh_reach = job.layer->drawing.mesh_reach;
	tile.space = job.request.space;
	tile.drawing_version = layers_.version(key.layer);
	r_upload.displayed_meshes = overlay(tile);
	r_upload.overlay_version = redraws_.version();
	if (r_upload.displayed_meshes.size() != tile.tile->meshes.size()) {
		tile.tile = nullptr; // Out of memory. The upload starts again later.
		return;
	}
	const LayerSnapshot *layer = layers_.find(key.layer);
	// The instances and the multimeshes per cell of each mesh.
	std::vector<std::pair<std::size_t, std::size_t>> sizes;
	for (std::size_t mesh = 0; mesh < r_upload.displayed_meshes.size(); ++mesh) {
		const CompactMesh &displayed_mesh = *r_upload.displayed_meshes[mesh];
		if (layer != nullptr && layer->drawing.draws(mesh) && displayed_mesh.size() > 0) {
			tile.grow(box_around(
					displayed_mesh.min(), displayed_mesh.max(), tile.reach_of(mesh) * displayed_mesh.max_scale()));
			sizes.emplace_back(displayed_mesh.size(), have_shadow_meshes(lods_of(layer->drawing, mesh)) ? 2 : 1);
		}
	}
	const auto entry = tiles_.find(key);
	const DisplayedTile *previous = entry != tiles_.end() ? &entry->second : nullptr;
	const std::uint32_t cells_per_edge = division_of(key, tile, previous != nullptr ? previous->cells_per_edge : 0);
	DivisionQueue::Multimeshes multimeshes = total_multimeshes();
	multimeshes.count -= previous != nullptr ? previous->multimesh_count() : 0;
	for (const auto &[instances, multimeshes_per_cell] : sizes) {
		multimeshes.count += std::min(instances, std::size_t{cells_per_edge} * cells_per_edge) * multimeshes_per_cell;
	}
	tile.cells_per_edge = DivisionQueue::first_division(cells_per_edge, multimeshes, previous != nullptr, others_wait);
}

void TileDisplay::upload_some(TileUpload &r_upload, bool others_wait) {
	if (!r_upload.is_begun()) {
		begin(r_upload, others_wait);
	}
	if (!r_upload.is_begun() || r_upload.is_complete()) {
		return;
	}
	const TileJob &job = *r_upload.job;
	DisplayedTile &tile = r_upload.tile;
	const LayerSnapshot *layer = layers_.find(job.request.key.layer);
	if (!r_upload.has_open_part()) {
		const std::size_t mesh = tile.parts.size();
		DisplayedTile::Part part;
		if (!TileUploader::divide_part(
					tile, r_upload.displayed_meshes[mesh], drawn_lods(layer, mesh), tile.cells_per_edge, part)) {
			return; // Out of memory. The next call tries again.
		}
		tile.parts.push_back(std::move(part));
	}
	DisplayedTile::Part &part = tile.parts.back();
	const std::size_t mesh = tile.parts.size() - 1;
	const bool is_generated_mesh = part.division.empty() && part.displayed_mesh.get() == &job.tile->meshes[mesh];
	if (layer == nullptr) {
		part.lods.clear(); // The layer has been removed since then, so it is not drawn.
	} else if (is_generated_mesh && r_upload.has_open_part()) {
		// The worker has already prepared this buffer.
		part.cells.push_back(uploader_.make_cell(tile, part, layer->drawing, job.uploads[mesh]));
	} else {
		uploader_.upload_cells(tile, mesh, layer->drawing, part);
	}
}

void TileDisplay::show(TileUpload upload) {
	const TileKey key = upload.job->request.key;
	if (divisions_.is_current(key)) {
		cancel_division();
	}
	redraws_.reserve_mark(); // Nothing may throw while the tile is not counted.
	DisplayedTile &tile = tiles_[key];
	leaving_visuals_.reserve(tile.multimesh_count());
	budget_.remove(tile.amounts());
	upload.tile.set_lod(tile.finest_lod());
	upload.tile.needs_fade_visuals = tile.needs_fade_visuals;
	// Hide the old visuals first. If both were visible, each instance would be drawn twice.
	tile.set_visible(false);
	release_visuals(std::move(tile));
	tile = std::move(upload.tile);
	if (upload.overlay_version != redraws_.version()) {
		patch(key, tile);
	}
	// The origin may have moved since the first part was uploaded.
	tile.set_frame(uploader_.world_frame());
	budget_.add(tile.amounts());
	divisions_.show(key, tile.cells_per_edge);
	refine(key, tile);
	tile.set_visible(visible_);
}

void TileDisplay::release_visuals(DisplayedTile &&tile) {
	for (DisplayedTile::Part &part : tile.parts) {
		release_visuals(std::move(part.cells));
	}
}

void TileDisplay::release_visuals(std::vector<DisplayedTile::Cell> &&cells) {
	for (DisplayedTile::Cell &cell : cells) {
		cell.for_each_visual([this](TileVisual &visual) { leaving_visuals_.add(std::move(visual)); });
	}
	cells.clear();
}

bool TileDisplay::contains(const TileKey &key) const { return tiles_.contains(key); }

bool TileDisplay::drop(const TileKey &key) {
	const auto entry = tiles_.find(key);
	if (entry == tiles_.end()) {
		return false;
	}
	if (divisions_.is_current(key)) {
		cancel_division();
	}
	divisions_.remove(key);
	if (entry->second.needs_fade_visuals) {
		std::erase(tiles_to_fade_, key);
	}
	budget_.remove(entry->second.amounts());
	release_visuals(std::move(entry->second));
	tiles_.erase(entry);
	schedule_.remove(key);
	divisions_.capacity_gained(TileMeasures(*this));
	return true;
}

void TileDisplay::retire() {
	cancel_division();
	for (auto &[key, tile] : tiles_) {
		release_visuals(std::move(tile));
	}
	LeavingVisuals kept_visuals = std::exchange(leaving_visuals_, {});
	clear();
	leaving_visuals_ = std::move(kept_visuals);
}

void TileDisplay::clear() {
	leaving_visuals_.clear();
	divisions_.clear();
	next_parts_.clear();
	tiles_to_fade_.clear();
	tiles_.clear();
	uploader_.reset_count();
	drawer_.reset_count();
	redrawn_count_ = 0;
	schedule_.clear();
	budget_.clear();
	hidden_ids_.clear();
	redraws_.clear();
}

const DisplayedTile *TileDisplay::find(std::uint32_t layer, glm::ivec2 tile) const {
	const auto entry = tiles_.lower_bound({layer, std::numeric_limits<std::uint32_t>::max(), tile});
	const bool is_match = entry != tiles_.end() && entry->first.layer == layer && entry->first.tile == tile;
	return is_match ? &entry->second : nullptr;
}

std::vector<const DisplayedTile *> TileDisplay::column(std::uint32_t layer, glm::ivec2 tile) const {
	std::vector<const DisplayedTile *> result;
	auto entry = tiles_.lower_bound({layer, std::numeric_limits<std::uint32_t>::max(), tile});
	std::uint32_t grid = 0;
	for (; entry != tiles_.end() && entry->first.layer == layer && entry->first.tile == tile; ++entry) {
		if (entry->first.grid > grid) {
			grid = entry->first.grid;
			result.clear();
		}
		if (entry->first.grid == grid) {
			result.push_back(&entry->second);
		}
	}
	return result;
}

const DisplayedTile *TileDisplay::find(std::uint32_t layer, glm::ivec2 tile, std::int32_t slab) const {
	const auto entry = tiles_.lower_bound({layer, std::numeric_limits<std::uint32_t>::max(), tile, slab});
	const bool is_match = entry != tiles_.end() && entry->first.layer == layer && entry->first.tile == tile &&
			entry->first.slab == slab;
	return is_match ? &entry->second : nullptr;
}

std::vector<glm::ivec2> TileDisplay::tiles(std::uint32_t layer) const {
	std::vector<glm::ivec2> result;
	for (auto entry = first_tile_of(layer); entry != tiles_.end() && entry->first.layer == layer; ++entry) {
		if (result.empty() || result.back() != entry->first.tile) {
			result.push_back(entry->first.tile);
		}
	}
	return result;
}

std::uint64_t TileDisplay::instance_count(std::uint32_t layer) const {
	const LayerSnapshot *snapshot = layers_.find(layer);
	if (snapshot == nullptr) {
		return 0;
	}
	std::uint64_t result = 0;
	for (const auto &[key, tile] : tiles_) {
		if (tile.owner == snapshot->links.identity) {
			for (const DisplayedTile::Part &part : tile.parts) {
				result += part.displayed_mesh->size();
			}
		}
	}
	return result;
}

TileDisplay::Tiles::const_iterator TileDisplay::first_tile_of(std::uint32_t layer) const {
	const glm::ivec2 lowest(std::numeric_limits<std::int32_t>::min());
	return tiles_.lower_bound({layer, std::numeric_limits<std::uint32_t>::max(), lowest});
}

} // namespace thicket
