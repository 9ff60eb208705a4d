#include "nodes/scatter/build_at_once.hpp"

#include "core/base/guard.hpp"

#include <algorithm>
#include <span>
#include <vector>

namespace thicket {

namespace {

/// Throws std::bad_alloc.
Status build_in_steps(const LayerSettings &layer, const Terrain *ground, const HostedTerrain &terrain, const Rect &rect,
		TileInstances &r_tile) {
	TileBuilder builder;
	if (ground != nullptr) {
		return builder.build(layer, *ground, rect, r_tile);
	}
	Status status = builder.find_points(layer, rect);
	std::vector<Ground> answers(status.ok() ? builder.positions().size() : 0);
	for (std::size_t i = 0; status.ok() && i < builder.queries().size(); ++i) {
		const GroundQuery &query = builder.queries()[i];
		status = terrain.sample_now(builder.positions().subspan(query.first, query.count), query.textures,
				std::span(answers).subspan(query.first, query.count));
	}
	return status.ok() ? builder.place(answers, r_tile) : status;
}

} // namespace

Status build_at_once(const LayerSettings &layer, const Terrain *ground, const HostedTerrain &terrain, const Rect &rect,
		TileInstances &r_tile) {
	return guarded("rect", std::max(rect.size().x, rect.size().y),
			[&] { return build_in_steps(layer, ground, terrain, rect, r_tile); });
}

} // namespace thicket
