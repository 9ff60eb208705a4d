#include "nodes/scatter/build_at_once.hpp"

#include <span>
#include <vector>

namespace thicket {

Status build_at_once(const LayerSettings &layer, const Terrain *ground, const ScatterTerrain &terrain, const Rect &rect,
		TileInstances &r_tile) {
	TileBuilder builder;
	if (ground != nullptr) {
		return builder.build(layer, *ground, rect, r_tile);
	}
	Status status = builder.find_points(layer, rect);
	std::vector<Ground> answers(status.ok() ? builder.positions().size() : 0);
	for (std::size_t i = 0; status.ok() && i < builder.queries().size(); ++i) {
		const GroundQuery &query = builder.queries()[i];
		status = terrain.ask(builder.positions().subspan(query.first, query.count), query.textures,
				std::span(answers).subspan(query.first, query.count));
	}
	return status.ok() ? builder.place(answers, r_tile) : status;
}

} // namespace thicket
