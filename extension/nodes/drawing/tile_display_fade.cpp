// How LODs cross-fade: if the instances of a cell are in the distance range of two LODs, both are drawn, and their shaders divide the
// pixels between them.

#include "nodes/drawing/tile_display.hpp"

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

// The largest upload of one step, so that it takes a small part of a frame's time.
class StepLimit {
public:
	void add(std::size_t instances) {
		++visuals_;
		instances_ += instances;
	}
	bool is_reached() const { return visuals_ >= most_visuals || instances_ >= most_instances; }

private:
	static constexpr std::size_t most_visuals = 4;
	static constexpr std::size_t most_instances = 4096;
	std::size_t visuals_ = 0;
	std::size_t instances_ = 0;
};

DrawAmounts multimeshes_only(std::size_t count) {
	DrawAmounts amounts;
	amounts.multimeshes = count;
	return amounts;
}

} // namespace

/// The look of the visual that each cell has: the first of the wanted LODs, if all of them have a visual; otherwise the LOD that is to be
/// drawn alone.
const MeshLook &TileDisplay::first_look(
		const Drawing &drawing, const DisplayedTile::Part &part, const DisplayedTile::Cell &cell) {
	const LodSpan &span = cell.drawing.span;
	const std::size_t lod = cell.drawing.lod;
	if (drawing.chain == nullptr) {
		return part.lods[std::min(lod, part.lods.size() - 1)];
	}
	const bool complete = cell.others.size() >= drawing.looks_beyond_first(span);
	return complete ? drawing.chain->look(span, 0) : drawing.chain->only_look(span, lod);
}

/// Draws these looks, and releases visuals that are no longer wanted. `ranks` are those of the cell.
void TileDisplay::show_lods(const Drawing &drawing, std::span<const std::uint32_t> ranks,
		const DisplayedTile::Part &part, DisplayedTile::Cell &r_cell) {
	const LodSpan &span = r_cell.drawing.span;
	const std::size_t others = drawing.looks_beyond_first(span);
	while (r_cell.others.size() > others) {
		r_cell.others.back().set_visible(false);
		leaving_.add(std::move(r_cell.others.back()));
		r_cell.others.pop_back();
		budget_.remove(multimeshes_only(part.multimeshes_of_a_cell()));
	}
	const MeshLook &first = first_look(drawing, part, r_cell);
	r_cell.visual.set_look(first);
	r_cell.visual.set_scale(r_cell.drawing.scale);
	r_cell.visual.set_drawn(r_cell.drawing.drawn);
	const bool complete = r_cell.others.size() == others;
	for (std::size_t index = 0; index < r_cell.others.size(); ++index) {
		TileVisual &other = r_cell.others[index];
		if (complete) {
			const MeshLook &look = drawing.chain->look(span, index + 1);
			other.set_look(look);
			other.set_drawn(drawn_by_other(ranks, first.look.density, look.look.density, r_cell.drawing));
		}
		other.set_scale(r_cell.drawing.scale);
		other.set_visible(visible_ && complete);
	}
}

/// The number of further visuals that a cell of a visible tile is to have.
std::size_t TileDisplay::wanted_others(const Drawing &drawing, const DisplayedTile::Cell &cell) {
	return cell.drawing.density > 0.0 ? drawing.looks_beyond_first(cell.drawing.span) : 0;
}

/// True if a cell of a tile lacks a visual, and there is room for one.
bool TileDisplay::wants_visuals(const TileKey &key, const DisplayedTile &tile) const {
	for (std::size_t mesh = 0; mesh < tile.parts.size(); ++mesh) {
		const Drawing drawing = drawing_of(key, tile, mesh);
		const DisplayedTile::Part &part = tile.parts[mesh];
		const auto lacks = [&drawing](const DisplayedTile::Cell &cell) {
			return cell.others.size() < wanted_others(drawing, cell);
		};
		if (drawing.chain != nullptr && budget_.has_room_for(part.multimeshes_of_a_cell()) &&
				std::ranges::any_of(part.cells, lacks)) {
			return true;
		}
	}
	return false;
}

/// Uploads some of the visuals that the cells of a tile lack. False if the step's limit is reached.
bool TileDisplay::upload_others(const TileKey &key, DisplayedTile &r_tile) {
	StepLimit limit;
	for (std::size_t mesh = 0; mesh < r_tile.parts.size(); ++mesh) {
		DisplayedTile::Part &part = r_tile.parts[mesh];
		const Drawing drawing = drawing_of(key, r_tile, mesh);
		const std::size_t more = part.multimeshes_of_a_cell();
		for (std::size_t at = 0; drawing.chain != nullptr && at < part.cells.size(); ++at) {
			DisplayedTile::Cell &cell = part.cells[at];
			const std::size_t wanted = wanted_others(drawing, cell);
			while (cell.others.size() < wanted && budget_.has_room_for(more)) {
				if (limit.is_reached()) {
					return false;
				}
				uploader_.add_other(r_tile, mesh, layers_.find(key.layer)->drawing, part, at);
				budget_.add(multimeshes_only(more));
				limit.add(part.ranks_of(at).size());
				show_lods(drawing, part.ranks_of(at), part, cell);
			}
		}
	}
	return true;
}

/// The same for the still hidden parts of a tile's new division, so that nothing pops when they are shown.
bool TileDisplay::upload_others(const TileKey &key, const DisplayedTile &tile, std::span<DisplayedTile::Part> r_parts) {
	StepLimit limit;
	const glm::dvec3 origin = tile.tile->origin;
	for (std::size_t mesh = 0; mesh < r_parts.size(); ++mesh) {
		DisplayedTile::Part &part = r_parts[mesh];
		const Drawing drawing = drawing_of(key, tile, mesh);
		for (std::size_t at = 0; drawing.chain != nullptr && at < part.cells.size(); ++at) {
			DisplayedTile::Cell &cell = part.cells[at];
			LodSpan &span = cell.drawing.span;
			const DistanceRange distance = schedule_.distances_to(
					origin + glm::dvec3(cell.min), origin + glm::dvec3(cell.max), drawing.lod.sight());
			span = lod_span(drawing.lod, drawing.steps(), distance, span);
			while (cell.others.size() < drawing.looks_beyond_first(span)) {
				if (limit.is_reached()) {
					return false;
				}
				uploader_.add_other(tile, mesh, layers_.find(key.layer)->drawing, part, at);
				limit.add(part.ranks_of(at).size());
			}
		}
	}
	return true;
}

bool TileDisplay::fade_step() {
	bool ready = false;
	if (fades_.make_some(ready)) {
		if (ready) {
			visit_all();
		}
		return true;
	}
	if (to_fade_.empty()) {
		return false;
	}
	const TileKey key = to_fade_.back();
	DisplayedTile &tile = tiles_.at(key);
	if (layers_.find(key.layer) == nullptr || upload_others(key, tile)) {
		tile.to_fade = false;
		to_fade_.pop_back();
	}
	return true;
}

} // namespace thicket
