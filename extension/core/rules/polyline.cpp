#include "core/rules/polyline.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace thicket {

namespace {

/// The maximum number of points that one segment replaces, to limit the cost.
constexpr std::size_t longest_run = 128;

double distance_squared(glm::dvec2 point, glm::dvec2 from, glm::dvec2 to) {
	const glm::dvec2 way = to - from;
	const double length_squared = glm::dot(way, way);
	const double along =
			length_squared > 0.0 ? std::clamp(glm::dot(point - from, way) / length_squared, 0.0, 1.0) : 0.0;
	const glm::dvec2 offset = point - (from + along * way);
	return glm::dot(offset, offset);
}

bool straight(std::span<const glm::dvec2> run, double tolerance) {
	return std::all_of(run.begin(), run.end(), [&](glm::dvec2 point) {
		return distance_squared(point, run.front(), run.back()) <= tolerance * tolerance;
	});
}

} // namespace

std::vector<glm::dvec2> simplified(std::span<const glm::dvec2> line, double tolerance) {
	const auto broken = std::find_if(line.begin(), line.end(),
			[](glm::dvec2 point) { return !std::isfinite(point.x) || !std::isfinite(point.y); });
	line = line.first(static_cast<std::size_t>(broken - line.begin()));
	std::vector<glm::dvec2> result;
	if (line.empty()) {
		return result;
	}
	result.push_back(line.front());
	std::size_t from = 0;
	while (from + 1 < line.size()) {
		std::size_t to = from + 1;
		const std::size_t last = std::min(from + longest_run, line.size() - 1);
		while (to < last && straight(line.subspan(from, to + 2 - from), tolerance)) {
			++to;
		}
		result.push_back(line[to]);
		from = to;
	}
	return result;
}

} // namespace thicket
