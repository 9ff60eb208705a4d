#include "core/placement/layer.hpp"

#include "core/base/check.hpp"
#include "core/placement/mesh_choice.hpp"
#include "core/placement/neighbor_chain.hpp"

#include <algorithm>

namespace thicket {

namespace {

Status validate_alone(const LayerSettings &layer) {
	return first_failure(validate(layer.set), validate(layer.rules), validate(layer.placement), validate(layer.look),
			validate_mesh_weights(layer.mesh_weights));
}

} // namespace

Status validate(const LayerSettings &layer) {
	const NeighborChain chain(layer);
	Status status = chain.status();
	for (std::size_t i = chain.links().size(); status.ok() && i-- > 0;) {
		status = validate_alone(*chain.links()[i].layer);
	}
	return status;
}

double reach(const LayerSettings &layer) {
	double farthest = 0.0;
	const NeighborChain chain(layer);
	for (const NeighborChain::Link &link : chain.links()) {
		farthest = std::max(farthest, link.margin + link.layer->rules.edge_feather);
	}
	return farthest;
}

double points_to_sample(const LayerSettings &layer, double tile_size) {
	double points = 0.0;
	const NeighborChain chain(layer);
	for (const NeighborChain::Link &link : chain.links()) {
		const double side = tile_size + 2.0 * link.margin;
		points += point_density(link.layer->set) * side * side;
	}
	return points;
}

} // namespace thicket
