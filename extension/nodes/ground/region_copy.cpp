#include "nodes/ground/region_copy.hpp"

#include <algorithm>

using namespace godot;

namespace thicket {

Rect2 RegionCopy::area_of(glm::ivec2 location, const PixelRect &rect) const {
	const glm::dvec2 first = (glm::dvec2(location * field_.side() + rect.min) - 2.0) * field_.spacing() +
			glm::dvec2(origin_.x, origin_.z);
	const glm::dvec2 size = (glm::dvec2(rect.size()) + 3.0) * field_.spacing();
	return Rect2(static_cast<real_t>(first.x), static_cast<real_t>(first.y), static_cast<real_t>(size.x),
			static_cast<real_t>(size.y));
}

void RegionCopy::add_changes(const FieldRegion &mine, const FieldRegion *theirs, GroundChanges &r_changes) const {
	const PixelRect all{glm::ivec2(0), glm::ivec2(field_.side())};
	const auto add = [&](const PixelRect &rect) {
		if (!rect.empty()) {
			r_changes.areas.push_back(area_of(mine.location, rect));
		}
	};
	if (theirs == nullptr || mine.controls.empty() != theirs->controls.empty()) {
		add(all);
		return;
	}
	add(mine.heights.difference(theirs->heights));
	if (!mine.controls.empty()) {
		add(mine.controls.difference(theirs->controls));
	}
}

GroundChanges RegionCopy::changes_since(const GroundCopy &before, glm::dvec3 shift) const {
	GroundChanges changes;
	const auto *const other = before.plugin() == plugin() ? static_cast<const RegionCopy *>(&before) : nullptr;
	changes.everywhere = other == nullptr || shift != glm::dvec3(0.0) || other->origin_ != origin_ ||
			other->field_.side() != field_.side() || other->field_.spacing() != field_.spacing() ||
			!(other->field_.paint() == field_.paint());
	if (changes.everywhere) {
		return changes;
	}
	for (const FieldRegion &region : field_.regions()) {
		add_changes(region, other->field_.region_at(region.location), changes);
	}
	for (const FieldRegion &region : other->field_.regions()) {
		const bool unloaded = std::ranges::find(unloaded_, region.location) != unloaded_.end();
		if (!unloaded && field_.region_at(region.location) == nullptr) {
			changes.areas.push_back(area_of(region.location, {glm::ivec2(0), glm::ivec2(field_.side())}));
		}
	}
	return changes;
}

} // namespace thicket
