#include "core/query/instance_world.hpp"

#include "core/base/tile_grid.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

namespace {

std::size_t size_of(const TileInstances &tile) {
	std::size_t size = 1; // A tile without instances takes memory, too.
	for (const MeshInstances &mesh : tile.meshes) {
		size += mesh.size();
	}
	return size;
}

} // namespace

void InstanceWorld::set_layers(std::vector<QueryLayer> layers) {
	const auto outdated = [&](const auto &entry) {
		const std::uint32_t layer = std::get<0>(entry.first);
		return layer >= layers.size() || !layers[layer].wanted || layers[layer].set != layers_[layer].set ||
				layers[layer].tile_size != layers_[layer].tile_size;
	};
	std::erase_if(tiles_, outdated);
	layers_ = std::move(layers);
	++edits_;
	touch();
}

void InstanceWorld::invalidate(std::uint32_t layer, const EditedArea &area) {
	if (area.empty() || layer >= layers_.size()) {
		return;
	}
	++edits_;
	const double tile_size = layers_[layer].tile_size;
	for (auto &[key, entry] : tiles_) {
		const auto &[at, x, y] = key;
		entry.outdated = entry.outdated || (at == layer && area.touches(tile_rect(tile_size, {x, y})));
	}
	touch();
}

void InstanceWorld::clear() {
	tiles_.clear();
	missing_.clear();
	++edits_;
	touch();
}

void InstanceWorld::keep(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const TileInstances> instances) {
	kept_since_forgetting_ += size_of(*instances);
	tiles_.insert_or_assign(Key{layer, tile.x, tile.y}, Entry{std::move(instances), ++uses_});
	touch();
	if (kept_since_forgetting_ > max_idle_instances / 4) {
		forget_idle();
	}
}

void InstanceWorld::forget_idle() {
	kept_since_forgetting_ = 0;
	std::size_t idle = 0;
	std::vector<std::pair<std::uint64_t, Key>> oldest;
	for (const auto &[key, entry] : tiles_) {
		if (entry.tile.use_count() == 1) {
			idle += size_of(*entry.tile);
			oldest.emplace_back(entry.used, key);
		}
	}
	std::ranges::sort(oldest);
	for (auto next = oldest.begin(); idle > max_idle_instances && next != oldest.end(); ++next) {
		const auto found = tiles_.find(next->second);
		idle -= size_of(*found->second.tile);
		tiles_.erase(found);
	}
}

std::shared_ptr<const TileInstances> InstanceWorld::find(const WorldTile &tile) const {
	const auto found = tiles_.find({tile.layer, tile.tile.x, tile.tile.y});
	if (found == tiles_.end() || found->second.outdated) {
		return nullptr;
	}
	found->second.used = ++uses_;
	return found->second.tile;
}

void InstanceWorld::miss(const WorldTile &tile) const { missing_.emplace(tile.layer, tile.tile.x, tile.tile.y); }

std::vector<WorldTile> InstanceWorld::take_missing() {
	std::vector<WorldTile> result;
	for (const auto &[layer, x, y] : std::exchange(missing_, {})) {
		if (layer < layers_.size() && layers_[layer].wanted && find({layer, {x, y}}) == nullptr) {
			result.push_back({layer, {x, y}});
		}
	}
	return result;
}

void InstanceWorld::known_near(
		std::uint32_t layer, glm::dvec2 center, double distance, std::vector<PlacedInstance> &r_found) const {
	std::vector<PlacedInstance> found;
	const QueryFilter filter{.layers = {layer}, .accepts = {}};
	const Rect around{center - distance, center + distance};
	NearSource source(*this);
	if (InstanceQuery{layers_, source, state_}.in_rect(around, filter, found).ok()) {
		r_found.insert(r_found.end(), found.begin(), found.end());
	}
}

Status InstanceWorld::KnownSource::find_tile(
		std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const TileInstances> &r_tile) {
	r_tile = world_.find({layer, tile});
	return {};
}

Status InstanceWorld::NearSource::find_tile(
		std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const TileInstances> &r_tile) {
	r_tile = world_.find({layer, tile});
	if (r_tile == nullptr) {
		world_.miss({layer, tile});
		const auto outdated = world_.tiles_.find({layer, tile.x, tile.y});
		r_tile = outdated != world_.tiles_.end() ? outdated->second.tile : nullptr;
	}
	return {};
}

Status InstanceWorld::MakingSource::find_tile(
		std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const TileInstances> &r_tile) {
	r_tile = world_.find({layer, tile});
	if (r_tile != nullptr) {
		return {};
	}
	const TileMaker maker = world_.maker_; // A script that is asked for the ground may replace it.
	const std::uint64_t edits = world_.edits_;
	const Status status = maker(layer, tile, r_tile);
	if (status.ok() && r_tile != nullptr && edits == world_.edits_) {
		world_.keep(layer, tile, r_tile);
	}
	return status;
}

} // namespace thicket
