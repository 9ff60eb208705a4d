#pragma once

#include "core/query/instance_query.hpp"
#include "core/query/instance_ray.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A tile that a search may need to read. None of its candidates has a Candidate::at below `from`.
struct SearchTile {
	double from = 0.0;
	WorldTile tile;
};

/// Finds the tiles of some layers that may contain an instance whose cylinder a ray hits, in any
/// order. Replaces `r_tiles`. SearchTile::from is a fraction of the ray's length. More than
/// InstanceQuery::max_points in all tiles together are an error that names `to`.
Status find_ray_tiles(std::span<const QueryLayer> layers, std::span<const std::uint32_t> indices, const Ray &ray,
		std::vector<SearchTile> &r_tiles);

} // namespace thicket
