#pragma once

#include "core/base/planet.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace thicket {

/// A flat map of a planet: the stereographic projection of a sphere with the planet's radius. The
/// center of the map is called the middle, and points on the map are called map positions. The map
/// preserves angles everywhere, and lengths near the middle. All positions with the same up
/// direction have the same map position. Results are bit-identical on every machine.
class PlanetMap {
public:
	/// Positions farther from the middle than this many radii of the planet are not on the map. The
	/// limit is 150 degrees from the middle.
	static constexpr double radii_across = 7.4641016151377544;

	/// Creates a map without a planet.
	PlanetMap() = default;

	/// Creates a map whose middle is the up direction at `middle` (world meters), which must not be
	/// the planet's center.
	PlanetMap(const Planet &planet, const glm::dvec3 &middle);

	bool exists() const { return planet_.exists(); }

	/// Returns the map position of a position in world meters, in meters from the middle.
	glm::dvec2 at(const glm::dvec3 &position) const;

	/// Returns the up direction at a map position.
	glm::dvec3 direction(glm::dvec2 map_position) const;

	/// Returns the map's scale at a map position: the length on the map of one meter on the sphere.
	/// The scale is 1 in the middle.
	double scale(glm::dvec2 map_position) const;

	bool contains(glm::dvec2 map_position) const;

	/// Moves a position along its up direction to middle_distance(), and returns the result relative
	/// to the planet's center. The y axis of the result is the up direction of the middle.
	glm::dvec3 at_middle(const glm::dvec3 &position) const;

	/// Returns the up direction of the positions for which at_middle() returns this x and z, on the
	/// middle's side of the planet. If there are none, returns the nearest horizontal direction.
	glm::dvec3 direction_at_middle(glm::dvec2 place) const;

	/// Returns the x axis of the map, the up direction of the middle, and the z axis of the map.
	const glm::dmat3 &axes() const { return axes_; }

	/// Returns the distance in meters from the planet's center to the constructor's `middle`.
	double middle_distance() const { return distance_; }

private:
	Planet planet_{};
	glm::dmat3 axes_{1.0};
	double distance_ = 0.0;
};

} // namespace thicket
