#include "core/near/near_cell.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>

namespace thicket {

namespace {

double squared(glm::dvec3 a, glm::dvec3 b) { return glm::dot(a - b, a - b); }

} // namespace

bool same_within(double slack, std::span<const glm::dvec3> now, std::span<const glm::dvec3> then) {
	return std::ranges::equal(
			now, then, [slack](const glm::dvec3 &a, const glm::dvec3 &b) { return squared(a, b) <= slack * slack; });
}

namespace {

/// The part of a cell that the centers reach.
Rect reached(const Rect &cell, std::span<const glm::dvec3> centers, double reach) {
	glm::dvec2 lowest{std::numeric_limits<double>::infinity()};
	glm::dvec2 highest = -lowest;
	for (const glm::dvec3 &center : centers) {
		lowest = glm::min(lowest, glm::dvec2(center.x, center.z) - reach);
		highest = glm::max(highest, glm::dvec2(center.x, center.z) + reach);
	}
	return {glm::max(cell.min, lowest), glm::min(cell.max, highest)};
}

} // namespace

bool NearCell::outdated(double slack, std::uint64_t world_version) const {
	return again_ || version_ != world_version || !same_within(slack, centers_, looked_at_);
}

std::size_t NearCell::look(std::uint32_t layer, const Rect &of, const NearRange &range, const InstanceWorld &world,
		std::uint64_t world_version, std::vector<PlacedInstance> &r_standing) {
	forget_changes();
	r_standing.clear();
	const Rect rect = reached(of, centers_, range.leave);
	if (!rect.empty() && layer < world.layers().size()) {
		world.known_in(layer, rect, r_standing);
	}
	const std::size_t cost = r_standing.size() + near_.size();
	if (!near_.look(centers_, range, r_standing, changes_)) {
		return cost;
	}
	for (const PlacedInstance &instance : changes_.enter) {
		double nearest = std::numeric_limits<double>::infinity();
		for (const glm::dvec3 &center : centers_) {
			nearest = std::min(nearest, squared(center, instance.position));
		}
		away_.push_back(nearest);
	}
	looked_at_ = centers_;
	maybe_changed_ = true;
	again_ = false;
	frames_ = 0;
	version_ = world_version;
	return cost;
}

std::uint64_t NearCell::take_leaving() {
	const std::uint64_t id = changes_.leave[left_++];
	near_.release(id);
	return id;
}

PlacedInstance NearCell::take_entering() {
	const PlacedInstance instance = changes_.enter[entered_++];
	near_.hold(instance);
	return instance;
}

bool NearCell::take_changed(PlacedInstance &r_instance) {
	if (!maybe_changed_) {
		// Fast path: nothing that enters is held, as a look at all of it has shown.
		return false;
	}
	const auto first = changes_.enter.begin() + static_cast<std::ptrdiff_t>(entered_);
	const auto changed = std::find_if(
			first, changes_.enter.end(), [this](const PlacedInstance &instance) { return near_.holds(instance.id); });
	maybe_changed_ = changed != changes_.enter.end();
	if (!maybe_changed_) {
		return false;
	}
	r_instance = *changed;
	near_.hold(r_instance);
	away_.erase(away_.begin() + (changed - changes_.enter.begin()));
	changes_.enter.erase(changed);
	const auto leaves =
			std::find(changes_.leave.begin() + static_cast<std::ptrdiff_t>(left_), changes_.leave.end(), r_instance.id);
	if (leaves != changes_.leave.end()) {
		changes_.gone -= leaves - changes_.leave.begin() < static_cast<std::ptrdiff_t>(changes_.gone) ? 1 : 0;
		changes_.leave.erase(leaves);
	}
	return true;
}

void NearCell::forget_changes() {
	changes_.clear();
	away_.clear();
	left_ = 0;
	entered_ = 0;
	version_ = 0;
}

} // namespace thicket
