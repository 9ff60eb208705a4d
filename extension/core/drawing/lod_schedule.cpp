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
constexpr double max_step = 1e7;

double length(glm::dvec3 v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }

auto ordered(const TileKey &key) { return std::tie(key.layer, key.grid, key.tile.x, key.tile.y, key.slab); }

} // namespace

bool LodSchedule::KeyOrder::operator()(const TileKey &a, const TileKey &b) const { return ordered(a) < ordered(b); }

bool LodSchedule::VisitOrder::operator()(const Visit &a, const Visit &b) const {
	return a.due_at != b.due_at ? a.due_at < b.due_at : ordered(a.key) < ordered(b.key);
}

bool LodSchedule::move(std::span<const Viewer> viewers) {
	bool has_changed = viewers.size() != viewers_.size();
	double farthest = 0.0;
	for (std::size_t i = 0; !has_changed && i < viewers.size(); ++i) {
		farthest = std::max(farthest, length(position_of(viewers[i]) - position_of(viewers_[i])));
	}
	has_changed = has_changed || !(farthest <= max_step);
	traveled_ += has_changed ? 0.0 : farthest;
	viewers_.assign(viewers.begin(), viewers.end());
	return has_changed;
}

void LodSchedule::add(const TileKey &key, double margin) {
	const double due_at = traveled_ + margin;
	const auto entry = tile_visits_.find(key);
	if (!std::isfinite(due_at)) {
		remove(key);
	} else if (entry == tile_visits_.end()) {
		tile_visits_.emplace(key, visits_.insert({due_at, key}).first);
	} else {
		Visits::node_type visit = visits_.extract(entry->second);
		visit.value().due_at = due_at;
		entry->second = visits_.insert(std::move(visit)).position;
	}
}

void LodSchedule::remove(const TileKey &key) {
	if (const auto entry = tile_visits_.find(key); entry != tile_visits_.end()) {
		visits_.erase(entry->second);
		tile_visits_.erase(entry);
	}
}

void LodSchedule::clear() {
	visits_.clear();
	tile_visits_.clear();
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
	constexpr double infinity = std::numeric_limits<double>::infinity();
	DistanceRange nearest{infinity, infinity};
	for (const Viewer &viewer : viewers_) {
		const glm::dvec3 position = position_of(viewer);
		const glm::dvec3 min_offset = min - position;
		const glm::dvec3 max_offset = position - max;
		const glm::dvec3 nearest_offset = glm::max(glm::max(min_offset, max_offset), glm::dvec3(0.0));
		const glm::dvec3 farthest_offset = glm::max(glm::abs(min_offset), glm::abs(max_offset));
		const double limit = sight.height_limit(viewer.radius_scale);
		const double near_distance =
				sight_distance(length({nearest_offset.x, 0.0, nearest_offset.z}), length(nearest_offset), limit);
		const double far_distance =
				sight_distance(length({farthest_offset.x, 0.0, farthest_offset.z}), length(farthest_offset), limit);
		if (near_distance < nearest.near) {
			nearest.near = near_distance;
			nearest.far = far_distance;
		}
		nearest.sight = std::min(nearest.sight, far_distance - sight.beyond(viewer.radius_scale));
	}
	return nearest;
}

} // namespace thicket
