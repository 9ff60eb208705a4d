#include "core/explain/model_probe.hpp"

#include "core/base/guard.hpp"

namespace thicket {

namespace {

/// Models are found for the points in a cube around the position. This is half the edge length of
/// the cube, in radii of the layer's set.
constexpr double radii_around = 4.0;

} // namespace

Status ModelProbe::find(const LayerSettings &layer, const glm::dvec3 &place, const Surface *surface) {
	return guarded("place", place.x, [&] {
		positions_.clear();
		queries_.clear();
		filter_.set(layer);
		const glm::dvec2 center(place.x, place.z);
		const double around = radii_around * layer.set.radius;
		// A whole column may extend through a planet.
		const TileSpace space({center - around, center + around}, place.y - around, place.y + around);
		const Status status = filter_.sample(space, surface, nullptr);
		if (status.ok()) {
			filter_.add_queries(positions_, queries_);
		}
		return status;
	});
}

Status ModelProbe::models(std::span<const Ground> ground, std::unique_ptr<const Surface> &r_models) {
	if (ground.size() != positions_.size()) {
		return Status::wrong_size("ground", ground.size(), exactly(positions_.size()));
	}
	return guarded("ground", static_cast<double>(ground.size()), [&] {
		const Status status = filter_.filter_neighbors(ground);
		return status.ok() ? filter_.models_around(ground, r_models) : status;
	});
}

} // namespace thicket
