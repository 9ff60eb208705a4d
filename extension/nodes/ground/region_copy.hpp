#pragma once

#include "core/terrain/region_field.hpp"
#include "nodes/ground/ground_copy.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <vector>

namespace thicket {

/// The copied ground of a plugin that stores its heights in square regions.
class RegionCopy : public GroundCopy {
public:
	std::shared_ptr<const Terrain> at_offset(glm::dvec3 offset) const override {
		return std::make_shared<RegionField>(field_.at_offset(offset + origin_));
	}
	GroundChanges changes_since(const GroundCopy &before, glm::dvec3 shift) const override;

	const RegionField &field() const { return field_; }

protected:
	/// `origin` is the position of the first corner of region (0, 0) in the engine's space.
	/// `unloaded` lists the regions of the previous copy that the plugin has unloaded since. Their
	/// absence is not treated as a change.
	RegionCopy(RegionField field, glm::dvec3 origin, std::vector<glm::ivec2> unloaded) :
			field_(std::move(field)), origin_(origin), unloaded_(std::move(unloaded)) {}

	const std::vector<glm::ivec2> &unloaded() const { return unloaded_; }

private:
	/// Returns the area in which the ground depends on the height samples in a rectangle of a
	/// region. It extends beyond the rectangle, because interpolation and slopes use neighboring
	/// samples.
	godot::Rect2 area_of(glm::ivec2 location, const PixelRect &rect) const;
	void add_changes(const FieldRegion &region, const FieldRegion *other_region, GroundChanges &r_changes) const;

	RegionField field_;
	glm::dvec3 origin_;
	std::vector<glm::ivec2> unloaded_;
};

} // namespace thicket
