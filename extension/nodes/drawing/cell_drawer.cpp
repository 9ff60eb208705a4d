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
	const bool fades = chain != nullptr && chain->is_complete() && chain->matches(tile.parts[mesh].lods);
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
	const bool is_divided = r_tile.cells_per_edge > 1;
	const DistanceRange tile_distance = distances_to(r_tile, r_tile.min, r_tile.max, layer_of(key).lod);
	bool draws_all = true;
	r_margin = std::numeric_limits<double>::infinity();
	for (std::size_t mesh = 0; mesh < r_tile.parts.size(); ++mesh) {
		DisplayedTile::Part &part = r_tile.parts[mesh];
		const Drawing drawing = drawing_of(key, r_tile, mesh);
		const auto draw = [&](std::size_t cell_index) {
			const DisplayedTile::Cell &cell = part.cells[cell_index];
			const DistanceRange distance =
					is_divided ? distances_to(r_tile, cell.min, cell.max, drawing.lod) : tile_distance;
			draws_all = draw_cell(drawing, distance, part, cell_index) && draws_all;
			return adapted_margin(drawing.lod, drawing.steps(), distance);
		};
		if (is_divided) {
			const double traveled = display_.schedule.traveled();
			r_margin = std::min(r_margin, part.visits.visit(part.cells.size(), traveled, r_tile.check_all_cells, draw));
		} else if (!part.cells.empty()) {
			r_margin = std::min(r_margin, draw(0));
		}
	}
	return draws_all;
}

bool CellDrawer::draw_cell(
		const Drawing &drawing, const DistanceRange &distance, DisplayedTile::Part &r_part, std::size_t cell_index) {
	++draw_count_;
	DisplayedTile::Cell &cell = r_part.cells[cell_index];
	const std::span<const std::uint32_t> ranks = r_part.ranks_of(cell_index);
	adapt(drawing.lod, drawing.steps(), distance, cell.drawing);
	const double lod_density = first_appearance(drawing, r_part, cell).lod_appearance.density;
	const bool draws_all = display_.budget.draw(drawing.layer, lod_density, ranks, cell.drawing);
	show_lods(drawing, ranks, r_part, cell);
	return draws_all;
}

/// Returns the MeshAppearance that the cell's first visual draws. If every required LOD has a visual,
/// this is the MeshAppearance of the first one. Otherwise it is the MeshAppearance of the single LOD that is
/// drawn without a fade.
const MeshAppearance &CellDrawer::first_appearance(
		const Drawing &drawing, const DisplayedTile::Part &part, const DisplayedTile::Cell &cell) {
	const LodSpan &span = cell.drawing.span;
	const std::size_t lod = cell.drawing.lod;
	if (drawing.chain == nullptr) {
		return part.lods[std::min(lod, part.lods.size() - 1)];
	}
	const bool is_complete = cell.extra_visuals.size() >= drawing.extra_run_count(span);
	return is_complete ? drawing.chain->appearance(span, 0) : drawing.chain->single_appearance(span, lod);
}

/// Assigns the required LODs to the visuals of a cell and releases visuals that are no longer
/// required. `ranks` are the ranks of the cell's instances.
void CellDrawer::show_lods(const Drawing &drawing, std::span<const std::uint32_t> ranks,
		const DisplayedTile::Part &part, DisplayedTile::Cell &r_cell) {
	const LodSpan &span = r_cell.drawing.span;
	const std::size_t extra_count = drawing.extra_run_count(span);
	while (r_cell.extra_visuals.size() > extra_count) {
		r_cell.extra_visuals.back().set_visible(false);
		display_.leaving_visuals.add(std::move(r_cell.extra_visuals.back()));
		r_cell.extra_visuals.pop_back();
		display_.budget.remove(multimeshes_only(part.multimeshes_per_cell()));
	}
	const MeshAppearance &first = first_appearance(drawing, part, r_cell);
	r_cell.visual.set_appearance(first);
	r_cell.visual.set_scale(r_cell.drawing.scale);
	r_cell.visual.set_drawn(r_cell.drawing.drawn_count);
	const bool is_complete = r_cell.extra_visuals.size() == extra_count;
	for (std::size_t index = 0; index < r_cell.extra_visuals.size(); ++index) {
		TileVisual &extra_visual = r_cell.extra_visuals[index];
		if (is_complete) {
			const MeshAppearance &appearance = drawing.chain->appearance(span, index + 1);
			extra_visual.set_appearance(appearance);
			extra_visual.set_drawn(drawn_by_extra_lod(
					ranks, first.lod_appearance.density, appearance.lod_appearance.density, r_cell.drawing));
		}
		extra_visual.set_scale(r_cell.drawing.scale);
		extra_visual.set_visible(visible_ && is_complete);
	}
}

/// Returns the number of visuals that a cell needs in addition to its first one.
std::size_t CellDrawer::wanted_extra_count(const Drawing &drawing, const DisplayedTile::Cell &cell) {
	return cell.drawing.density > 0.0 ? drawing.extra_run_count(cell.drawing.span) : 0;
}

bool CellDrawer::lacks_visuals(const TileKey &key, const DisplayedTile &tile) const {
	for (std::size_t mesh = 0; mesh < tile.parts.size(); ++mesh) {
		const Drawing drawing = drawing_of(key, tile, mesh);
		const DisplayedTile::Part &part = tile.parts[mesh];
		const auto lacks_visual = [&drawing](const DisplayedTile::Cell &cell) {
			return cell.extra_visuals.size() < wanted_extra_count(drawing, cell);
		};
		if (drawing.chain != nullptr && display_.budget.has_room_for(part.multimeshes_per_cell()) &&
				std::ranges::any_of(part.cells, lacks_visual)) {
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
		const std::size_t multimeshes_per_cell = part.multimeshes_per_cell();
		for (std::size_t cell_index = 0; drawing.chain != nullptr && cell_index < part.cells.size(); ++cell_index) {
			DisplayedTile::Cell &cell = part.cells[cell_index];
			const std::size_t extra_count = wanted_extra_count(drawing, cell);
			while (cell.extra_visuals.size() < extra_count && display_.budget.has_room_for(multimeshes_per_cell)) {
				if (step.is_full()) {
					return false;
				}
				display_.uploader.add_extra_visual(r_tile, mesh, layer_of(key).drawing, part, cell_index);
				display_.budget.add(multimeshes_only(multimeshes_per_cell));
				step.add(part.ranks_of(cell_index).size());
				show_lods(drawing, part.ranks_of(cell_index), part, cell);
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
		for (std::size_t cell_index = 0; drawing.chain != nullptr && cell_index < part.cells.size(); ++cell_index) {
			DisplayedTile::Cell &cell = part.cells[cell_index];
			LodSpan &span = cell.drawing.span;
			const DistanceRange distance = distances_to(tile, cell.min, cell.max, drawing.lod);
			span = lod_span(drawing.lod, drawing.steps(), distance, span);
			while (cell.extra_visuals.size() < drawing.extra_run_count(span)) {
				if (step.is_full()) {
					return false;
				}
				display_.uploader.add_extra_visual(tile, mesh, layer_of(key).drawing, part, cell_index);
				step.add(part.ranks_of(cell_index).size());
			}
		}
	}
	return true;
}

} // namespace thicket
