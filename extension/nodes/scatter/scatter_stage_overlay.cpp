// What a game has changed, in the picture: instances that are removed, placed by hand, or shown by other means.

#include "nodes/common/property_check.hpp"
#include "nodes/scatter/scatter_stage.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <map>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

bool same(const MeshInstances &a, const MeshInstances &b) { return a.ids == b.ids && a.buffer == b.buffer; }

} // namespace

void ScatterStage::set_hidden(std::uint32_t layer, std::uint64_t id, const Rect &area, bool hidden) {
	const bool changed = hidden ? hidden_.insert(id).second : hidden_.erase(id) > 0;
	if (changed) {
		mark(layer, area);
	}
}

std::vector<std::shared_ptr<const MeshInstances>> ScatterStage::overlay(const StagedTile &tile) const {
	OverlaidMeshes meshes;
	report("TerrainScatter3D", overlaid(tile.tile, *tile.plan->settings, tile.rect, {state_, &hidden_}, meshes));
	return meshes;
}

void ScatterStage::patch() {
	const std::vector<Mark> marks = std::exchange(marks_, {});
	const bool all = std::exchange(marked_all_, false);
	if (marks.empty() && !all) {
		return;
	}
	std::map<std::uint32_t, Rect> bounds; // Most tiles are told from them by this alone.
	for (const auto &[layer, area] : marks) {
		Rect &bound = bounds.try_emplace(layer, area).first->second;
		bound = {glm::min(bound.min, area.min), glm::max(bound.max, area.max)};
	}
	const auto is_marked = [&](std::uint32_t layer, const Rect &rect) {
		const auto bound = bounds.find(layer);
		return bound != bounds.end() && meet(rect, bound->second) && std::ranges::any_of(marks, [&](const Mark &mark) {
			return mark.layer == layer && meet(rect, mark.area);
		});
	};
	current_outdated_ = true;
	for (auto &[at, tile] : tiles_) {
		if (all || is_marked(std::get<0>(at), tile.rect)) {
			uncount(tile);
			patch(key_of(at), tile);
			count(tile);
			refine(key_of(at), tile);
		}
	}
}

/// Without the counts, and without the detail: both are the caller's.
void ScatterStage::patch(const TileKey &key, StagedTile &r_tile) {
	const std::vector<std::shared_ptr<const MeshInstances>> shown = overlay(r_tile);
	if (shown.size() != r_tile.parts.size()) {
		mark(key.layer, r_tile.rect); // No memory for now: it stays on show as it is until there is.
		return;
	}
	for (std::size_t mesh = 0; mesh < shown.size(); ++mesh) {
		StagedTile::Part &part = r_tile.parts[mesh];
		const std::shared_ptr<const MeshInstances> before = std::exchange(part.shown, shown[mesh]);
		if (before == part.shown || same(*before, *part.shown)) {
			continue;
		}
		const MeshUpload upload = to_upload(*part.shown, r_tile.plan->reach_of(mesh));
		if (part.visual) {
			part.visual->set_instances(upload);
			++upload_count_;
		} else if (key.layer < looks_.size() && mesh < looks_[key.layer].meshes.size() &&
				looks_[key.layer].meshes[mesh].is_valid()) {
			draw_part(r_tile, mesh, looks_[key.layer], upload, part);
			part.visual->set_visible(visible_);
		}
		if (part.visual) {
			r_tile.grow(upload.aabb);
		}
	}
}

} // namespace thicket
