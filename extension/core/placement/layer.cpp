#include "core/placement/layer.hpp"

#include "core/base/check.hpp"
#include "core/placement/layer_graph.hpp"
#include "core/placement/mesh_choice.hpp"

#include <algorithm>

namespace thicket {

namespace {

Status validate_alone(const LayerSettings &layer) {
	return first_failure(validate(layer.set), validate(layer.rules), validate(layer.placement),
			validate(layer.instance_data), validate_mesh_weights(layer.mesh_weights));
}

} // namespace

Status validate(const LayerSettings &layer) {
	const LayerGraph graph(layer);
	Status status = graph.status();
	for (std::size_t i = graph.nodes().size(); status.ok() && i-- > 0;) {
		status = validate_alone(*graph.nodes()[i].layer);
	}
	return status;
}

bool follows_normals(const LayerSettings &layer) {
	const Placement &placement = layer.placement;
	const InstanceData &data = layer.instance_data;
	return placement.align_to_normal != 0.0 || placement.offset_along_normal != 0.0 ||
			(data.color_is_known() && data.color.kind == SourceKind::slope) ||
			(data.variation_is_known() && data.variation.kind == SourceKind::slope);
}

double reach(const LayerSettings &layer) {
	double farthest = 0.0;
	const LayerGraph graph(layer);
	for (const LayerGraph::Node &node : graph.nodes()) {
		farthest = std::max(farthest, node.margin + node.layer->rules.edge_feather);
	}
	return farthest;
}

double points_to_sample(const LayerSettings &layer, double tile_size) {
	double points = 0.0;
	const LayerGraph graph(layer);
	for (const LayerGraph::Node &node : graph.nodes()) {
		const double side = tile_size + 2.0 * node.margin;
		points += point_density(node.layer->set) * side * side;
	}
	return points;
}

} // namespace thicket
