#include "core/query/instance_snapshot.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

namespace thicket {

InstanceSnapshot::InstanceSnapshot(const InstanceWorld &world, std::optional<InstanceState> state, TileMaker maker) :
		layers_(world.layers().begin(), world.layers().end()), known_(world.known_tiles()), maker_(std::move(maker)),
		state_(std::move(state)) {}

/// Completes the shared state. The first query calls this function instead of the constructor,
/// because completing the state is slow for many hand-placed instances.
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
	const auto generated = generated_.find(key);
	return generated != generated_.end() ? generated->second : nullptr;
}

void InstanceSnapshot::keep(const WorldTile &tile, const Tile &generated) const {
	const std::lock_guard lock(mutex_);
	if (generated_instances_ > max_generated_instances) {
		generated_.clear();
		generated_instances_ = 0;
	}
	if (generated_.emplace(key_of(tile), generated).second) {
		generated_instances_ += cached_size(*generated);
	}
}

InstanceSnapshot::Tile InstanceSnapshot::Source::find(const WorldTile &tile) { return snapshot_.find(tile); }

Status InstanceSnapshot::Source::make(std::span<const WorldTile> tiles, std::vector<Tile> &r_tiles) {
	return snapshot_.maker_(tiles, r_tiles);
}

void InstanceSnapshot::Source::keep(const WorldTile &tile, const Tile &generated) { snapshot_.keep(tile, generated); }

} // namespace thicket
