#include "core/placement/ground_query.hpp"

#include "core/base/progress.hpp"

#include <algorithm>

namespace thicket {

namespace {

/// Maximum number of positions per call to Terrain::query.
constexpr std::size_t positions_per_call = 2048;

} // namespace

Status query_ground(const Terrain &terrain, std::span<const glm::dvec2> positions, std::span<const GroundQuery> queries,
		std::span<Ground> r_ground, const std::atomic<bool> *cancel) {
	for (const GroundQuery &query : queries) {
		for (std::size_t done = 0; done < query.count; done += positions_per_call) {
			if (is_cancelled(cancel)) {
				return {ErrorCode::cancelled, "tile", 0.0};
			}
			const std::size_t count = std::min(positions_per_call, query.count - done);
			const Status status = terrain.query(positions.subspan(query.first + done, count), query.needs,
					r_ground.subspan(query.first + done, count));
			if (!status.ok()) {
				return status;
			}
		}
	}
	return {};
}

Status check_ground(std::span<const Ground> ground, std::size_t count) {
	return ground.size() != count ? Status::wrong_size("ground", ground.size(), exactly(count)) : Status();
}

} // namespace thicket
