#include "core/query/tile_window.hpp"

#include "core/base/check.hpp"
#include "core/base/instance_id.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>
#include <utility>

namespace thicket {

namespace {

constexpr double longest_shape = 1e4;
constexpr const char *smaller_area = "Make the area smaller, or query fewer layers";

struct Near {
	double distance_squared;
	glm::ivec2 tile;
	std::int32_t slab;
};

/// Appends the tiles of one layer and adds the number of their points to `r_points`.
Status add_tiles(std::uint32_t index, const QueryLayer &layer, const QueryArea &area,
		std::vector<InstanceQuery::Tile> &r_tiles, double &r_points) {
	const TileWindow window(layer);
	const TileSpace near_space = area.space.grown(window.stray());
	const TileRange range = window.touching(near_space);
	const TileWindow::Slabs slabs = window.touching(near_space.bottom, near_space.top);
	// A circle or a ball touches more than half of the tiles in its bounds, so this check rejects
	// no request that the exact check below would accept.
	const double point_bound = r_points + range.count() * slabs.count() * window.tile_points();
	if (point_bound > 2.0 * InstanceQuery::max_points) {
		return Status::too_many_points(area.property, point_bound, InstanceQuery::max_points, smaller_area);
	}
	std::vector<Near> near;
	for (std::int32_t y = range.first.y; y <= range.last.y; ++y) {
		for (std::int32_t x = range.first.x; x <= range.last.x; ++x) {
			for (std::int32_t slab = slabs.first; slab <= slabs.last; ++slab) {
				const double distance = distance_squared(window.standing_space({x, y}, slab), area.center);
				if (!(distance <= area.radius * area.radius)) {
					// No instance of this tile is within the radius.
					continue;
				}
				near.push_back({distance, {x, y}, slab});
			}
		}
	}
	r_points += static_cast<double>(near.size()) * window.tile_points();
	if (r_points > InstanceQuery::max_points) {
		return Status::too_many_points(area.property, r_points, InstanceQuery::max_points, smaller_area);
	}
	std::sort(near.begin(), near.end(), [](const Near &a, const Near &b) {
		return std::tie(a.distance_squared, a.tile.y, a.tile.x, a.slab) <
				std::tie(b.distance_squared, b.tile.y, b.tile.x, b.slab);
	});
	for (const Near &each : near) {
		r_tiles.push_back({index, each.tile, each.slab});
	}
	return {};
}

} // namespace

TileWindow::TileWindow(const QueryLayer &layer) :
		size_(layer.tile_size), bottom_(layer.bottom), top_(layer.top),
		stray_(layer.max_offset + float_rounding * (layer.tile_size + layer.max_offset) +
				double_rounding * set_extent(layer.set)),
		tile_points_(std::max(fewest_points,
				(layer.in_space() ? 0.25 : 1.0) * point_density(layer.set) * layer.tile_size * layer.tile_size)) {
	const double edge = set_extent(layer.set);
	const double outermost = std::min(std::floor(edge / size_), double{max_tile_coordinate});
	last_ = static_cast<std::int32_t>(outermost) - 1;
	// The division above may have rounded up.
	if ((last_ + 1.0) * size_ > edge) {
		--last_;
	}
	first_ = -last_ - 1;
}

TileRange TileWindow::touching(const Rect &rect) const {
	return {glm::max(tile_at(size_, rect.min), first_), glm::min(tile_at(size_, rect.max), last_)};
}

TileWindow::Slabs TileWindow::touching(double bottom, double top) const {
	if (!(top_ < std::numeric_limits<double>::infinity())) {
		return {};
	}
	return {slab_at(size_, std::max(bottom, bottom_)), slab_at(size_, std::min(top, top_))};
}

TileSpace TileWindow::standing_space(glm::ivec2 tile, std::int32_t slab) const {
	return tile_space(size_, tile, slab).grown(stray_);
}

Status validate(const QueryLayer &layer) {
	return first_failure(validate(layer.set), check_range("layer_id", layer.set.layer, 0, max_state_layer),
			check_positive("tile_size", layer.tile_size),
			check_range("tile_size", layer.tile_size, min_query_tile_size, max_query_coordinate),
			check_range("instance_radius", layer.shape.radius, 0.0, longest_shape),
			check_range("instance_height", layer.shape.height, 0.0, longest_shape),
			check_range("max_scale", layer.max_scale, 0.0, max_placement_scale),
			check_range("max_offset", layer.max_offset, 0.0, 2.0 * max_height_offset));
}

Status find_layers(
		std::span<const QueryLayer> layers, const QueryFilter &filter, std::vector<std::uint32_t> &r_indices) {
	r_indices = filter.layers;
	if (r_indices.empty()) {
		r_indices.resize(layers.size());
		std::iota(r_indices.begin(), r_indices.end(), 0u);
	}
	std::sort(r_indices.begin(), r_indices.end());
	r_indices.erase(std::unique(r_indices.begin(), r_indices.end()), r_indices.end());
	if (!r_indices.empty() && r_indices.back() >= layers.size()) {
		return Status::out_of_range(
				"layer", r_indices.back(), at_most(static_cast<double>(layers.size()) - 1.0, "the last layer"));
	}
	std::erase_if(r_indices, [&](std::uint32_t index) { return !layers[index].wanted; });
	for (const std::uint32_t index : r_indices) {
		if (const Status status = validate(layers[index]); !status.ok()) {
			return status;
		}
	}
	return {};
}

Status find_tiles(std::span<const QueryLayer> layers, std::span<const std::uint32_t> indices, const QueryArea &area,
		std::vector<InstanceQuery::Tile> &r_tiles) {
	double points = 0.0;
	r_tiles.clear();
	if (area.space.empty()) {
		// An empty area contains no instances.
		return {};
	}
	for (const std::uint32_t index : indices) {
		if (const Status status = add_tiles(index, layers[index], area, r_tiles, points); !status.ok()) {
			r_tiles.clear();
			return status;
		}
	}
	return {};
}

Status check_position(const char *property, glm::dvec3 position) {
	const auto check = [property](double value) {
		return check_range(property, value, -max_query_coordinate, max_query_coordinate);
	};
	return first_failure(check(position.x), check(position.y), check(position.z));
}

Rect rect_around(glm::dvec2 center, double distance) {
	const double size = std::max(std::abs(center.x), std::abs(center.y)) + distance;
	const double far = distance + double_rounding * size + std::numeric_limits<double>::min();
	return {center - far, center + far};
}

TileSpace space_around(const glm::dvec3 &center, double distance) {
	const Rect heights = rect_around(glm::dvec2(center.y), distance);
	return {rect_around({center.x, center.z}, distance), heights.min.x, heights.max.x};
}

} // namespace thicket
