#pragma once

#include "core/base/status.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// Positions whose ground is asked for together: `count` of a list of positions, from `first` on.
struct GroundQuery {
	std::size_t first = 0;
	std::size_t count = 0;
	GroundNeeds needs;
};

/// Asks a terrain for the ground of some positions, in portions of far below a millisecond of work. `r_ground` has one entry for each
/// of the list. Ends with ErrorCode::cancelled when `cancel` is raised. Throws what the terrain throws.
Status ask_ground(const Terrain &terrain, std::span<const glm::dvec2> positions, std::span<const GroundQuery> queries,
		std::span<Ground> r_ground, const std::atomic<bool> *cancel = nullptr);

} // namespace thicket
