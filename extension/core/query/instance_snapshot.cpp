#include "core/query/instance_snapshot.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

namespace thicket {

InstanceSnapshot::InstanceSnapshot(const InstanceWorld &world, std::optional<InstanceState> state, TileMaker maker) :
		layers_(world.layers().begin(), world.layers().end()), known_(world.known_tiles()), maker_(std::move(maker)),
		state_(std::move(state)) {}

/// The first query does it, as it takes a while for many hand-placed instances.
Status InstanceSnapshot::complete_state() const {
	const std::lock_guard lock(mutex_);
	if (!complete_ && state_.has_value()) {
		if (const Status status = state_->complete(); !status.ok()) {
			return status;
		}
	}
	complete_ = true;
	return {};
}

InstanceSnapshot::Tile InstanceSnapshot::find(const WorldTile &tile) const {
	const WorldTileKey key = key_of(tile);
	const auto known = std::ranges::lower_bound(known_, key, {}, &KnownTile::key);
	if (known != known_.end() && known->key == key) {
		return known->tile;
	}
	const std::lock_guard lock(mutex_);
	const auto made = made_.find(key);
	return made != made_.end() ? made->second : nullptr;
}

void InstanceSnapshot::keep(const WorldTile &tile, const Tile &made) const {
	const std::lock_guard lock(mutex_);
	if (made_instances_ > max_made_instances) {
		made_.clear();
		made_instances_ = 0;
	}
	if (made_.emplace(key_of(tile), made).second) {
		made_instances_ += instance_count(*made) + 1; // A tile without instances takes memory, too.
	}
}

Status InstanceSnapshot::Source::find_tile(std::uint32_t layer, glm::ivec2 tile, Tile &r_tile) {
	std::vector<Tile> tiles;
	const WorldTile wanted{layer, tile};
	const Status status = find_tiles({&wanted, 1}, tiles);
	r_tile = tiles.empty() ? nullptr : tiles.front();
	return status;
}

Status InstanceSnapshot::Source::find_tiles(std::span<const WorldTile> tiles, std::vector<Tile> &r_tiles) {
	std::vector<WorldTile> missing;
	std::vector<std::size_t> missed; // Where each is missed in `tiles`.
	r_tiles.clear();
	for (const WorldTile &tile : tiles) {
		r_tiles.push_back(snapshot_.find(tile));
		if (r_tiles.back() == nullptr) {
			missed.push_back(r_tiles.size() - 1);
			missing.push_back(tile);
		}
	}
	if (missing.empty()) {
		// Fast path: all tiles are known.
		return {};
	}
	std::vector<Tile> made;
	const Status status = snapshot_.maker_(missing, made);
	made.resize(missing.size());
	for (std::size_t i = 0; i < missing.size(); ++i) {
		if (made[i] != nullptr) {
			snapshot_.keep(missing[i], made[i]);
		}
		r_tiles[missed[i]] = std::move(made[i]);
	}
	return status;
}

} // namespace thicket
