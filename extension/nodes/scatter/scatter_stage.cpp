#include "nodes/scatter/scatter_stage.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <limits>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

void set_tile_visible(StagedTile &tile, bool visible) {
	for (StagedTile::Part &part : tile.parts) {
		if (part.visual) {
			part.visual->set_visible(visible);
		}
	}
}

/// The mesh near by, then those for the distance, none of them null.
std::vector<Ref<Mesh>> mesh_levels(const LayerLook &look, std::size_t mesh) {
	std::vector<Ref<Mesh>> levels{look.meshes[mesh]};
	for (std::size_t at = mesh; at < look.lod_meshes.size(); at += look.meshes.size()) {
		levels.push_back(look.lod_meshes[at].is_valid() ? look.lod_meshes[at] : levels.back());
	}
	return levels;
}

void grow_box(const AABB &box, StagedTile &r_tile) {
	const Vector3 end = box.position + box.size;
	r_tile.min = glm::min(r_tile.min, glm::vec3(box.position.x, box.position.y, box.position.z));
	r_tile.max = glm::max(r_tile.max, glm::vec3(end.x, end.y, end.z));
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
	look_versions_.resize(looks.size());
	bool changed = false;
	for (std::size_t layer = 0; layer < looks.size(); ++layer) {
		const LayerLook *old = layer < looks_.size() ? &looks_[layer] : nullptr;
		if (old == nullptr || old->detail != looks[layer].detail || !old->draw.draws_as(looks[layer].draw)) {
			look_versions_[layer] = ++last_version_;
			changed = true;
		}
	}
	looks_ = std::move(looks);
	if (changed) {
		visit_all();
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
		part.levels = mesh_levels(looks_[layer], mesh);
		VisualPlace place = place_;
		place.origin = Vector3(static_cast<real_t>(job.origin.x), static_cast<real_t>(job.origin.y),
				static_cast<real_t>(job.origin.z));
		part.visual.emplace(place, job.plan->settings->look, looks_[layer].meshes[mesh], upload.buffer, upload.aabb);
		part.visual->apply(looks_[layer].draw);
		grow_box(upload.aabb, current_);
		++upload_count_;
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
	if (const std::uint32_t layer = job.request.key.layer; current_.parts.empty() && layer < looks_.size()) {
		current_.look_version = look_versions_[layer];
	}
	const std::size_t next = current_.parts.size();
	if (next < job.meshes.size()) {
		current_.parts.push_back(make_part(job, job.meshes[next], next));
	}
	complete_ = current_.parts.size() >= job.meshes.size();
	return true;
}

void ScatterStage::present() {
	const TileKey key = uploads_.front()->request.key;
	StagedTile &slot = tiles_[order(key)];
	uncount(slot);
	current_.lod = slot.lod;
	// The old visuals go now: for as long as both stood, each would be drawn twice.
	slot = std::exchange(current_, StagedTile());
	count(slot);
	refine(key, slot);
	set_tile_visible(slot, visible_);
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
	uncount(found->second);
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
	instances_ = drawn_ = wanted_ = upload_count_ = 0;
	schedule_.clear();
	cut_.clear();
	share_ = 1.0;
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
