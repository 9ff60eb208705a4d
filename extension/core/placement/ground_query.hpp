#pragma once

#include "core/base/status.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// A group of positions whose ground is queried together: `count` positions of a list, starting at `first`.
struct GroundQuery {
	std::size_t first = 0;
	std::size_t count = 0;
	GroundNeeds needs;
};

/// Queries a terrain for the ground of some positions, in batches of far less than a millisecond of work. `r_ground` has one entry for each
/// position of the list. Returns ErrorCode::cancelled when `cancel` is raised. Exceptions of the terrain pass through.
Status ask_ground(const Terrain &terrain, std::span<const glm::dvec2> positions, std::span<const GroundQuery> queries,
		std::span<Ground> r_ground, const std::atomic<bool> *cancel = nullptr);

} // namespace thicket
