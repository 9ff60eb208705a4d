#include "core/explain/place_explainer.hpp"

#include "core/sampling/nearest_points.hpp"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>

namespace thicket {

namespace {

Status rule(const DensityProbe &probe, std::size_t place, RuledPlace &r_place) {
	r_place.ground = probe.ground_at(place);
	const Status status = probe.factors_at(place, r_place.factors);
	r_place.density = product_of(r_place.factors);
	return status;
}

} // namespace

Status PlaceExplainer::find(const LayerSettings &layer, glm::dvec2 place) {
	if (!std::isfinite(place.x) || !std::isfinite(place.y)) {
		return {ErrorCode::not_finite, "place", std::isfinite(place.x) ? place.y : place.x};
	}
	if (const Status status = validate(layer); !status.ok()) {
		return status;
	}
	place_ = place;
	if (const Status status = nearest_points(sampler_, layer.set, {&place, 1}, point_); !status.ok()) {
		return status;
	}
	const std::array<glm::dvec2, 2> places{place, point_.front().position};
	return probe_.find(layer, places, true);
}

Status PlaceExplainer::explain(std::span<const Ground> ground, PlaceExplanation &r_explanation) {
	Status status = probe_.look(ground);
	if (status.ok()) {
		status = rule(probe_, 0, r_explanation.place);
	}
	if (status.ok()) {
		status = rule(probe_, 1, r_explanation.at_point);
	}
	if (status.ok()) {
		r_explanation.point = point_.front();
		r_explanation.distance = glm::distance(place_, point_.front().position);
	}
	return status;
}

} // namespace thicket
