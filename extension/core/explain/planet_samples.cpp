#include "core/explain/planet_samples.hpp"

#include "core/explain/position_grid.hpp"
#include "core/terrain/planet_ground.hpp"
#include "core/terrain/surface_line.hpp"

#include <cmath>

namespace thicket {

void PlanetSamples::add(const Surface &surface, std::size_t index, const glm::dvec3 &from, const glm::dvec3 &to) {
	const SurfacePosition hit = first_on_line(surface, from, to);
	if (std::isfinite(hit.position.x)) {
		indices.push_back(index);
		positions.emplace_back(hit.position.x, hit.position.z);
		ground.push_back({static_cast<float>(hit.position.y), glm::vec3(hit.normal)});
	}
}

void PlanetSamples::find_on_top(
		const Surface &surface, const Planet &planet, std::span<const glm::dvec2> top_positions) {
	for (std::size_t i = 0; i < top_positions.size(); ++i) {
		const glm::dvec2 position = top_positions[i];
		add(surface, i, {position.x, planet.top(), position.y}, {position.x, planet.bottom(), position.y});
	}
}

void PlanetSamples::find_at(
		const Surface &surface, const Planet &planet, std::span<const glm::dvec3> ground_positions) {
	constexpr double max_offset = 1.0;
	for (std::size_t i = 0; i < ground_positions.size(); ++i) {
		const glm::dvec3 &position = ground_positions[i];
		add(surface, i, planet.above(position, max_offset), planet.above(position, -max_offset));
	}
}

float PlanetSamples::slope(const Planet &planet, std::size_t sample) const {
	return ground_slope(on_planet(planet, positions[sample], ground[sample]));
}

glm::dvec3 planet_ground_toward(const Surface &surface, const Planet &planet, const glm::dvec3 &direction) {
	const double farthest = Planet::radii_around * planet.radius;
	return first_on_line(surface, planet.center + farthest * direction, planet.center).position;
}

} // namespace thicket
