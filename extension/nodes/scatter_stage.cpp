#include "nodes/scatter_stage.hpp"

#include <algorithm>
#include <limits>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

std::uint64_t count_instances(const StagedTile &tile) {
	std::uint64_t count = 0;
	for (const StagedTile::Part &part : tile.parts) {
		count += part.ids.size();
	}
	return count;
}

void set_tile_visible(StagedTile &tile, bool visible) {
	for (StagedTile::Part &part : tile.parts) {
		if (part.visual) {
			part.visual->set_visible(visible);
		}
	}
}

} // namespace

ScatterStage::Order ScatterStage::order(const TileKey &key) {
	return {key.layer, key.tile.x, key.tile.y, -std::int64_t{key.grid}};
}

void ScatterStage::set_place(const RID &scenario, std::uint64_t node_id) {
	place_.scenario = scenario;
	place_.node_id = node_id;
}

void ScatterStage::set_visible(bool visible) {
	if (visible_ == visible) {
		return;
	}
	visible_ = visible;
	for (auto &[key, tile] : tiles_) {
		set_tile_visible(tile, visible);
	}
}

void ScatterStage::set_looks(std::vector<LayerLook> looks) {
	looks_ = std::move(looks);
	for (auto &[key, tile] : tiles_) {
		apply_look(std::get<0>(key), tile);
	}
	if (!uploads_.empty()) {
		apply_look(uploads_.front()->request.key.layer, current_);
	}
}

void ScatterStage::apply_look(std::uint32_t layer, StagedTile &tile) {
	if (layer >= looks_.size()) {
		return;
	}
	for (StagedTile::Part &part : tile.parts) {
		if (part.visual) {
			part.visual->apply(looks_[layer].draw);
		}
	}
}

void ScatterStage::push(std::shared_ptr<TileJob> job) { uploads_.push_back(std::move(job)); }

StagedTile::Part ScatterStage::make_part(const TileJob &job, MeshUpload &upload, std::size_t mesh) {
	StagedTile::Part part;
	part.ids = std::move(upload.ids);
	part.ranks = std::move(upload.ranks);
	const std::uint32_t layer = job.request.key.layer;
	const bool drawn =
			layer < looks_.size() && mesh < looks_[layer].meshes.size() && looks_[layer].meshes[mesh].is_valid();
	if (drawn && !part.ids.empty()) {
		VisualPlace place = place_;
		place.origin = Vector3(static_cast<real_t>(job.origin.x), static_cast<real_t>(job.origin.y),
				static_cast<real_t>(job.origin.z));
		part.visual.emplace(
				place, job.plan->settings.look, looks_[layer].meshes[mesh], upload.buffer, upload.aabb);
		part.visual->apply(looks_[layer].draw);
	} else {
		part.hidden_buffer = upload.buffer;
	}
	return part;
}

bool ScatterStage::upload_step() {
	if (uploads_.empty() || complete_) {
		return false;
	}
	TileJob &job = *uploads_.front();
	current_.origin = job.origin;
	current_.counts = job.counts;
	const std::size_t next = current_.parts.size();
	if (next < job.meshes.size()) {
		current_.parts.push_back(make_part(job, job.meshes[next], next));
	}
	complete_ = current_.parts.size() >= job.meshes.size();
	return true;
}

void ScatterStage::present() {
	const TileKey key = uploads_.front()->request.key;
	set_tile_visible(current_, visible_);
	instances_ += count_instances(current_);
	StagedTile &slot = tiles_[order(key)];
	instances_ -= count_instances(slot);
	// The old visuals go now: for as long as both stood, each would be drawn twice.
	slot = std::exchange(current_, StagedTile());
	uploads_.pop_front();
	complete_ = false;
}

void ScatterStage::reject() {
	leave(std::exchange(current_, StagedTile()));
	uploads_.pop_front();
	complete_ = false;
}

void ScatterStage::forget(std::uint64_t ticket) {
	const auto found = std::find_if(uploads_.begin(), uploads_.end(),
			[ticket](const std::shared_ptr<TileJob> &job) { return job->request.ticket == ticket; });
	if (found == uploads_.end()) {
		return;
	}
	if (found == uploads_.begin()) {
		reject();
	} else {
		uploads_.erase(found);
	}
}

void ScatterStage::leave(StagedTile &&tile) {
	for (StagedTile::Part &part : tile.parts) {
		if (part.visual) {
			leaving_.push_back(std::move(*part.visual));
		}
	}
}

bool ScatterStage::holds(const TileKey &key) const { return tiles_.contains(order(key)); }

bool ScatterStage::drop(const TileKey &key) {
	const auto found = tiles_.find(order(key));
	if (found == tiles_.end()) {
		return false;
	}
	instances_ -= count_instances(found->second);
	leave(std::move(found->second));
	tiles_.erase(found);
	return true;
}

bool ScatterStage::free_step() {
	if (leaving_.empty()) {
		return false;
	}
	leaving_.pop_back();
	return true;
}

void ScatterStage::clear() {
	uploads_.clear();
	current_ = StagedTile();
	complete_ = false;
	leaving_.clear();
	tiles_.clear();
	instances_ = 0;
}

const StagedTile *ScatterStage::find(std::uint32_t layer, glm::ivec2 tile) const {
	const auto found = tiles_.lower_bound({layer, tile.x, tile.y, std::numeric_limits<std::int64_t>::min()});
	if (found == tiles_.end()) {
		return nullptr;
	}
	const auto &[at_layer, x, y, grid] = found->first;
	return at_layer == layer && x == tile.x && y == tile.y ? &found->second : nullptr;
}

std::vector<glm::ivec2> ScatterStage::tiles(std::uint32_t layer) const {
	constexpr auto lowest = std::numeric_limits<std::int32_t>::min();
	std::vector<glm::ivec2> result;
	auto at = tiles_.lower_bound({layer, lowest, lowest, std::numeric_limits<std::int64_t>::min()});
	for (; at != tiles_.end() && std::get<0>(at->first) == layer; ++at) {
		result.emplace_back(std::get<1>(at->first), std::get<2>(at->first));
	}
	return result;
}

} // namespace thicket
