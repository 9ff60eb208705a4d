#pragma once

#include "core/base/planet.hpp"
#include "core/terrain/surface.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// The ground of a planet at a list of positions, on any of its sides. Positions without ground are
/// left out.
struct PlanetSamples {
	std::vector<std::size_t> indices;  ///< The index of each sample in the list of positions.
	std::vector<glm::dvec2> positions; ///< World x and z, in meters.
	std::vector<Ground> ground;        ///< World heights in meters, and normals.

	/// Finds the highest ground at world x and z, as seen from above.
	void find_on_top(const Surface &surface, const Planet &planet, std::span<const glm::dvec2> top_positions);

	/// Finds the ground within a meter above or below positions on it. On a planet, above is away from
	/// its center.
	void find_at(const Surface &surface, const Planet &planet, std::span<const glm::dvec3> ground_positions);

	/// Returns the angle between the normal of a sample and the planet's up direction, in degrees.
	float slope(const Planet &planet, std::size_t sample) const;

private:
	void add(const Surface &surface, std::size_t index, const glm::dvec3 &from, const glm::dvec3 &to);
};

/// Returns the highest ground toward a direction from a planet's center, in world meters; NAN if there is
/// none. `direction` is a unit vector.
glm::dvec3 planet_ground_toward(const Surface &surface, const Planet &planet, const glm::dvec3 &direction);

} // namespace thicket
