#include "core/placement/ground_query.hpp"

#include "core/base/progress.hpp"

#include <algorithm>

namespace thicket {

namespace {

/// Positions in one call of the terrain.
constexpr std::size_t batch = 2048;

Status ask(const Terrain &terrain, const GroundQuery &query, std::span<const glm::dvec2> positions,
		std::span<Ground> r_ground) {
	Status status;
	if (query.normals) {
		status = terrain.sample(positions, r_ground);
	} else {
		// Fast path: heights alone, as nobody looks at the normals.
		status = terrain.sample_heights(positions, r_ground);
	}
	return status.ok() && !query.textures.empty() ? terrain.weigh(positions, query.textures, r_ground) : status;
}

} // namespace

Status ask_ground(const Terrain &terrain, std::span<const glm::dvec2> positions, std::span<const GroundQuery> queries,
		std::span<Ground> r_ground, const std::atomic<bool> *cancel) {
	for (const GroundQuery &query : queries) {
		for (std::size_t done = 0; done < query.count; done += batch) {
			if (is_cancelled(cancel)) {
				return {ErrorCode::cancelled, "tile", 0.0};
			}
			const std::size_t count = std::min(batch, query.count - done);
			const Status status = ask(terrain, query, positions.subspan(query.first + done, count),
					r_ground.subspan(query.first + done, count));
			if (!status.ok()) {
				return status;
			}
		}
	}
	return {};
}

} // namespace thicket
