#pragma once

#include "core/base/mutex.hpp"
#include "core/base/status.hpp"
#include "core/placement/compact_tile.hpp"
#include "core/placement/parallel_tile_builder.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/terrain/terrain.hpp"

#include <cstddef>
#include <memory>
#include <vector>

namespace thicket {

/// Generates tiles on the threads of its callers, several at a time. Caches the points around tiles
/// and a few workspaces for later calls.
class SharedBuilder {
public:
	/// Generates one tile. Any thread may call this method.
	Status build(const TileOrder &order, const Terrain &ground, std::shared_ptr<const CompactTile> &r_tile);

private:
	static constexpr std::size_t max_spare_builders = 8;

	std::unique_ptr<TileBuilder> take();
	void give_back(std::unique_ptr<TileBuilder> builder);

	std::shared_ptr<BlockCache> blocks_ = std::make_shared<BlockCache>();
	std::shared_ptr<InstanceCache> instances_ = std::make_shared<InstanceCache>();
	Mutex mutex_;
	std::vector<std::unique_ptr<TileBuilder>> spare_builders_; ///< The unused builders, guarded by `mutex_`.
};

} // namespace thicket
