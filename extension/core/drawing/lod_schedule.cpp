#include "core/drawing/lod_schedule.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace thicket {

namespace {

glm::dvec3 position_of(const Viewer &viewer) { return {viewer.position.x, viewer.height, viewer.position.y}; }

/// Meters per frame. A larger movement is treated as a jump, because it would degrade the precision
/// of the accumulated sum.
constexpr double farthest_step = 1e7;

double length(glm::dvec3 v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }

auto ordered(const TileKey &key) { return std::tie(key.layer, key.grid, key.tile.x, key.tile.y, key.slab); }

} // namespace

bool LodSchedule::KeyOrder::operator()(const TileKey &a, const TileKey &b) const { return ordered(a) < ordered(b); }

bool LodSchedule::VisitOrder::operator()(const Visit &a, const Visit &b) const {
	return a.at != b.at ? a.at < b.at : ordered(a.key) < ordered(b.key);
}

bool LodSchedule::move(std::span<const Viewer> viewers) {
	bool others = viewers.size() != viewers_.size();
	double farthest = 0.0;
	for (std::size_t i = 0; !others && i < viewers.size(); ++i) {
		farthest = std::max(farthest, length(position_of(viewers[i]) - position_of(viewers_[i])));
	}
	others = others || !(farthest <= farthest_step);
	traveled_ += others ? 0.0 : farthest;
	viewers_.assign(viewers.begin(), viewers.end());
	return others;
}

void LodSchedule::add(const TileKey &key, double margin) {
	const double at = traveled_ + margin;
	const auto known = by_tile_.find(key);
	if (!std::isfinite(at)) {
		remove(key);
	} else if (known == by_tile_.end()) {
		by_tile_.emplace(key, visits_.insert({at, key}).first);
	} else {
		Visits::node_type visit = visits_.extract(known->second);
		visit.value().at = at;
		known->second = visits_.insert(std::move(visit)).position;
	}
}

void LodSchedule::remove(const TileKey &key) {
	if (const auto known = by_tile_.find(key); known != by_tile_.end()) {
		visits_.erase(known->second);
		by_tile_.erase(known);
	}
}

void LodSchedule::clear() {
	visits_.clear();
	by_tile_.clear();
}

std::optional<TileKey> LodSchedule::next() {
	if (settled()) {
		return std::nullopt;
	}
	const TileKey key = visits_.begin()->key;
	remove(key);
	return key;
}

DistanceRange LodSchedule::distances_to(glm::dvec3 min, glm::dvec3 max, const Sight &sight) const {
	constexpr double nowhere = std::numeric_limits<double>::infinity();
	DistanceRange nearest{nowhere, nowhere};
	for (const Viewer &viewer : viewers_) {
		const glm::dvec3 at = position_of(viewer);
		const glm::dvec3 before = min - at;
		const glm::dvec3 behind = at - max;
		const glm::dvec3 gap = glm::max(glm::max(before, behind), glm::dvec3(0.0));
		const glm::dvec3 reach = glm::max(glm::abs(before), glm::abs(behind));
		const double limit = sight.height_limit(viewer.radius_scale);
		const double near = sight_distance(length({gap.x, 0.0, gap.z}), length(gap), limit);
		const double far = sight_distance(length({reach.x, 0.0, reach.z}), length(reach), limit);
		if (near < nearest.near) {
			nearest.near = near;
			nearest.far = far;
		}
		nearest.sight = std::min(nearest.sight, far - sight.beyond(viewer.radius_scale));
	}
	return nearest;
}

} // namespace thicket
