#include "nodes/scatter/build_at_once.hpp"

#include <span>
#include <vector>

namespace thicket {

Status build_at_once(const LayerPlan &plan, const HostedTerrain &terrain, const Rect &rect, TileInstances &r_tile) {
	TileBuilder builder;
	if (plan.terrain != nullptr) {
		return builder.build(*plan.settings, *plan.terrain, rect, r_tile);
	}
	Status status = builder.find_points(*plan.settings, rect);
	std::vector<Ground> ground(status.ok() ? builder.positions().size() : 0);
	for (std::size_t i = 0; status.ok() && i < builder.queries().size(); ++i) {
		const GroundQuery &query = builder.queries()[i];
		status = terrain.sample_now(builder.positions().subspan(query.first, query.count), query.textures,
				std::span(ground).subspan(query.first, query.count));
	}
	return status.ok() ? builder.place(ground, r_tile) : status;
}

} // namespace thicket
