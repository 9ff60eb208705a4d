#pragma once

#include "core/query/instance_query.hpp"
#include "core/query/instance_ray.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A tile that a search may need to read, and the value before which it contains nothing.
struct SearchTile {
	double from = 0.0;
	std::uint32_t layer = 0;
	glm::ivec2 tile{0};
};

/// Finds the tiles of some layers that may contain an instance whose cylinder a ray meets, in any order. `from` is a
/// share of the ray's length. Replaces `r_tiles`. Refuses, as `to`, more than InstanceQuery::max_points in all of them.
Status find_ray_tiles(std::span<const QueryLayer> layers, std::span<const std::uint32_t> indices, const Ray &ray,
		std::vector<SearchTile> &r_tiles);

} // namespace thicket
