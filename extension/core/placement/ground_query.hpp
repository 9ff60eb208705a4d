#pragma once

#include "core/base/status.hpp"
#include "core/rules/density_rule_query.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// A range in a list of positions, with the properties of the ground that are queried at these
/// positions.
struct GroundQuery {
	std::size_t first = 0;
	std::size_t count = 0;
	GroundNeeds needs{};
	/// The ground at these positions if it is already known, as for points on surfaces; otherwise
	/// empty. Only the density rules are then queried.
	std::span<const Ground> known{};
	DensityRuleQuery density{};
};

/// Queries the ground at the positions that `queries` cover, in batches of up to 2,048 positions,
/// including the density rules. `r_ground` has one entry for each position; entries outside all
/// queries stay unchanged. Returns the first error of the terrain or of a rule. Once `cancel` is set,
/// returns ErrorCode::cancelled before the next batch. Exceptions thrown by the terrain propagate.
///
/// Call this function only on the main thread if any of the density rules is not thread-safe.
Status query_ground(const Terrain &terrain, std::span<const glm::dvec2> positions, std::span<const GroundQuery> queries,
		std::span<Ground> r_ground, const std::atomic<bool> *cancel = nullptr);

/// Like query_ground, but leaves Ground::density at 1. Any thread may call this function.
Status query_terrain(const Terrain &terrain, std::span<const glm::dvec2> positions,
		std::span<const GroundQuery> queries, std::span<Ground> r_ground, const std::atomic<bool> *cancel = nullptr);

/// Returns an error unless `ground` has one entry for each of `count` positions.
Status check_ground(std::span<const Ground> ground, std::size_t count);

} // namespace thicket
