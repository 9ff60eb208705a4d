#include "core/terrain/view_focus.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

namespace thicket {

namespace {

constexpr std::size_t coarse_steps = 128;
constexpr std::size_t fine_steps = 16;
constexpr int refinements = 2;
constexpr double min_slope = 0.17; ///< About the sine of 10 degrees.

/// Divides the range `within` of a ray into `steps` equal parts and returns the first part in which
/// the ray enters the ground.
template <std::size_t steps>
std::optional<std::pair<double, double>> entry(
		const Terrain &terrain, glm::dvec3 from, glm::dvec3 direction, std::pair<double, double> within) {
	std::array<glm::dvec2, steps + 1> positions;
	std::array<Ground, steps + 1> ground;
	const auto at = [within](std::size_t step) {
		return within.first + (within.second - within.first) * static_cast<double>(step) / static_cast<double>(steps);
	};
	for (std::size_t step = 0; step <= steps; ++step) {
		const glm::dvec3 position = from + direction * at(step);
		positions[step] = {position.x, position.z};
	}
	if (!terrain.sample_heights(positions, ground).ok()) {
		return std::nullopt;
	}
	bool was_above = false;
	for (std::size_t step = 0; step <= steps; ++step) {
		const double above = from.y + direction.y * at(step) - static_cast<double>(ground[step].height);
		if (was_above && above <= 0.0) {
			return std::pair(at(step - 1), at(step));
		}
		was_above = above > 0.0; // The result is false if there is no ground.
	}
	return std::nullopt;
}

} // namespace

std::optional<glm::dvec3> ground_on_ray(const Terrain &terrain, glm::dvec3 from, glm::dvec3 direction, double reach) {
	std::optional<std::pair<double, double>> part = entry<coarse_steps>(terrain, from, direction, {0.0, reach});
	for (int round = 0; part && round < refinements; ++round) {
		const auto finer = entry<fine_steps>(terrain, from, direction, *part);
		part = finer ? finer : part;
	}
	return part ? std::optional(from + direction * part->second) : std::nullopt;
}

glm::dvec3 view_focus(const ParallelView &view, const Terrain *terrain, double level) {
	if (view.direction.y < -min_slope) {
		if (terrain != nullptr) {
			if (const auto hit = ground_on_ray(*terrain, view.from, view.direction, view.reach)) {
				return *hit;
			}
		}
		const double depth = (level - view.from.y) / view.direction.y;
		if (depth >= 0.0 && depth <= view.reach) {
			return view.from + view.direction * depth;
		}
	}
	return view.from + view.direction * view.usual_depth;
}

} // namespace thicket
