// How much of each tile is drawn: with distance, quality and a limit for all tiles together, and all of it without an upload.

#include "nodes/scatter/tile_display.hpp"

#include <algorithm>
#include <optional>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Meters that a viewer moves at least before a tile is visited again. At a distance where something changes the margin is 0, and for a
/// viewer who stands still the tile would be visited without end.
constexpr double min_margin = 1e-3;

} // namespace

void TileDisplay::count(const DisplayedTile &tile) {
	for (const DisplayedTile::Part &part : tile.parts) {
		instances_ += part.shown->size();
		drawn_ += part.drawn;
		wanted_ += part.wanted;
	}
}

void TileDisplay::uncount(const DisplayedTile &tile) {
	for (const DisplayedTile::Part &part : tile.parts) {
		instances_ -= part.shown->size();
		drawn_ -= part.drawn;
		wanted_ -= part.wanted;
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
			schedule_.add(key, 0.0);
		}
	}
}

void TileDisplay::visit_all() {
	schedule_.clear();
	cut_.clear();
	for (auto &[at, tile] : tiles_) {
		tile.is_cut = false;
		schedule_.add(key_of(at), 0.0);
	}
}

bool TileDisplay::lod_step() {
	while (const std::optional<TileKey> key = schedule_.next()) {
		if (const auto found = tiles_.find(order(*key)); found != tiles_.end()) {
			refine(*key, found->second);
			return true;
		}
	}
	return false;
}

void TileDisplay::apply_drawing(const TileKey &key, DisplayedTile &r_tile) {
	if (r_tile.drawing_version == drawing_version(key.layer)) {
		return;
	}
	r_tile.drawing_version = drawing_version(key.layer);
	++redrawn_count_;
	for (DisplayedTile::Part &part : r_tile.parts) {
		if (part.visual) {
			part.visual->apply(layers_[key.layer]->drawing);
		}
	}
}

/// Draws a tile as its layer says for its distance, and schedules the next visit to it.
void TileDisplay::refine(const TileKey &key, DisplayedTile &r_tile) {
	const LayerSnapshot *layer = layer_at(key.layer);
	if (!r_tile.draws_anything() || layer == nullptr) {
		schedule_.remove(key);
		return;
	}
	apply_drawing(key, r_tile);
	const glm::dvec3 origin = r_tile.tile->origin;
	const double distance = schedule_.distance_to(origin + glm::dvec3(r_tile.min), origin + glm::dvec3(r_tile.max));
	const bool whole = draw_lod(layer->lod, distance, r_tile);
	if (!whole && !std::exchange(r_tile.is_cut, true)) {
		cut_.push_back(key);
	}
	schedule_.add(key, std::max(distance_margin(layer->lod, distance), min_margin));
}

/// Draws the mesh and the share of the instances that the distance asks for. False if the limit for all tiles cuts them short.
bool TileDisplay::draw_lod(const LodSettings &lod, double distance, DisplayedTile &r_tile) {
	const double density = thinned_density(lod, distance);
	const auto scale = static_cast<float>(compensating_scale(lod, density));
	r_tile.lod = lod_at(lod, distance, r_tile.lod);
	bool whole = true;
	for (DisplayedTile::Part &part : r_tile.parts) {
		if (!part.visual) {
			continue;
		}
		wanted_ -= std::exchange(part.wanted, visible_prefix(part.shown->ranks, density * limits_.quality));
		wanted_ += part.wanted;
		drawn_ -= part.drawn;
		const std::uint64_t due = visible_prefix(part.shown->ranks, density * limits_.quality * share_);
		const std::uint64_t room = limits_.max_instances - std::min(limits_.max_instances, drawn_);
		part.drawn = static_cast<std::size_t>(std::min(due, room));
		drawn_ += part.drawn;
		whole = whole && part.drawn == due;
		part.visual->set_mesh(part.lods[std::min(r_tile.lod, part.lods.size() - 1)]);
		part.visual->set_scale(scale);
		part.visual->set_drawn(part.drawn);
	}
	return whole;
}

} // namespace thicket
