#include "nodes/workers/shared_builder.hpp"

#include "core/base/guard.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

namespace thicket {

std::unique_ptr<TileBuilder> SharedBuilder::take() {
	{
		const std::lock_guard lock(mutex_);
		if (!spare_builders_.empty()) {
			// Reuses the memory of an earlier tile.
			std::unique_ptr<TileBuilder> builder = std::move(spare_builders_.back());
			spare_builders_.pop_back();
			return builder;
		}
	}
	return std::make_unique<TileBuilder>(SampleMargins{}, blocks_, instances_);
}

void SharedBuilder::give_back(std::unique_ptr<TileBuilder> builder) {
	const std::lock_guard lock(mutex_);
	if (spare_builders_.size() < max_spare_builders && builder->positions().size() <= TileBuilder::max_kept_points) {
		spare_builders_.push_back(std::move(builder));
	}
}

Status SharedBuilder::build(const TileOrder &order, const Terrain &ground, std::shared_ptr<const CompactTile> &r_tile) {
	return guarded("rect", std::max(order.space.size().x, order.space.size().y), [&] {
		std::unique_ptr<TileBuilder> builder = take();
		TileInstances instances;
		const Status status = builder->build(*order.layer, ground, order.space, instances);
		if (status.ok()) {
			r_tile = std::make_shared<const CompactTile>(instances, order.layer);
		}
		give_back(std::move(builder));
		return status;
	});
}

} // namespace thicket
