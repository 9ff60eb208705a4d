#include "core/streaming/work_order.hpp"

#include "core/base/tile_grid.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace thicket {

void work_order(std::span<const TileSpace> areas, std::span<const Viewer> viewers, std::vector<std::size_t> &r_order) {
	std::vector<double> distances(areas.size(), std::numeric_limits<double>::infinity());
	std::vector<std::vector<std::size_t>> areas_of(viewers.size());
	r_order.resize(areas.size());
	std::iota(r_order.begin(), r_order.end(), std::size_t{0});
	for (std::size_t area = 0; area < areas.size(); ++area) {
		std::size_t nearest = 0;
		for (std::size_t viewer = 0; viewer < viewers.size(); ++viewer) {
			const glm::dvec2 at = viewers[viewer].position;
			const double squared = distance_squared(areas[area], glm::dvec3(at.x, viewers[viewer].height, at.y));
			nearest = squared < distances[area] ? viewer : nearest;
			distances[area] = std::min(distances[area], squared);
		}
		if (!viewers.empty()) {
			areas_of[nearest].push_back(area);
		}
	}
	for (const std::vector<std::size_t> &mine : areas_of) {
		std::vector<std::size_t> sorted = mine;
		std::ranges::stable_sort(sorted, {}, [&](std::size_t area) { return distances[area]; });
		for (std::size_t i = 0; i < mine.size(); ++i) {
			r_order[mine[i]] = sorted[i];
		}
	}
}

} // namespace thicket
