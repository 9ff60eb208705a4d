#include "nodes/drawing/cell_drawer.hpp"

#include "core/drawing/upload_step.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace thicket {

namespace {

DrawAmounts multimeshes_only(std::size_t count) {
	DrawAmounts amounts;
	amounts.multimeshes = count;
	return amounts;
}

} // namespace

CellDrawer::Drawing CellDrawer::drawing_of(const TileKey &key, const DisplayedTile &tile, std::size_t mesh) const {
	const LodChain *chain = fades_.find(key.layer, mesh);
	const bool fades = chain != nullptr && chain->is_complete() && chain->is_of(tile.parts[mesh].lods);
	return {display_.layers.index_of(tile.owner, key.layer), layer_of(key).lod, fades ? chain : nullptr};
}

/// Returns the range of distances from the viewers to a box. `min` and `max` are relative to the
/// tile's origin.
DistanceRange CellDrawer::distances_to(
		const DisplayedTile &tile, glm::vec3 min, glm::vec3 max, const LodSettings &lod) const {
	const glm::dvec3 origin = tile.tile->origin;
	return display_.schedule.distances_to(origin + glm::dvec3(min), origin + glm::dvec3(max), lod.sight());
}

bool CellDrawer::draw(const TileKey &key, DisplayedTile &r_tile, double &r_margin) {
	const bool in_cells = r_tile.cells_per_edge > 1;
	const DistanceRange tile_distance = distances_to(r_tile, r_tile.min, r_tile.max, layer_of(key).lod);
	bool whole = true;
	r_margin = std::numeric_limits<double>::infinity();
	for (std::size_t mesh = 0; mesh < r_tile.parts.size(); ++mesh) {
		DisplayedTile::Part &part = r_tile.parts[mesh];
		const Drawing drawing = drawing_of(key, r_tile, mesh);
		const auto draw = [&](std::size_t at) {
			const DisplayedTile::Cell &cell = part.cells[at];
			const DistanceRange distance =
					in_cells ? distances_to(r_tile, cell.min, cell.max, drawing.lod) : tile_distance;
			whole = draw_cell(drawing, distance, part, at) && whole;
			return adapted_margin(drawing.lod, drawing.steps(), distance);
		};
		if (in_cells) {
			const double traveled = display_.schedule.traveled();
			r_margin = std::min(r_margin, part.visits.visit(part.cells.size(), traveled, r_tile.check_all_cells, draw));
		} else if (!part.cells.empty()) {
			r_margin = std::min(r_margin, draw(0));
		}
	}
	return whole;
}

bool CellDrawer::draw_cell(
		const Drawing &drawing, const DistanceRange &distance, DisplayedTile::Part &r_part, std::size_t cell_index) {
	++draw_count_;
	DisplayedTile::Cell &cell = r_part.cells[cell_index];
	const std::span<const std::uint32_t> ranks = r_part.ranks_of(cell_index);
	adapt(drawing.lod, drawing.steps(), distance, cell.drawing);
	const double lod_density = first_variant(drawing, r_part, cell).lod_appearance.density;
	const bool whole = display_.budget.draw(drawing.layer, lod_density, ranks, cell.drawing);
	show_lods(drawing, ranks, r_part, cell);
	return whole;
}

/// Returns the MeshAppearance that the cell's first visual draws. If every required LOD has a visual,
/// this is the MeshAppearance of the first one. Otherwise it is the MeshAppearance of the single LOD that is
/// drawn without a fade.
const MeshAppearance &CellDrawer::first_variant(
		const Drawing &drawing, const DisplayedTile::Part &part, const DisplayedTile::Cell &cell) {
	const LodSpan &span = cell.drawing.span;
	const std::size_t lod = cell.drawing.lod;
	if (drawing.chain == nullptr) {
		return part.lods[std::min(lod, part.lods.size() - 1)];
	}
	const bool complete = cell.others.size() >= drawing.extra_variants(span);
	return complete ? drawing.chain->appearance(span, 0) : drawing.chain->single_variant(span, lod);
}

/// Assigns the required LODs to the visuals of a cell and releases visuals that are no longer
/// required. `ranks` are the ranks of the cell's instances.
void CellDrawer::show_lods(const Drawing &drawing, std::span<const std::uint32_t> ranks,
		const DisplayedTile::Part &part, DisplayedTile::Cell &r_cell) {
	const LodSpan &span = r_cell.drawing.span;
	const std::size_t others = drawing.extra_variants(span);
	while (r_cell.others.size() > others) {
		r_cell.others.back().set_visible(false);
		display_.leaving.add(std::move(r_cell.others.back()));
		r_cell.others.pop_back();
		display_.budget.remove(multimeshes_only(part.multimeshes_of_a_cell()));
	}
	const MeshAppearance &first = first_variant(drawing, part, r_cell);
	r_cell.visual.set_appearance(first);
	r_cell.visual.set_scale(r_cell.drawing.scale);
	r_cell.visual.set_drawn(r_cell.drawing.drawn);
	const bool complete = r_cell.others.size() == others;
	for (std::size_t index = 0; index < r_cell.others.size(); ++index) {
		TileVisual &other = r_cell.others[index];
		if (complete) {
			const MeshAppearance &appearance = drawing.chain->appearance(span, index + 1);
			other.set_appearance(appearance);
			other.set_drawn(drawn_by_other(
					ranks, first.lod_appearance.density, appearance.lod_appearance.density, r_cell.drawing));
		}
		other.set_scale(r_cell.drawing.scale);
		other.set_visible(visible_ && complete);
	}
}

/// Returns the number of visuals that a cell needs in addition to its first one.
std::size_t CellDrawer::wanted_others(const Drawing &drawing, const DisplayedTile::Cell &cell) {
	return cell.drawing.density > 0.0 ? drawing.extra_variants(cell.drawing.span) : 0;
}

bool CellDrawer::lacks_visuals(const TileKey &key, const DisplayedTile &tile) const {
	for (std::size_t mesh = 0; mesh < tile.parts.size(); ++mesh) {
		const Drawing drawing = drawing_of(key, tile, mesh);
		const DisplayedTile::Part &part = tile.parts[mesh];
		const auto lacks = [&drawing](const DisplayedTile::Cell &cell) {
			return cell.others.size() < wanted_others(drawing, cell);
		};
		if (drawing.chain != nullptr && display_.budget.has_room_for(part.multimeshes_of_a_cell()) &&
				std::ranges::any_of(part.cells, lacks)) {
			return true;
		}
	}
	return false;
}

bool CellDrawer::add_visuals(const TileKey &key, DisplayedTile &r_tile) {
	UploadStep step;
	for (std::size_t mesh = 0; mesh < r_tile.parts.size(); ++mesh) {
		DisplayedTile::Part &part = r_tile.parts[mesh];
		const Drawing drawing = drawing_of(key, r_tile, mesh);
		const std::size_t more = part.multimeshes_of_a_cell();
		for (std::size_t at = 0; drawing.chain != nullptr && at < part.cells.size(); ++at) {
			DisplayedTile::Cell &cell = part.cells[at];
			const std::size_t wanted = wanted_others(drawing, cell);
			while (cell.others.size() < wanted && display_.budget.has_room_for(more)) {
				if (step.is_full()) {
					return false;
				}
				display_.uploader.add_other(r_tile, mesh, layer_of(key).drawing, part, at);
				display_.budget.add(multimeshes_only(more));
				step.add(part.ranks_of(at).size());
				show_lods(drawing, part.ranks_of(at), part, cell);
			}
		}
	}
	return true;
}

bool CellDrawer::add_visuals(const TileKey &key, const DisplayedTile &tile, std::span<DisplayedTile::Part> r_parts) {
	UploadStep step;
	for (std::size_t mesh = 0; mesh < r_parts.size(); ++mesh) {
		DisplayedTile::Part &part = r_parts[mesh];
		const Drawing drawing = drawing_of(key, tile, mesh);
		for (std::size_t at = 0; drawing.chain != nullptr && at < part.cells.size(); ++at) {
			DisplayedTile::Cell &cell = part.cells[at];
			LodSpan &span = cell.drawing.span;
			const DistanceRange distance = distances_to(tile, cell.min, cell.max, drawing.lod);
			span = lod_span(drawing.lod, drawing.steps(), distance, span);
			while (cell.others.size() < drawing.extra_variants(span)) {
				if (step.is_full()) {
					return false;
				}
				display_.uploader.add_other(tile, mesh, layer_of(key).drawing, part, at);
				step.add(part.ranks_of(at).size());
			}
		}
	}
	return true;
}

} // namespace thicket
