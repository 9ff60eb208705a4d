// How much of each tile is drawn: with distance, quality and a limit for all tiles together, and all of it without an upload.

#include "nodes/scatter/tile_display.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Meters that a viewer moves at least before a tile is visited again. At a distance where something changes the margin is 0, and for a
/// viewer who stands still the tile would be visited without end.
constexpr double min_margin = 1e-3;

/// The same for a tile in cells, of which one or another is always near a change: a share of a cell's size.
constexpr double min_cells_margin = 1.0 / 8.0;

/// Multimeshes that a step looks at, or some more: a few microseconds. A tile that is looked at is seldom drawn otherwise.
constexpr std::size_t cells_per_step = 32;

} // namespace

void TileDisplay::count(const DisplayedTile &tile) {
	for (const DisplayedTile::Part &part : tile.parts) {
		instances_ += part.shown->size();
		multimeshes_ += part.cells.size() * part.multimeshes_of_a_cell();
		for (const DisplayedTile::Cell &cell : part.cells) {
			drawn_ += cell.drawn;
			wanted_ += cell.wanted;
		}
	}
}

void TileDisplay::uncount(const DisplayedTile &tile) {
	for (const DisplayedTile::Part &part : tile.parts) {
		instances_ -= part.shown->size();
		multimeshes_ -= part.cells.size() * part.multimeshes_of_a_cell();
		for (const DisplayedTile::Cell &cell : part.cells) {
			drawn_ -= cell.drawn;
			wanted_ -= cell.wanted;
		}
	}
}

void TileDisplay::count_drawn(DrawCounter &r_counter) const {
	for (const auto &[at, tile] : tiles_) {
		const glm::dvec3 origin = tile.tile->origin;
		for (const DisplayedTile::Part &part : tile.parts) {
			for (const DisplayedTile::Cell &cell : part.cells) {
				const Ref<Mesh> &mesh = part.lods[std::min(cell.lod, part.lods.size() - 1)].mesh;
				r_counter.add(
						mesh, visible_ ? cell.drawn : 0, origin + glm::dvec3(cell.min), origin + glm::dvec3(cell.max));
			}
		}
	}
}

void TileDisplay::set_viewers(std::span<const Viewer> viewers) {
	const double share = limited_share(share_, wanted_, next_limits_.max_instances);
	const bool others = schedule_.move(viewers);
	if (others || share != share_ || next_limits_ != limits_) {
		share_ = share;
		limits_ = next_limits_;
		visit_all();
	}
	for (const TileKey &key : std::exchange(cut_, {})) {
		if (const auto found = tiles_.find(order(key)); found != tiles_.end()) {
			found->second.is_cut = false;
			found->second.look_at_all = true;
			schedule_.add(key, 0.0);
		}
	}
}

void TileDisplay::visit_all() {
	schedule_.clear();
	cut_.clear();
	for (auto &[at, tile] : tiles_) {
		tile.is_cut = false;
		tile.look_at_all = true;
		schedule_.add(key_of(at), 0.0);
	}
}

bool TileDisplay::lod_step() {
	std::size_t looked_at = 0;
	while (looked_at < cells_per_step) {
		const std::optional<TileKey> key = schedule_.next();
		if (!key) {
			break;
		}
		if (const auto found = tiles_.find(order(*key)); found != tiles_.end()) {
			refine(*key, found->second);
			looked_at += found->second.cell_count() + 1;
		}
	}
	return looked_at > 0;
}

void TileDisplay::apply_drawing(const TileKey &key, DisplayedTile &r_tile) {
	if (r_tile.drawing_version == drawing_version(key.layer)) {
		return;
	}
	r_tile.drawing_version = drawing_version(key.layer);
	++redrawn_count_;
	for (DisplayedTile::Part &part : r_tile.parts) {
		for (DisplayedTile::Cell &cell : part.cells) {
			cell.visual.apply(layers_[key.layer]->drawing);
		}
	}
}

double TileDisplay::distance_to(const DisplayedTile &tile) const {
	const glm::dvec3 origin = tile.tile->origin;
	return schedule_.distance_to(origin + glm::dvec3(tile.min), origin + glm::dvec3(tile.max));
}

/// Draws a tile as its layer says for its distance, and schedules the next visit to it.
void TileDisplay::refine(const TileKey &key, DisplayedTile &r_tile) {
	const LayerSnapshot *layer = layer_at(key.layer);
	if (!r_tile.draws_anything() || layer == nullptr) {
		schedule_.remove(key);
		return;
	}
	apply_drawing(key, r_tile);
	const double distance = distance_to(r_tile);
	double margin = distance_margin(layer->lod, distance);
	const bool whole =
			r_tile.across > 1 ? draw_cells(layer->lod, r_tile, margin) : draw_whole(layer->lod, distance, r_tile);
	r_tile.look_at_all = false;
	if (!whole && !std::exchange(r_tile.is_cut, true)) {
		cut_.push_back(key);
	}
	choose_division(key, r_tile);
	schedule_.add(key, std::max(std::min(margin, division_margin(layer->cells, layer->lod, distance)), min_margin));
}

/// Draws the mesh and the share of the instances that the distance of the tile asks for. False if the limit for all tiles cuts them
/// short.
bool TileDisplay::draw_whole(const LodSettings &lod, double distance, DisplayedTile &r_tile) {
	bool whole = true;
	for (DisplayedTile::Part &part : r_tile.parts) {
		for (std::size_t cell = 0; cell < part.cells.size(); ++cell) {
			whole = draw_cell(lod, distance, part, cell) && whole;
		}
	}
	return whole;
}

/// The same for each cell whose turn it is. `r_margin` gets how far viewers may move until it is the next one's.
bool TileDisplay::draw_cells(const LodSettings &lod, DisplayedTile &r_tile, double &r_margin) {
	const double now = schedule_.traveled();
	const glm::dvec3 origin = r_tile.tile->origin;
	bool whole = true;
	r_margin = std::numeric_limits<double>::infinity();
	for (DisplayedTile::Part &part : r_tile.parts) {
		part.due.resize(part.cells.size()); // Apart from the cells, because most visits look at nothing else.
		for (std::size_t at = 0; at < part.cells.size(); ++at) {
			if (r_tile.look_at_all || part.due[at] <= now) {
				const DisplayedTile::Cell &cell = part.cells[at];
				const double distance =
						schedule_.distance_to(origin + glm::dvec3(cell.min), origin + glm::dvec3(cell.max));
				whole = draw_cell(lod, distance, part, at) && whole;
				part.due[at] = now + distance_margin(lod, distance);
			}
			r_margin = std::min(r_margin, part.due[at] - now);
		}
	}
	r_margin = std::max(r_margin, min_cells_margin * r_tile.rect.size().x / r_tile.across);
	return whole;
}

bool TileDisplay::draw_cell(
		const LodSettings &lod, double distance, DisplayedTile::Part &r_part, std::size_t cell_index) {
	DisplayedTile::Cell &cell = r_part.cells[cell_index];
	const std::span<const std::uint32_t> ranks = r_part.ranks_of(cell_index);
	const double density = thinned_density(lod, distance);
	wanted_ -= std::exchange(cell.wanted, visible_prefix(ranks, density * limits_.quality));
	wanted_ += cell.wanted;
	drawn_ -= cell.drawn;
	const std::uint64_t due = visible_prefix(ranks, density * limits_.quality * share_);
	const std::uint64_t room = limits_.max_instances - std::min(limits_.max_instances, drawn_);
	cell.drawn = static_cast<std::size_t>(std::min(due, room));
	drawn_ += cell.drawn;
	cell.lod = lod_at(lod, distance, cell.lod);
	cell.visual.set_look(r_part.lods[std::min(cell.lod, r_part.lods.size() - 1)]);
	cell.visual.set_scale(static_cast<float>(compensating_scale(lod, density)));
	cell.visual.set_drawn(cell.drawn);
	return cell.drawn == due;
}

} // namespace thicket
