// This file implements what the add-on's gizmos query about a region on a planet.

#include "nodes/common/convert.hpp"
#include "nodes/region/scatter_region_3d.hpp"

#include <glm/matrix.hpp>

#include <span>

using namespace godot;

namespace thicket {

/// Returns the map of the planet around the region, and the world position of its center. Returns
/// nothing without a planet, without an outline, and if that center is the planet's center.
std::optional<PlanetMap> ScatterRegion3D::planet_map(glm::dvec3 &r_center) const {
	thicket::Shape shape;
	shape.center = to_world(transform_of(*this), glm::dvec3(0.0));
	const Planet planet = this->planet();
	if (is_flat()) {
		build_outline(planet, shape);
	}
	r_center = shape.center;
	const bool exists = planet.exists() && shape.center != planet.center && !(is_flat() && shape.outline.empty());
	return exists ? std::optional(PlanetMap(planet, shape.center)) : std::nullopt;
}

PackedVector3Array ScatterRegion3D::to_planet_map(const PackedVector3Array &p_positions) const {
	glm::dvec3 center;
	const std::optional<PlanetMap> map = is_inside_tree() ? planet_map(center) : std::nullopt;
	if (!map) {
		return {};
	}
	const std::span<const Vector3> positions(p_positions.ptr(), static_cast<std::size_t>(p_positions.size()));
	return packed<PackedVector3Array>(positions, [&](const Vector3 &p_position) {
		const glm::dvec3 position = thicket::to_world(p_position, host_->world_frame());
		if (!is_flat()) {
			const glm::dvec3 offset = glm::transpose(map->axes()) * (position - center);
			return to_engine(glm::dvec3(offset.x, 1.0, offset.z));
		}
		const glm::dvec2 map_position = map->at(position);
		return to_engine(glm::dvec3(map_position.x, map->scale(map_position), map_position.y));
	});
}

PackedVector3Array ScatterRegion3D::from_planet_map(const PackedVector2Array &p_map_positions) const {
	glm::dvec3 center;
	const std::optional<PlanetMap> map = is_inside_tree() ? planet_map(center) : std::nullopt;
	if (!map) {
		return {};
	}
	const WorldFrame &frame = host_->world_frame();
	const std::span<const Vector2> map_positions(
			p_map_positions.ptr(), static_cast<std::size_t>(p_map_positions.size()));
	return packed<PackedVector3Array>(map_positions, [&](const Vector2 &p_map_position) {
		const glm::dvec2 map_position = to_core(p_map_position);
		const glm::dvec3 up = is_flat() ? map->direction(map_position) : map->direction_at_middle(map_position);
		return to_engine(frame.local ? glm::transpose(frame.rotation) * up : up);
	});
}

} // namespace thicket
