#include "core/near/near_cell.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>

namespace thicket {

namespace {

double squared(glm::dvec3 a, glm::dvec3 b) { return glm::dot(a - b, a - b); }

} // namespace

double squared_distance(glm::dvec3 position, std::span<const glm::dvec3> centers) {
	double nearest = std::numeric_limits<double>::infinity();
	for (const glm::dvec3 &center : centers) {
		nearest = std::min(nearest, glm::dot(position - center, position - center));
	}
	return nearest;
}

double squared_cell_distance(const Rect &cell, std::span<const glm::dvec3> centers) {
	double nearest = std::numeric_limits<double>::infinity();
	for (const glm::dvec3 &center : centers) {
		const glm::dvec2 at{center.x, center.z};
		const glm::dvec2 offset = at - glm::clamp(at, cell.min, cell.max);
		nearest = std::min(nearest, glm::dot(offset, offset));
	}
	return nearest;
}

bool same_within(double slack, std::span<const glm::dvec3> now, std::span<const glm::dvec3> then) {
	return std::ranges::equal(
			now, then, [slack](const glm::dvec3 &a, const glm::dvec3 &b) { return squared(a, b) <= slack * slack; });
}

namespace {

/// Returns the part of a cell that is within `reach` of the centers, as a bounding rectangle.
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

bool NearCell::outdated(double slack, const NearVersion &now) const {
	return needs_check_ || version_ != now || !same_within(slack, centers_, checked_centers_);
}

std::size_t NearCell::check(std::uint32_t layer, const Rect &of, const NearRange &range, const InstanceWorld &world,
		const NearVersion &now, std::vector<PlacedInstance> &r_present) {
	forget_changes();
	r_present.clear();
	const Rect rect = reached(of, centers_, range.leave);
	if (range.enter > 0.0 && !rect.empty() && layer < world.layers().size()) {
		find_present(layer, rect, range, world, r_present);
	}
	const std::size_t cost = r_present.size() + near_.size();
	if (!near_.find_changes(centers_, range, r_present, changes_)) {
		return cost;
	}
	for (const PlacedInstance &instance : changes_.enter) {
		entering_distances_squared_.push_back(squared_distance(instance.position, centers_));
	}
	checked_centers_ = centers_;
	needs_check_ = false;
	frames_ = 0;
	version_ = now;
	return cost;
}

/// Appends the instances of a layer in `rect`. If the layer's tiles are cubes, reads only the
/// heights within range of each center.
void NearCell::find_present(std::uint32_t layer, const Rect &rect, const NearRange &range, const InstanceWorld &world,
		std::vector<PlacedInstance> &r_present) const {
	if (!world.layers()[layer].in_space()) {
		world.known_in(layer, rect, r_present);
		return;
	}
	for (const glm::dvec3 &center : centers_) {
		world.known_in(layer, {rect, center.y - range.leave, center.y + range.leave}, r_present);
	}
}

void NearCell::follow(std::uint32_t layer, const Rect &of, const InstanceWorld &world, const NearVersion &now) {
	if (version_.world != 0 && version_.queue == now.queue && version_.world != now.world &&
			!world.changed_since(version_.world, layer, of)) {
		// The world did not change here, so a new check would return the same result.
		version_ = now;
	}
}

NearRelease NearCell::take_leaving() {
	const NearRelease leaving = changes_.leave[taken_leaving_++];
	near_.release(leaving.id);
	return leaving;
}

PlacedInstance NearCell::take_changed() {
	const PlacedInstance instance = changes_.changed[taken_changed_++];
	near_.retain(instance);
	return instance;
}

PlacedInstance NearCell::take_entering() {
	const PlacedInstance instance = changes_.enter[taken_entering_++];
	near_.retain(instance);
	return instance;
}

void NearCell::forget_changes() {
	changes_.clear();
	entering_distances_squared_.clear();
	taken_leaving_ = 0;
	taken_changed_ = 0;
	taken_entering_ = 0;
	version_ = {};
}

} // namespace thicket
