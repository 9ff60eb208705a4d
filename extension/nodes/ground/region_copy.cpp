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

/// Adds the area in which a region differs from its previous state, or the whole region if it is new.
void RegionCopy::add_changes(
		const FieldRegion &region, const FieldRegion *other_region, GroundChanges &r_changes) const {
	const PixelRect whole_region{glm::ivec2(0), glm::ivec2(field_.side())};
	const auto add = [&](const PixelRect &rect) {
		if (!rect.empty()) {
			r_changes.areas.push_back(area_of(region.location, rect));
		}
	};
	if (other_region == nullptr || region.controls.empty() != other_region->controls.empty()) {
		add(whole_region);
		return;
	}
	add(region.heights.difference(other_region->heights));
	if (!region.controls.empty()) {
		add(region.controls.difference(other_region->controls));
	}
}

GroundChanges RegionCopy::changes_since(const GroundCopy &before, glm::dvec3 shift) const {
	GroundChanges changes;
	const auto *const other = before.plugin() == plugin() ? static_cast<const RegionCopy *>(&before) : nullptr;
	changes.whole_ground = other == nullptr || shift != glm::dvec3(0.0) || other->origin_ != origin_ ||
			other->field_.side() != field_.side() || other->field_.spacing() != field_.spacing() ||
			!(other->field_.paint() == field_.paint());
	if (changes.whole_ground) {
		return changes;
	}
	for (const FieldRegion &region : field_.regions()) {
		add_changes(region, other->field_.region_at(region.location), changes);
	}
	for (const FieldRegion &region : other->field_.regions()) {
		const bool is_unloaded = std::ranges::find(unloaded_, region.location) != unloaded_.end();
		if (!is_unloaded && field_.region_at(region.location) == nullptr) {
			changes.areas.push_back(area_of(region.location, {glm::ivec2(0), glm::ivec2(field_.side())}));
		}
	}
	return changes;
}

} // namespace thicket
