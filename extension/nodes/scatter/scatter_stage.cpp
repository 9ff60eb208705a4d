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

} // namespace

ScatterStage::Order ScatterStage::order(const TileKey &key) {
	return {key.layer, key.tile.x, key.tile.y, -std::int64_t{key.grid}};
}

void StagedTile::grow(const AABB &box) {
	const Vector3 end = box.position + box.size;
	min = glm::min(min, glm::vec3(box.position.x, box.position.y, box.position.z));
	max = glm::max(max, glm::vec3(end.x, end.y, end.z));
}

TileKey ScatterStage::key_of(const Order &order) {
	const auto &[layer, x, y, grid] = order;
	return {layer, static_cast<std::uint32_t>(-grid), {x, y}};
}

void ScatterStage::set_place(const RID &scenario, std::uint64_t node_id) {
	place_.scenario = scenario;
	place_.node_id = node_id;
}

void ScatterStage::set_world_offset(glm::dvec3 offset) {
	place_.offset = offset;
	const auto move = [&offset](StagedTile &tile) {
		for (StagedTile::Part &part : tile.parts) {
			if (part.visual) {
				part.visual->set_offset(offset);
			}
		}
	};
	for (auto &[key, tile] : tiles_) {
		move(tile);
	}
	for (Aside &aside : aside_) {
		move(aside.tile);
	}
	move(current_);
	for (TileVisual &visual : leaving_) {
		visual.set_offset(offset);
	}
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

void ScatterStage::draw_part(const StagedTile &tile, std::size_t mesh, const LayerLook &look, const MeshUpload &upload,
		StagedTile::Part &r_part) {
	VisualPlace place = place_;
	place.origin = tile.tile->origin;
	r_part.levels = mesh_levels(look, mesh);
	r_part.visual.emplace(place, tile.plan->settings->instance_data, look.meshes[mesh], upload);
	r_part.visual->apply(look.draw);
	++upload_count_;
}

StagedTile::Part ScatterStage::make_part(const TileJob &job, std::size_t mesh) {
	StagedTile::Part part;
	part.shown = current_shown_[mesh];
	const std::uint32_t layer = job.request.key.layer;
	const bool drawn =
			layer < looks_.size() && mesh < looks_[layer].meshes.size() && looks_[layer].meshes[mesh].is_valid();
	if (drawn && part.shown->size() > 0) {
		const bool own = part.shown.get() == &job.tile->meshes[mesh];
		const MeshUpload upload = own ? job.uploads[mesh] : to_upload(*part.shown, job.plan->reach_of(mesh));
		draw_part(current_, mesh, looks_[layer], upload, part);
		current_.grow(upload.aabb);
	}
	return part;
}

bool ScatterStage::choose(std::uint64_t ticket) {
	const auto set =
			std::ranges::find_if(aside_, [ticket](const Aside &aside) { return aside.job->request.ticket == ticket; });
	if (set != aside_.end()) {
		uploads_.push_front(std::move(set->job));
		current_ = std::move(set->tile);
		current_outdated_ = true; // Perhaps: nobody has looked.
		aside_.erase(set);
		chosen_ = complete_ = true;
		return true;
	}
	const auto found = std::ranges::find_if(
			uploads_, [ticket](const std::shared_ptr<TileJob> &job) { return job->request.ticket == ticket; });
	if (found != uploads_.end()) {
		std::rotate(uploads_.begin(), found, found + 1);
		chosen_ = true;
	}
	return chosen_;
}

void ScatterStage::set_aside() {
	aside_.push_back({std::move(uploads_.front()), std::exchange(current_, StagedTile())});
	uploads_.pop_front();
	chosen_ = complete_ = false;
}

bool ScatterStage::upload_step() {
	if (!chosen_ || complete_) {
		return false;
	}
	TileJob &job = *uploads_.front();
	if (current_.tile == nullptr) {
		static const auto nothing = std::make_shared<const TileInstances>();
		current_.tile = job.tile != nullptr ? job.tile : nothing; // One that could not be made is empty.
		current_.plan = job.plan;
		current_.rect = job.request.rect;
		current_shown_ = overlay(current_);
		current_outdated_ = false;
		const std::uint32_t layer = job.request.key.layer;
		current_.look_version = layer < looks_.size() ? look_versions_[layer] : 0;
	}
	if (const std::size_t next = current_.parts.size(); next < current_shown_.size()) {
		current_.parts.push_back(make_part(job, next));
	}
	complete_ = current_.parts.size() >= current_shown_.size();
	return true;
}

void ScatterStage::present() {
	const TileKey key = uploads_.front()->request.key;
	StagedTile &slot = tiles_[order(key)];
	uncount(slot);
	current_.lod = slot.lod;
	// The old visuals go now: for as long as both stood, each would be drawn twice.
	slot = std::exchange(current_, StagedTile());
	if (current_outdated_) {
		patch(key, slot);
	}
	count(slot);
	refine(key, slot);
	set_tile_visible(slot, visible_);
	uploads_.pop_front();
	chosen_ = complete_ = false;
}

void ScatterStage::reject() {
	leave(std::exchange(current_, StagedTile()));
	uploads_.pop_front();
	chosen_ = complete_ = false;
}

void ScatterStage::forget(std::uint64_t ticket) {
	if (chosen_ && uploads_.front()->request.ticket == ticket) {
		reject();
		return;
	}
	std::erase_if(uploads_, [ticket](const std::shared_ptr<TileJob> &job) { return job->request.ticket == ticket; });
	const auto set =
			std::ranges::find_if(aside_, [ticket](const Aside &aside) { return aside.job->request.ticket == ticket; });
	if (set != aside_.end()) {
		leave(std::move(set->tile));
		aside_.erase(set);
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
	schedule_.remove(key);
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
	aside_.clear();
	current_ = StagedTile();
	chosen_ = complete_ = false;
	leaving_.clear();
	tiles_.clear();
	instances_ = drawn_ = wanted_ = upload_count_ = 0;
	schedule_.clear();
	cut_.clear();
	share_ = 1.0;
	hidden_.clear();
	marks_.clear();
	marked_all_ = false;
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
