#include "core/query/search_tiles.hpp"

#include "core/query/tile_window.hpp"

#include <glm/common.hpp>

#include <algorithm>

namespace thicket {

namespace {

constexpr const char *shorter_ray = "Shorten the ray, or name fewer layers";

/// Finds the tiles layer by layer and row by row, so that only tiles near the ray are ever visited.
class RayWalk {
public:
	RayWalk(const Ray &ray, std::vector<SearchTile> &r_tiles) : ray_(ray), tiles_(r_tiles) {}

	Status add(std::uint32_t index, const QueryLayer &layer) {
		const TileWindow window(layer);
		const double reach = cylinder_reach(layer.shape, layer.max_scale) + rounding_of(ray_);
		const double margin = window.stray() + reach;
		const TileRange rows = window.touching(rect_between(0.0, 1.0, margin));
		if (rows.empty()) {
			return {};
		}
		// There is a tile in every row, except where the ray leaves the set.
		if (const double most = points_ + (1.0 + rows.last.y - rows.first.y) * window.tile_points();
				most > InstanceQuery::max_points) {
			return Status::too_many_points("to", most, InstanceQuery::max_points, shorter_ray);
		}
		for (std::int32_t y = rows.first.y; y <= rows.last.y; ++y) {
			const Rect area = window.standing_area({rows.first.x, y});
			const RayPart part = clipped({}, ray_.from.z, ray_.along.z, area.min.y - reach, area.max.y + reach);
			if (part.empty()) {
				continue;
			}
			const TileRange near = window.touching(rect_between(part.start, part.end, margin));
			for (std::int32_t x = near.first.x; x <= near.last.x; ++x) {
				if (!add_tile(window, index, {x, y}, part, reach)) {
					return Status::too_many_points("to", points_, InstanceQuery::max_points, shorter_ray);
				}
			}
		}
		return {};
	}

private:
	Rect rect_between(double start, double end, double margin) const {
		const glm::dvec3 a = ray_.at(start);
		const glm::dvec3 b = ray_.at(end);
		const glm::dvec3 low = glm::min(a, b) - margin;
		const glm::dvec3 high = glm::max(a, b) + margin;
		return {{low.x, low.z}, {high.x, high.z}};
	}

	/// Adds a tile of a row in which `part` of the ray lies. False once there are too many.
	bool add_tile(const TileWindow &window, std::uint32_t index, glm::ivec2 tile, const RayPart &part, double reach) {
		const Rect area = window.standing_area(tile);
		const RayPart inside = clipped(part, ray_.from.x, ray_.along.x, area.min.x - reach, area.max.x + reach);
		if (inside.empty()) {
			return true;
		}
		tiles_.push_back({inside.start, index, tile});
		points_ += window.tile_points();
		return points_ <= InstanceQuery::max_points;
	}

	const Ray &ray_;
	std::vector<SearchTile> &tiles_;
	double points_ = 0.0;
};

} // namespace

Status find_ray_tiles(std::span<const QueryLayer> layers, std::span<const std::uint32_t> indices, const Ray &ray,
		std::vector<SearchTile> &r_tiles) {
	r_tiles.clear();
	RayWalk walk(ray, r_tiles);
	for (const std::uint32_t index : indices) {
		if (const Status status = walk.add(index, layers[index]); !status.ok()) {
			return status;
		}
	}
	return {};
}

} // namespace thicket
