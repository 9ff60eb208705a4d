// What a game has changed, in the picture: instances that are removed, placed by hand, or shown by other means.

#include "nodes/scatter/tile_display.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <map>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

bool same(const MeshInstances &a, const MeshInstances &b) { return a.ids == b.ids && a.buffer == b.buffer; }

} // namespace

void TileDisplay::set_hidden(std::uint32_t layer, std::uint64_t id, const Rect &area, bool hidden) {
	const bool changed = hidden ? hidden_.insert(id).second : hidden_.erase(id) > 0;
	if (changed) {
		mark(layer, area);
	}
}

std::vector<std::shared_ptr<const MeshInstances>> TileDisplay::overlay(const DisplayedTile &tile) const {
	return overlaid(tile.tile, *tile.settings, tile.rect, {state_, &hidden_});
}

void TileDisplay::patch() {
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
	++overlay_version_;
	for (auto &[at, tile] : tiles_) {
		if (all || is_marked(std::get<0>(at), tile.rect)) {
			uncount(tile);
			patch(key_of(at), tile);
			count(tile);
			refine(key_of(at), tile);
		}
	}
}

/// Updates neither the counts nor what the distance asks for: both are left to the caller.
void TileDisplay::patch(const TileKey &key, DisplayedTile &r_tile) {
	const LayerSnapshot *layer = layer_at(key.layer);
	const std::vector<std::shared_ptr<const MeshInstances>> shown = overlay(r_tile);
	for (std::size_t mesh = 0; mesh < shown.size(); ++mesh) {
		DisplayedTile::Part &part = r_tile.parts[mesh];
		const std::shared_ptr<const MeshInstances> before = std::exchange(part.shown, shown[mesh]);
		if (before == part.shown || same(*before, *part.shown)) {
			continue;
		}
		const MeshUpload upload = to_upload(*part.shown, r_tile.reach_of(mesh));
		if (part.visual) {
			part.visual->set_instances(upload);
			++upload_count_;
		} else if (layer != nullptr && layer->drawing.draws(mesh)) {
			draw_part(r_tile, mesh, layer->drawing, upload, part);
			part.visual->set_visible(visible_);
		}
		if (part.visual) {
			r_tile.grow(upload.aabb);
		}
	}
}

} // namespace thicket
