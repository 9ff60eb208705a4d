#include "core/near/near_set.hpp"

#include "core/base/guard.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

double distance_squared(std::span<const glm::dvec3> centers, glm::dvec3 position) {
	double nearest = std::numeric_limits<double>::infinity();
	for (const glm::dvec3 &center : centers) {
		const glm::dvec3 offset = position - center;
		nearest = std::min(nearest, glm::dot(offset, offset));
	}
	return nearest;
}

} // namespace

bool NearSet::Held::is_placed_as(const PlacedInstance &instance) const {
	const glm::dvec3 moved = instance.position - position;
	if (layer != instance.layer || mesh != instance.mesh ||
			!(glm::dot(moved, moved) <= same_position * same_position)) {
		return false;
	}
	for (int column = 0; column < 3; ++column) {
		for (int row = 0; row < 3; ++row) {
			if (!(std::abs(instance.basis[column][row] - basis[column][row]) <= same_basis)) {
				return false;
			}
		}
	}
	return true;
}

bool NearSet::Held::is_near(std::span<const glm::dvec3> centers, double reach_squared) {
	const auto reaches = [&](const glm::dvec3 &from) {
		return glm::dot(position - from, position - from) <= reach_squared;
	};
	if (center < centers.size() && reaches(centers[center])) {
		// If the instance is still near the same center, the other centers need no check.
		return true;
	}
	center = static_cast<std::size_t>(std::find_if(centers.begin(), centers.end(), reaches) - centers.begin());
	return center < centers.size();
}

bool NearSet::retain(const PlacedInstance &instance) {
	const Held held{instance.position, instance.basis, instance.layer, instance.mesh, check_count_, 0, 0};
	return guarded("instance", 1.0, [&] { held_.insert_or_assign(instance.id, held); }).ok();
}

std::vector<PlacedInstance> NearSet::held() const {
	std::vector<PlacedInstance> result;
	for (const auto &[id, held] : held_) {
		PlacedInstance instance;
		instance.id = id;
		instance.layer = held.layer;
		instance.mesh = held.mesh;
		instance.position = held.position;
		instance.basis = held.basis;
		result.push_back(instance);
	}
	return result;
}

void NearChanges::clear() {
	enter.clear();
	changed.clear();
	leave.clear();
	removed_count = 0;
}

bool NearSet::find_changes(std::span<const glm::dvec3> centers, const NearRange &range,
		std::span<const PlacedInstance> present, NearChanges &r_changes) {
	return guarded_answer("standing", static_cast<double>(present.size()), r_changes, [&] {
		find_changes_or_throw(centers, range, present, r_changes);
	}).ok();
}

void NearSet::sort_nearest(std::vector<Distant> &r_distant) {
	std::sort(r_distant.begin(), r_distant.end(), [](const Distant &a, const Distant &b) {
		return a.distance_squared != b.distance_squared ? a.distance_squared < b.distance_squared : a.id < b.id;
	});
}

/// Copies the instances of `from` to `r_to`, without duplicates. `from` is sorted, so duplicates
/// are adjacent.
void NearSet::take(
		std::span<const Distant> from, std::span<const PlacedInstance> present, std::vector<PlacedInstance> &r_to) {
	r_to.clear();
	for (const Distant &distant : from) {
		if (r_to.empty() || r_to.back().id != distant.id) {
			r_to.push_back(present[distant.index]);
		}
	}
}

void NearSet::find_changes_or_throw(std::span<const glm::dvec3> centers, const NearRange &range,
		std::span<const PlacedInstance> present, NearChanges &r_changes) {
	++check_count_;
	entering_.clear();
	changed_.clear();
	leaving_.clear();
	const bool ever = range.enter > 0.0;
	const double leave = std::max(range.enter, range.leave);
	for (std::size_t i = 0; i < present.size() && ever; ++i) {
		const PlacedInstance &instance = present[i];
		const auto held = held_.find(instance.id);
		const bool is_held = held != held_.end();
		if (is_held && held->second.is_placed_as(instance)) {
			held->second.seen = check_count_;
			continue;
		}
		const double away = distance_squared(centers, instance.position);
		const double reach = is_held ? leave : range.enter;
		if (away <= reach * reach) {
			(is_held ? changed_ : entering_).push_back({away, instance.id, i});
			if (is_held) {
				held->second.changed = check_count_;
			}
		}
	}
	sort_nearest(entering_);
	sort_nearest(changed_);
	take(entering_, present, r_changes.enter);
	take(changed_, present, r_changes.changed);
	r_changes.leave.clear();
	for (auto &[id, held] : held_) {
		if (held.changed == check_count_) {
			continue;
		}
		const bool near = held.is_near(centers, leave * leave);
		if (!ever || !near || held.seen != check_count_) {
			const NearRelease leaving{id, held.position, distance_squared(centers, held.position)};
			(near || !ever ? r_changes.leave : leaving_).push_back(leaving);
		}
	}
	r_changes.removed_count = r_changes.leave.size();
	const auto nearer = [](const NearRelease &a, const NearRelease &b) {
		return a.distance_squared != b.distance_squared ? a.distance_squared < b.distance_squared : a.id < b.id;
	};
	std::sort(r_changes.leave.begin(), r_changes.leave.end(), nearer);
	std::sort(leaving_.begin(), leaving_.end(), [&nearer](const NearRelease &a, const NearRelease &b) {
		return a.distance_squared != b.distance_squared ? nearer(b, a) : a.id < b.id;
	});
	r_changes.leave.insert(r_changes.leave.end(), leaving_.begin(), leaving_.end());
}

} // namespace thicket
