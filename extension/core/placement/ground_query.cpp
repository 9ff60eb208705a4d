#include "core/placement/ground_query.hpp"

#include "core/base/progress.hpp"

#include <algorithm>

namespace thicket {

namespace {

/// Maximum number of positions per call to Terrain::query.
constexpr std::size_t positions_per_call = 2048;

/// Calls `query_batch` for consecutive parts of all queries. A part has up to positions_per_call
/// positions.
template <class QueryBatch>
Status query_in_batches(
		std::span<const GroundQuery> queries, const std::atomic<bool> *cancel, const QueryBatch &query_batch) {
	for (const GroundQuery &query : queries) {
		for (std::size_t done = 0; done < query.count; done += positions_per_call) {
			if (is_cancelled(cancel)) {
				return {ErrorCode::cancelled, "tile", 0.0};
			}
			const std::size_t count = std::min(positions_per_call, query.count - done);
			if (const Status status = query_batch(query, done, count); !status.ok()) {
				return status;
			}
		}
	}
	return {};
}

/// Writes the ground at `count` positions of a query, from its position `done` on.
Status query_batch_of_terrain(const Terrain &terrain, const GroundQuery &query, std::size_t done,
		std::span<const glm::dvec2> positions, std::span<Ground> r_ground) {
	if (query.known.empty()) {
		return terrain.query(positions, query.needs, r_ground);
	}
	std::ranges::copy(query.known.subspan(done, r_ground.size()), r_ground.begin());
	return {};
}

} // namespace

Status query_ground(const Terrain &terrain, std::span<const glm::dvec2> positions, std::span<const GroundQuery> queries,
		std::span<Ground> r_ground, const std::atomic<bool> *cancel) {
	return query_in_batches(queries, cancel, [&](const GroundQuery &query, std::size_t done, std::size_t count) {
		const std::span<const glm::dvec2> at = positions.subspan(query.first + done, count);
		const std::span<Ground> ground = r_ground.subspan(query.first + done, count);
		const Status status = query_batch_of_terrain(terrain, query, done, at, ground);
		return status.ok() ? query.density.query(at, ground) : status;
	});
}

Status query_terrain(const Terrain &terrain, std::span<const glm::dvec2> positions,
		std::span<const GroundQuery> queries, std::span<Ground> r_ground, const std::atomic<bool> *cancel) {
	return query_in_batches(queries, cancel, [&](const GroundQuery &query, std::size_t done, std::size_t count) {
		return query_batch_of_terrain(terrain, query, done, positions.subspan(query.first + done, count),
				r_ground.subspan(query.first + done, count));
	});
}

Status check_ground(std::span<const Ground> ground, std::size_t count) {
	return ground.size() != count ? Status::wrong_size("ground", ground.size(), exactly(count)) : Status();
}

} // namespace thicket
