#include "core/query/search_tiles.hpp"

#include "core/query/tile_window.hpp"

#include <glm/common.hpp>

#include <algorithm>

namespace thicket {

namespace {

constexpr const char *shorter_ray = "Shorten the ray, or query fewer layers";

/// Finds the tiles along a ray, layer by layer and row by row, so that only tiles near the ray are
/// visited.
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
		// The ray crosses at least one tile in every row, except outside the cells of the set.
		if (const double point_bound = points_ + (1.0 + rows.last.y - rows.first.y) * window.tile_points();
				point_bound > InstanceQuery::max_points) {
			return Status::too_many_points("to", point_bound, InstanceQuery::max_points, shorter_ray);
		}
		for (std::int32_t y = rows.first.y; y <= rows.last.y; ++y) {
			const Rect area = window.standing_space({rows.first.x, y}, all_slabs);
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

	/// Adds the tiles in a column of the map that the ray reaches. `part` is the part of the ray in
	/// the column's row. Returns false if there are too many points.
	bool add_tile(const TileWindow &window, std::uint32_t index, glm::ivec2 tile, const RayPart &part, double reach) {
		const Rect area = window.standing_space(tile, all_slabs);
		const RayPart inside = clipped(part, ray_.from.x, ray_.along.x, area.min.x - reach, area.max.x + reach);
		if (inside.empty()) {
			return true;
		}
		const double a = ray_.at(inside.start).y;
		const double b = ray_.at(inside.end).y;
		const double margin = window.stray() + reach;
		const TileWindow::Slabs slabs = window.touching(std::min(a, b) - margin, std::max(a, b) + margin);
		for (std::int32_t slab = slabs.first; slab <= slabs.last; ++slab) {
			const TileSpace space = window.standing_space(tile, slab);
			const RayPart within = slab == all_slabs
					? inside
					: clipped(inside, ray_.from.y, ray_.along.y, space.bottom - reach, space.top + reach);
			if (within.empty()) {
				continue;
			}
			tiles_.push_back({within.start, {index, tile, slab}});
			points_ += window.tile_points();
			if (points_ > InstanceQuery::max_points) {
				return false;
			}
		}
		return true;
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
