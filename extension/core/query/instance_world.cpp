#include "core/query/instance_world.hpp"

#include "core/base/tile_grid.hpp"

#include <algorithm>
#include <functional>
#include <utility>

namespace thicket {

void InstanceWorld::set_layers(std::vector<QueryLayer> layers) {
	const auto outdated = [&](const auto &entry) {
		const std::uint32_t layer = std::get<0>(entry.first);
		return layer >= layers.size() || !layers[layer].wanted || layers[layer].set != layers_[layer].set ||
				layers[layer].tile_size != layers_[layer].tile_size || layers[layer].bottom != layers_[layer].bottom ||
				layers[layer].top != layers_[layer].top;
	};
	std::erase_if(tiles_, outdated);
	layers_ = std::move(layers);
	++edits_;
	touch();
}

void InstanceWorld::touch() {
	touched_ = ++version_;
	new_tiles_.clear();
}

bool InstanceWorld::changed_since(std::uint64_t version, std::uint32_t layer, const Rect &rect) const {
	const auto is_before = [version](const TileChange &change) {
		return change.version <= version;
	};
	const auto first = std::ranges::partition_point(new_tiles_, is_before);
	return version < touched_ ||
			std::any_of(
					first, new_tiles_.end(),
					[layer, &rect](
							const TileChange &change) { return change.layer == layer && meet(change.rect, rect); });
}

void InstanceWorld::invalidate(std::uint32_t layer, const EditedArea &area) {
	if (area.empty()) {
		// An empty area changes no result, so the version stays the same.
		return;
	}
	if (layer >= layers_.size()) {
		return;
	}
	++edits_;
	const double tile_size = layers_[layer].tile_size;
	for (auto &[key, entry] : tiles_) {
		const auto &[at, x, y, slab] = key;
		entry.outdated = entry.outdated || (at == layer && area.touches(tile_rect(tile_size, {x, y})));
	}
	touch();
}

void InstanceWorld::clear() {
	tiles_.clear();
	forgotten_.clear();
	idle_.clear();
	next_idle_check_.reset();
	missing_.clear();
	++edits_;
	touch();
}

void InstanceWorld::keep(const WorldTile &tile, std::shared_ptr<const CompactTile> instances) {
	const std::size_t size = cached_size(*instances);
	added_since_idle_check_ += size;
	tiles_.insert_or_assign(key_of(tile), Entry{std::move(instances), size, ++uses_});
	if (tile.layer < layers_.size() && new_tiles_.size() < max_new_tiles) {
		new_tiles_.push_back({++version_, tile.layer, tile_rect(layers_[tile.layer].tile_size, tile.tile)});
	} else {
		touch();
	}
	if (!next_idle_check_ && added_since_idle_check_ > max_idle_instances / 4) {
		added_since_idle_check_ = 0;
		idle_.clear();
		idle_instances_ = 0;
		next_idle_check_ = tiles_.begin()->first;
	}
	if (next_idle_check_) {
		find_idle();
	} else {
		forget_some();
	}
}

std::vector<std::shared_ptr<const CompactTile>> InstanceWorld::take_forgotten() {
	return std::exchange(forgotten_, {});
}

/// Checks whether a few more tiles are idle. Checking all of them in one frame would delay it.
void InstanceWorld::find_idle() {
	constexpr std::size_t max_per_call = 128;
	auto next = tiles_.lower_bound(*next_idle_check_);
	for (std::size_t i = 0; i < max_per_call && next != tiles_.end(); ++i, ++next) {
		if (next->second.tile.use_count() == 1) {
			idle_.emplace_back(next->second.used, next->first);
			idle_instances_ += next->second.size;
		}
	}
	next_idle_check_ = next != tiles_.end() ? std::optional(next->first) : std::nullopt;
	if (!next_idle_check_) {
		std::ranges::make_heap(idle_, std::greater<>());
	}
}

/// Drops the least recently used idle tiles.
void InstanceWorld::forget_some() {
	constexpr std::size_t max_per_call = 2;
	constexpr std::size_t max_kept = 64; // Limits the memory in case no caller takes the tiles.
	if (forgotten_.size() > max_kept) {
		forgotten_.clear();
	}
	for (std::size_t i = 0; i < max_per_call && idle_instances_ > max_idle_instances && !idle_.empty(); ++i) {
		std::ranges::pop_heap(idle_, std::greater<>());
		const auto [used, key] = idle_.back();
		idle_.pop_back();
		const auto found = tiles_.find(key);
		if (found != tiles_.end() && found->second.used == used && found->second.tile.use_count() == 1) {
			idle_instances_ -= found->second.size;
			forgotten_.push_back(std::move(found->second.tile));
			tiles_.erase(found);
		}
	}
}

std::vector<KnownTile> InstanceWorld::known_tiles() const {
	std::vector<KnownTile> result;
	result.reserve(tiles_.size());
	for (const auto &[key, entry] : tiles_) {
		if (!entry.outdated) {
			result.push_back({key, entry.tile});
		}
	}
	return result;
}

std::shared_ptr<const CompactTile> InstanceWorld::find(const WorldTile &tile) const {
	const auto found = tiles_.find(key_of(tile));
	if (found == tiles_.end() || found->second.outdated) {
		return nullptr;
	}
	found->second.used = ++uses_;
	return found->second.tile;
}

void InstanceWorld::miss(const WorldTile &tile) const { missing_.insert(key_of(tile)); }

std::vector<WorldTile> InstanceWorld::take_missing() {
	std::vector<WorldTile> result;
	for (const auto &[layer, x, y, slab] : std::exchange(missing_, {})) {
		const WorldTile tile{layer, {x, y}, slab};
		if (layer < layers_.size() && layers_[layer].wanted && find(tile) == nullptr) {
			result.push_back(tile);
		}
	}
	return result;
}

void InstanceWorld::known_in(std::uint32_t layer, const TileSpace &space, std::vector<PlacedInstance> &r_found) const {
	std::vector<PlacedInstance> found;
	const QueryFilter filter{.layers = {layer}, .accepts = {}};
	NearSource source(*this);
	if (InstanceQuery{layers_, source, state_}.in_rect(space, filter, found).ok()) {
		r_found.insert(r_found.end(), found.begin(), found.end());
	}
}

Status InstanceWorld::KnownSource::find_tile(const WorldTile &tile, std::shared_ptr<const CompactTile> &r_tile) {
	r_tile = world_.find(tile);
	return {};
}

Status InstanceWorld::NearSource::find_tile(const WorldTile &tile, std::shared_ptr<const CompactTile> &r_tile) {
	r_tile = world_.find(tile);
	if (r_tile == nullptr) {
		world_.miss(tile);
		const auto outdated = world_.tiles_.find(key_of(tile));
		r_tile = outdated != world_.tiles_.end() ? outdated->second.tile : nullptr;
	}
	return {};
}

std::shared_ptr<const CompactTile> InstanceWorld::GeneratingSource::find(const WorldTile &tile) {
	return world_.find(tile);
}

Status InstanceWorld::GeneratingSource::make(
		std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles) {
	// The maker is copied, because a script that provides the ground may replace it.
	const TileMaker maker = world_.maker_;
	edits_ = world_.edits_;
	return maker(tiles, r_tiles);
}

void InstanceWorld::GeneratingSource::keep(const WorldTile &tile, const std::shared_ptr<const CompactTile> &generated) {
	if (edits_ == world_.edits_) {
		world_.keep(tile, generated);
	}
}

} // namespace thicket
