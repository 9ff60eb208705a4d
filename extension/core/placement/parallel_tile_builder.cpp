#include "core/placement/parallel_tile_builder.hpp"

#include "core/base/guard.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>

namespace thicket {

Status ParallelTileBuilder::build(std::span<const TileOrder> orders, const Terrain &terrain, CallerThreads &threads,
		std::vector<std::shared_ptr<const CompactTile>> &r_tiles) {
	std::vector<Status> statuses;
	const auto all = static_cast<double>(orders.size());
	if (const Status status = guarded("tiles", all,
				[&] {
					r_tiles.assign(orders.size(), nullptr);
					statuses.resize(orders.size());
					workers_.resize(std::max(workers_.size(), threads.count() + 1));
				});
			!status.ok()) {
		r_tiles.clear();
		return status;
	}
	std::atomic<std::size_t> next = 0;
	std::atomic<bool> has_failed = false;
	const auto make = [&](std::unique_ptr<Worker> &r_worker, std::size_t at) -> Status {
		if (r_worker == nullptr) {
			r_worker = std::make_unique<Worker>(blocks_, instances_);
		}
		const TileOrder &order = orders[at];
		const Status status = r_worker->builder.build(*order.layer, terrain, order.space, r_worker->tile);
		if (status.ok()) {
			points_computed_ += r_worker->builder.sample_stats().computed;
			r_tiles[at] = std::make_shared<const CompactTile>(r_worker->tile, order.layer);
		}
		if (r_worker->builder.positions().size() > TileBuilder::max_kept_points) {
			r_worker = nullptr;
		}
		return status;
	};
	threads.run([&](std::size_t index) {
		for (std::size_t at = next++; at < orders.size() && !has_failed; at = next++) {
			const glm::dvec2 size = orders[at].space.size();
			statuses[at] = guarded("tile", std::max(size.x, size.y), [&] { return make(workers_[index], at); });
			has_failed = has_failed || !statuses[at].ok();
		}
	});
	const auto first = std::ranges::find_if(statuses, [](const Status &status) { return !status.ok(); });
	return first != statuses.end() ? *first : Status{};
}

} // namespace thicket
