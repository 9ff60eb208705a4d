#include "core/placement/layer.hpp"

#include "core/base/check.hpp"
#include "core/placement/mesh_choice.hpp"

#include <algorithm>

namespace thicket {

namespace {

Status validate_at_depth(const LayerSettings &layer, std::size_t depth);

Status validate_neighbour(const Neighbour &neighbour, std::size_t depth) {
	if (neighbour.layer == nullptr) {
		return {ErrorCode::missing, "neighbours", 0.0};
	}
	return first_failure(check_positive("neighbour distance", neighbour.distance),
			check_range("neighbour distance", neighbour.distance, 0.0, max_neighbour_distance),
			validate_at_depth(*neighbour.layer, depth + 1));
}

Status validate_at_depth(const LayerSettings &layer, std::size_t depth) {
	if (depth > max_neighbour_depth) {
		return {ErrorCode::out_of_range, "depth of neighbours", static_cast<double>(depth)};
	}
	if (layer.neighbours.size() > max_neighbours) {
		return {ErrorCode::out_of_range, "neighbours", static_cast<double>(layer.neighbours.size())};
	}
	Status status = first_failure(validate(layer.set), validate(layer.rules), validate(layer.placement),
			validate(layer.look), validate_mesh_weights(layer.mesh_weights));
	for (std::size_t i = 0; status.ok() && i < layer.neighbours.size(); ++i) {
		status = validate_neighbour(layer.neighbours[i], depth);
	}
	return status;
}

bool same_neighbour(const Neighbour &a, const Neighbour &b) {
	return a.distance == b.distance && a.curve == b.curve && same_but_for_edits(*a.layer, *b.layer);
}

/// A layer's own settings without what is edited in place; its neighbours are left out too.
bool same_alone(const LayerSettings &a, const LayerSettings &b) {
	const auto without_edits = [](const Rules &rules) {
		Rules result = rules;
		result.mask = nullptr;
		result.shapes = nullptr;
		return result;
	};
	return a.set == b.set && a.placement == b.placement && a.look == b.look && a.mesh_weights == b.mesh_weights &&
			without_edits(a.rules) == without_edits(b.rules);
}

} // namespace

Status validate(const LayerSettings &layer) { return validate_at_depth(layer, 0); }

bool same_but_for_edits(const LayerSettings &a, const LayerSettings &b) {
	return &a == &b ||
			(same_alone(a, b) &&
					std::equal(a.neighbours.begin(), a.neighbours.end(), b.neighbours.begin(), b.neighbours.end(),
							same_neighbour));
}

double reach(const LayerSettings &layer) {
	double farthest = 0.0;
	for (const Neighbour &neighbour : layer.neighbours) {
		farthest = std::max(farthest, neighbour.distance + reach(*neighbour.layer));
	}
	return std::max(farthest, layer.rules.edge_feather);
}

double points_to_sample(const LayerSettings &layer, double tile_size) {
	double points = point_density(layer.set) * tile_size * tile_size;
	for (const Neighbour &neighbour : layer.neighbours) {
		points += points_to_sample(*neighbour.layer, tile_size + 2.0 * neighbour.distance);
	}
	return points;
}

} // namespace thicket
