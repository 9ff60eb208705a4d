#include "core/streaming/detail_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

glm::dvec3 place_of(const Viewer &viewer) { return {viewer.position.x, viewer.height, viewer.position.y}; }

double length(glm::dvec3 v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }

/// A heap's order: the next visit on top.
bool later(const DetailSchedule::Visit &a, const DetailSchedule::Visit &b) { return a.at > b.at; }

} // namespace

bool DetailSchedule::move(std::span<const Viewer> viewers) {
	const bool others = viewers.size() != viewers_.size();
	double farthest = 0.0;
	for (std::size_t i = 0; !others && i < viewers.size(); ++i) {
		farthest = std::max(farthest, length(place_of(viewers[i]) - place_of(viewers_[i])));
	}
	traveled_ += farthest;
	viewers_.assign(viewers.begin(), viewers.end());
	return others;
}

double DetailSchedule::add(const TileKey &key, double margin) {
	const double at = traveled_ + margin;
	if (std::isfinite(at)) {
		visits_.push_back({at, key});
		std::ranges::push_heap(visits_, later);
	}
	return at;
}

std::optional<DetailSchedule::Visit> DetailSchedule::next() {
	if (settled()) {
		return std::nullopt;
	}
	std::ranges::pop_heap(visits_, later);
	const Visit visit = visits_.back();
	visits_.pop_back();
	return visit;
}

double DetailSchedule::distance_to(glm::dvec3 min, glm::dvec3 max) const {
	double nearest = std::numeric_limits<double>::infinity();
	for (const Viewer &viewer : viewers_) {
		const glm::dvec3 at = place_of(viewer);
		const glm::dvec3 outside{std::max({min.x - at.x, at.x - max.x, 0.0}),
				std::max({min.y - at.y, at.y - max.y, 0.0}), std::max({min.z - at.z, at.z - max.z, 0.0})};
		nearest = std::min(nearest, length(outside));
	}
	return nearest;
}

} // namespace thicket
