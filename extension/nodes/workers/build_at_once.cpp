#include "nodes/workers/build_at_once.hpp"

#include "core/base/guard.hpp"
#include "core/near/tile_overlay.hpp"
#include "nodes/common/threads.hpp"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

Status query_synchronously(const Terrain *terrain, const HostedGround &ground, std::span<const glm::dvec2> positions,
		std::span<const GroundQuery> queries, std::vector<Ground> &r_answers) {
	r_answers.assign(positions.size(), Ground{});
	if (terrain != nullptr) {
		return query_ground(*terrain, positions, queries, r_answers);
	}
	for (const GroundQuery &query : queries) {
		const std::span<const glm::dvec2> query_positions = positions.subspan(query.first, query.count);
		const std::span<Ground> answers = std::span(r_answers).subspan(query.first, query.count);
		Status status = ground.sample_now(query_positions, query.needs, answers);
		if (status.ok()) {
			status = query.density.query(query_positions, answers);
		}
		if (!status.ok()) {
			return status;
		}
	}
	return {};
}

std::unique_ptr<TileBuilder> SynchronousBuilder::take_builder() {
	if (spare_builder_ != nullptr) {
		// Reuses the memory of the previous tile.
		return std::move(spare_builder_);
	}
	return std::make_unique<TileBuilder>(SampleMargins{}, blocks_, instances_);
}

/// Generates one tile. Throws std::bad_alloc.
Status SynchronousBuilder::build_in_steps(const LayerSettings &layer, const Terrain *terrain,
		const HostedGround &ground, const TileSpace &space, TileInstances &r_tile) {
	std::unique_ptr<TileBuilder> builder = take_builder();
	EngineThreads threads;
	Status status;
	if (terrain != nullptr && !needs_main_thread(layer)) {
		status = builder->build(layer, *terrain, space, r_tile, nullptr, &threads);
	} else {
		const Surface *surface = terrain != nullptr ? terrain->surface() : nullptr;
		status = builder->find_points(layer, space, nullptr, &threads, surface);
		std::vector<Ground> answers;
		if (status.ok()) {
			status = query_in_steps(terrain, ground, *builder, answers);
		}
		status = status.ok() ? builder->place(answers, r_tile) : status;
	}
	points_computed_ += builder->sample_stats().computed;
	if (builder->positions().size() <= TileBuilder::max_kept_points) {
		spare_builder_ = std::move(builder);
	}
	return status;
}

Status SynchronousBuilder::build(const LayerSettings &layer, const Terrain *terrain, const HostedGround &ground,
		const TileSpace &space, TileInstances &r_tile) {
	return guarded("rect", std::max(space.size().x, space.size().y),
			[&] { return build_in_steps(layer, terrain, ground, space, r_tile); });
}

Status SynchronousBuilder::build_all(std::span<const TileOrder> orders, const Terrain *terrain,
		const HostedGround &ground, std::vector<std::shared_ptr<const CompactTile>> &r_tiles) {
	const bool are_rules_thread_safe =
			std::ranges::none_of(orders, [](const TileOrder &order) { return needs_main_thread(*order.layer); });
	if (terrain != nullptr && orders.size() > 1 && are_rules_thread_safe) {
		// The tiles do not depend on which threads generate them.
		EngineThreads threads;
		return parallel_builder_.build(orders, *terrain, threads, r_tiles);
	}
	r_tiles.clear();
	for (const TileOrder &order : orders) {
		TileInstances instances;
		if (const Status status = build(*order.layer, terrain, ground, order.space, instances); !status.ok()) {
			return status;
		}
		r_tiles.push_back(std::make_shared<const CompactTile>(instances, order.layer));
	}
	return {};
}

Status apply_state(const LayerSettings &layer, const Rect &rect, const InstanceState &state, CompactTile &r_tile) {
	return guarded("rect", std::max(rect.size().x, rect.size().y), [&] {
		const auto tile = std::make_shared<CompactTile>(std::move(r_tile));
		OverlaidMeshes meshes;
		const Status status = overlaid(tile, layer, rect, {.state = &state}, meshes);
		for (std::size_t mesh = 0; mesh < meshes.size(); ++mesh) {
			if (meshes[mesh].get() != &tile->meshes[mesh]) {
				tile->meshes[mesh] = *meshes[mesh];
			}
		}
		r_tile = std::move(*tile);
		return status;
	});
}

} // namespace thicket
