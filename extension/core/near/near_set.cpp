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
		const glm::dvec3 apart = position - center;
		nearest = std::min(nearest, glm::dot(apart, apart));
	}
	return nearest;
}

} // namespace

bool NearSet::Held::stands_as(const PlacedInstance &instance) const {
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
		// Fast path: it is near the center that it was near before, so no other is asked.
		return true;
	}
	center = static_cast<std::size_t>(std::find_if(centers.begin(), centers.end(), reaches) - centers.begin());
	return center < centers.size();
}

bool NearSet::hold(const PlacedInstance &instance) {
	const Held held{instance.position, instance.basis, instance.layer, instance.mesh, looks_, 0};
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
	leave.clear();
	gone = 0;
}

bool NearSet::look(std::span<const glm::dvec3> centers, const NearRange &range,
		std::span<const PlacedInstance> standing, NearChanges &r_changes) {
	return guarded_answer("standing", static_cast<double>(standing.size()), r_changes, [&] {
		find_changes(centers, range, standing, r_changes);
	}).ok();
}

void NearSet::find_changes(std::span<const glm::dvec3> centers, const NearRange &range,
		std::span<const PlacedInstance> standing, NearChanges &r_changes) {
	++looks_;
	entering_.clear();
	gone_.clear();
	leaving_.clear();
	const bool ever = range.enter > 0.0;
	const double leave = std::max(range.enter, range.leave);
	for (std::size_t i = 0; i < standing.size() && ever; ++i) {
		const PlacedInstance &instance = standing[i];
		const auto held = held_.find(instance.id);
		if (held != held_.end() && held->second.stands_as(instance)) {
			held->second.seen = looks_;
			continue;
		}
		const double away = distance_squared(centers, instance.position);
		const double reach = held != held_.end() ? leave : range.enter;
		if (away <= reach * reach) {
			entering_.push_back({away, instance.id, i});
		}
	}
	for (auto &[id, held] : held_) {
		const bool near = ever && held.is_near(centers, leave * leave);
		if (!near || held.seen != looks_) {
			(near ? gone_ : leaving_).push_back({distance_squared(centers, held.position), id, 0});
		}
	}
	std::sort(entering_.begin(), entering_.end(), [](const Distant &a, const Distant &b) {
		return a.distance_squared != b.distance_squared ? a.distance_squared < b.distance_squared : a.id < b.id;
	});
	r_changes.enter.clear();
	for (const Distant &distant : entering_) {
		if (r_changes.enter.empty() || r_changes.enter.back().id != distant.id) {
			r_changes.enter.push_back(standing[distant.index]);
		}
	}
	r_changes.leave.clear();
	r_changes.gone = gone_.size();
	for (std::vector<Distant> *part : {&gone_, &leaving_}) {
		std::sort(part->begin(), part->end(), [](const Distant &a, const Distant &b) {
			return a.distance_squared != b.distance_squared ? a.distance_squared > b.distance_squared : a.id < b.id;
		});
		for (const Distant &distant : *part) {
			r_changes.leave.push_back(distant.id);
		}
	}
}

} // namespace thicket
