// How much of each tile is drawn: with distance, quality and a limit for all tiles together, and all of it without an upload.

#include "nodes/scatter/scatter_stage.hpp"

#include <algorithm>
#include <optional>
#include <utility>

using namespace godot;

namespace thicket {

void ScatterStage::count(const StagedTile &tile) {
	for (const StagedTile::Part &part : tile.parts) {
		instances_ += part.shown->size();
		drawn_ += part.drawn;
		wanted_ += part.wanted;
	}
}

void ScatterStage::uncount(const StagedTile &tile) {
	for (const StagedTile::Part &part : tile.parts) {
		instances_ -= part.shown->size();
		drawn_ -= part.drawn;
		wanted_ -= part.wanted;
	}
}

void ScatterStage::look_around(std::span<const Viewer> viewers) {
	const double share = limited_share(share_, wanted_, next_limits_.max_instances);
	const bool others = schedule_.move(viewers);
	if (others || share != share_ || next_limits_ != limits_) {
		share_ = share;
		limits_ = next_limits_;
		visit_all();
	}
	for (const TileKey &key : std::exchange(cut_, {})) {
		if (tiles_.contains(order(key))) {
			schedule_.add(key, 0.0);
		}
	}
}

void ScatterStage::visit_all() {
	schedule_.clear();
	cut_.clear();
	for (auto &[at, tile] : tiles_) {
		schedule_.add(key_of(at), 0.0);
	}
}

bool ScatterStage::detail_step() {
	while (const std::optional<TileKey> key = schedule_.next()) {
		if (const auto found = tiles_.find(order(*key)); found != tiles_.end()) {
			refine(*key, found->second);
			return true;
		}
	}
	return false;
}

void ScatterStage::apply_look(const TileKey &key, StagedTile &tile) {
	if (tile.look_version == look_versions_[key.layer]) {
		return;
	}
	tile.look_version = look_versions_[key.layer];
	for (StagedTile::Part &part : tile.parts) {
		if (part.visual) {
			part.visual->apply(looks_[key.layer].draw);
		}
	}
}

void ScatterStage::refine(const TileKey &key, StagedTile &tile) {
	const bool draws = tile.min.x <= tile.max.x;
	if (!draws || key.layer >= looks_.size()) {
		schedule_.remove(key);
		return;
	}
	apply_look(key, tile);
	const LodSettings &detail = looks_[key.layer].detail;
	const glm::dvec3 origin = tile.tile->origin;
	const double distance = schedule_.distance_to(origin + glm::dvec3(tile.min), origin + glm::dvec3(tile.max));
	const double density = thinned_density(detail, distance);
	const auto scale = static_cast<float>(compensating_scale(detail, density));
	tile.lod = lod_at(detail, distance, tile.lod);
	bool cut = false;
	for (StagedTile::Part &part : tile.parts) {
		if (!part.visual) {
			continue;
		}
		wanted_ -= std::exchange(part.wanted, visible_prefix(part.shown->ranks, density * limits_.quality));
		wanted_ += part.wanted;
		drawn_ -= part.drawn;
		const std::uint64_t due = visible_prefix(part.shown->ranks, density * limits_.quality * share_);
		const std::uint64_t room = limits_.max_instances - std::min(limits_.max_instances, drawn_);
		part.drawn = std::min(due, room);
		drawn_ += part.drawn;
		cut = cut || part.drawn < due;
		part.visual->set_mesh(part.levels[std::min(tile.lod, part.levels.size() - 1)]);
		part.visual->set_scale(scale);
		part.visual->set_drawn(part.drawn);
	}
	if (cut) {
		cut_.push_back(key);
	}
	schedule_.add(key, distance_margin(detail, distance));
}

} // namespace thicket
