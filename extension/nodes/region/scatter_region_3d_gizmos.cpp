// This file implements what the add-on's gizmos query about a region on a planet.

#include "nodes/common/convert.hpp"
#include "nodes/region/scatter_region_3d.hpp"

#include <glm/matrix.hpp>

#include <span>

using namespace godot;

namespace thicket {

/// Returns the map of the planet around the region, and the world position of its middle. Returns
/// nothing without a planet, without an outline, and for a middle at the planet's center.
std::optional<PlanetMap> ScatterRegion3D::planet_map(glm::dvec3 &r_middle) const {
	thicket::Shape shape;
	shape.center = to_world(transform_of(*this), glm::dvec3(0.0));
	const Planet planet = this->planet();
	if (is_flat()) {
		build_outline(planet, shape);
	}
	r_middle = shape.center;
	const bool exists = planet.exists() && shape.center != planet.center && !(is_flat() && shape.outline.empty());
	return exists ? std::optional(PlanetMap(planet, shape.center)) : std::nullopt;
}

PackedVector3Array ScatterRegion3D::to_planet_map(const PackedVector3Array &p_positions) const {
	glm::dvec3 middle;
	const std::optional<PlanetMap> map = is_inside_tree() ? planet_map(middle) : std::nullopt;
	if (!map) {
		return {};
	}
	const std::span<const Vector3> positions(p_positions.ptr(), static_cast<std::size_t>(p_positions.size()));
	return packed<PackedVector3Array>(positions, [&](const Vector3 &p_position) {
		const glm::dvec3 position = thicket::to_world(p_position, host_->world_frame());
		if (!is_flat()) {
			const glm::dvec3 offset = glm::transpose(map->axes()) * (position - middle);
			return to_engine(glm::dvec3(offset.x, 1.0, offset.z));
		}
		const glm::dvec2 place = map->at(position);
		return to_engine(glm::dvec3(place.x, map->scale(place), place.y));
	});
}

PackedVector3Array ScatterRegion3D::from_planet_map(const PackedVector2Array &p_places) const {
	glm::dvec3 middle;
	const std::optional<PlanetMap> map = is_inside_tree() ? planet_map(middle) : std::nullopt;
	if (!map) {
		return {};
	}
	const WorldFrame &frame = host_->world_frame();
	const std::span<const Vector2> places(p_places.ptr(), static_cast<std::size_t>(p_places.size()));
	return packed<PackedVector3Array>(places, [&](const Vector2 &p_place) {
		const glm::dvec2 place = to_core(p_place);
		const glm::dvec3 up = is_flat() ? map->direction(place) : map->direction_at_middle(place);
		return to_engine(frame.local ? glm::transpose(frame.rotation) * up : up);
	});
}

} // namespace thicket
