// What a game has changed, in the picture: instances that are removed, placed by hand, or shown by other means.

#include "nodes/common/property_check.hpp"
#include "nodes/scatter/tile_display.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <map>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

bool same(const KeptMesh &a, const KeptMesh &b) {
	bool equal = a.size() == b.size();
	for (std::size_t i = 0; equal && i < a.size(); ++i) {
		equal = a.same(i, b, i);
	}
	return equal;
}

} // namespace

void TileDisplay::set_hidden(std::uint32_t layer, std::uint64_t id, const Rect &area, bool hidden) {
	const bool changed = hidden ? hidden_.insert(id).second : hidden_.erase(id) > 0;
	if (changed) {
		mark(layer, area);
	}
}

std::vector<std::shared_ptr<const KeptMesh>> TileDisplay::overlay(const DisplayedTile &tile) const {
	OverlaidMeshes meshes;
	report("TerrainScatter3D", overlaid(tile.tile, *tile.settings, tile.rect, {state_, &hidden_}, meshes));
	return meshes;
}

void TileDisplay::patch() {
	const std::vector<Mark> marks = std::exchange(marks_, {});
	const bool all = std::exchange(marked_all_, false);
	if (marks.empty() && !all) {
		return;
	}
	std::map<std::uint32_t, Rect> bounds;
	for (const auto &[layer, area] : marks) {
		Rect &bound = bounds.try_emplace(layer, area).first->second;
		bound = {glm::min(bound.min, area.min), glm::max(bound.max, area.max)};
	}
	const auto is_marked = [&](std::uint32_t layer, const Rect &rect) {
		const auto bound = bounds.find(layer);
		if (bound == bounds.end() || !meet(rect, bound->second)) {
			// Fast path: what does not meet the bounds of all marks meets none of them.
			return false;
		}
		return std::ranges::any_of(
				marks, [&](const Mark &mark) { return mark.layer == layer && meet(rect, mark.area); });
	};
	++overlay_version_;
	for (auto &[at, tile] : tiles_) {
		if (all || is_marked(std::get<0>(at), tile.rect)) {
			redraw(key_of(at), tile);
		}
	}
}

void TileDisplay::redraw(const TileKey &key, DisplayedTile &r_tile) {
	uncount(r_tile);
	patch(key, r_tile);
	count(r_tile);
	refine(key, r_tile);
}

void TileDisplay::mark_later(std::uint32_t layer, const Rect &area) {
	++overlay_version_;
	for (const auto &[at, tile] : tiles_) {
		if (key_of(at).layer == layer && meet(tile.rect, area)) {
			marked_later_.insert(at);
		}
	}
}

void TileDisplay::mark_all_later() {
	++overlay_version_;
	for (const auto &[at, tile] : tiles_) {
		marked_later_.insert(at);
	}
}

bool TileDisplay::patch_step() {
	while (!marked_later_.empty()) {
		const Order at = *marked_later_.begin();
		marked_later_.erase(marked_later_.begin());
		if (const auto found = tiles_.find(at); found != tiles_.end()) {
			redraw(key_of(at), found->second);
			return true;
		}
	}
	return false;
}

/// Updates neither the counts nor what the distance asks for: both are left to the caller.
void TileDisplay::patch(const TileKey &key, DisplayedTile &r_tile) {
	const LayerSnapshot *layer = layer_at(key.layer);
	const std::vector<std::shared_ptr<const KeptMesh>> shown = overlay(r_tile);
	if (shown.size() != r_tile.parts.size()) {
		mark(key.layer, r_tile.rect); // No memory for now: it stays on show as it is until there is.
		return;
	}
	if (division_ && division_->key == key) {
		cancel_division(); // What it has uploaded is out of date.
	}
	r_tile.look_at_all = true;
	for (std::size_t mesh = 0; mesh < shown.size(); ++mesh) {
		DisplayedTile::Part &part = r_tile.parts[mesh];
		if (part.shown == shown[mesh] || same(*part.shown, *shown[mesh])) {
			// Fast path: the renderer has the same instances.
			part.shown = shown[mesh];
		} else if (!patch_part(r_tile, mesh, layer, part, shown[mesh])) {
			mark(key.layer, r_tile.rect); // As above.
			return;
		}
		for (const DisplayedTile::Cell &cell : part.cells) {
			r_tile.min = glm::min(r_tile.min, cell.min);
			r_tile.max = glm::max(r_tile.max, cell.max);
		}
	}
}

/// Shows other instances of a mesh. A cell that has what it had is not uploaded anew. False without the memory for it.
bool TileDisplay::patch_part(const DisplayedTile &tile, std::size_t mesh, const LayerSnapshot *layer,
		DisplayedTile::Part &r_part, std::shared_ptr<const KeptMesh> shown) {
	DisplayedTile::Part next;
	if (!begin_part(tile, std::move(shown), r_part.lods, tile.across, next)) {
		return false;
	}
	if (layer == nullptr || next.lods.empty()) {
		r_part.shown = next.shown;
		return true;
	}
	const bool whole = tile.across == 1;
	std::size_t before = 0;
	std::vector<DisplayedTile::Cell> gone;
	const std::size_t count = whole ? std::max(next.cell_count(), r_part.cells.size()) : next.division.cells.size();
	for (std::size_t at = 0; at < count; ++at) {
		while (!whole && before < r_part.cells.size() &&
				r_part.division.cells[before].number < next.division.cells[at].number) {
			gone.push_back(std::move(r_part.cells[before++]));
		}
		const bool stands = before < r_part.cells.size() &&
				(whole || r_part.division.cells[before].number == next.division.cells[at].number);
		const bool unchanged = stands && !whole &&
				same_instances(*r_part.shown, r_part.division.order_of(r_part.division.cells[before]), *next.shown,
						next.division.order_of(next.division.cells[at]));
		if (unchanged) {
			// Fast path: the renderer has the same instances of the cell.
			next.cells.push_back(std::move(r_part.cells[before++]));
			continue;
		}
		const MeshUpload upload = to_upload(next, at, tile.reach_of(mesh));
		if (stands) {
			// Fast path: its visuals take the other instances.
			next.cells.push_back(std::move(r_part.cells[before++]));
			next.cells.back().set_instances(upload);
			++upload_count_;
		} else {
			next.cells.push_back(make_cell(tile, next, layer->drawing, upload));
			next.cells.back().visual.set_visible(visible_);
		}
	}
	while (before < r_part.cells.size()) {
		gone.push_back(std::move(r_part.cells[before++]));
	}
	for (DisplayedTile::Cell &cell : gone) {
		cell.for_each_visual([](TileVisual &visual) { visual.set_visible(false); });
	}
	leave(std::move(gone));
	r_part = std::move(next);
	return true;
}

} // namespace thicket
