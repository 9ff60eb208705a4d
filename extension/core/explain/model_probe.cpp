#include "core/explain/model_probe.hpp"

#include "core/base/guard.hpp"

namespace thicket {

namespace {

/// Models are found for the points in a cube around the position. This is half the edge length of
/// the cube, in radii of the layer's set.
constexpr double half_edge_in_radii = 4.0;

} // namespace

Status ModelProbe::find(const LayerSettings &layer, const glm::dvec3 &position, const Surface *surface) {
	return guarded("position", position.x, [&] {
		filter_.set(layer);
		const glm::dvec2 center(position.x, position.z);
		const double half_edge = half_edge_in_radii * layer.set.radius;
		// The height is limited, because a column of unlimited height could extend through a planet.
		const TileSpace space({center - half_edge, center + half_edge}, position.y - half_edge, position.y + half_edge);
		const Status status = filter_.sample(space, surface, nullptr);
		gather_positions();
		return status;
	});
}

void ModelProbe::gather_positions() {
	positions_.clear();
	queries_.clear();
	filter_.add_queries(positions_, queries_);
}

Status ModelProbe::find_further(std::span<const Ground> ground) {
	if (const Status status = check_ground(ground, positions_.size()); !status.ok()) {
		return status;
	}
	return guarded("ground", static_cast<double>(ground.size()), [&] {
		const Status status = filter_.sample_further(ground);
		gather_positions();
		return status;
	});
}

Status ModelProbe::models(std::span<const Ground> ground, std::unique_ptr<const Surface> &r_models) {
	if (const Status status = check_ground(ground, positions_.size()); !status.ok()) {
		return status;
	}
	return guarded("ground", static_cast<double>(ground.size()), [&] {
		const Status status = filter_.filter_neighbors(ground);
		return status.ok() ? filter_.models_around(ground, r_models) : status;
	});
}

} // namespace thicket
