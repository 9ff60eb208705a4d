#pragma once

#include "core/sampling/point_set.hpp"

#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <span>

namespace thicket {

/// A disk in world meters that contains no points of a filled set. A point at exactly `radius` from
/// the center is permitted.
struct Obstacle {
	glm::dvec2 center;
	double radius;
};

/// The obstacles of a filled set. They exist before the first dart is thrown, so the set is maximal
/// in the remaining area. A filled set depends on its obstacles within the reach of a chain of
/// darts.
///
/// Only the finest level fills. Coarser levels are those of the set without obstacles, and their
/// points inside of obstacles are left out. Otherwise, the chains of coarser levels would require
/// the obstacles in a far wider area.
struct Obstacles {
	/// All obstacles that reach the sampled rectangle, or the area around it within
	/// fill_distance(set, margin).
	std::span<const Obstacle> disks;
	/// Width in cells of the area around the rectangle in which obstacles are known.
	std::int32_t margin = 0;
};

/// The margins of a filled set, in cells: the first one, and wider ones for the few windows in which a
/// chain of darts leaves it. The first one is narrower than for other sets, because the obstacles must
/// be known in the same margin, which is expensive if they are instances of another set.
inline constexpr std::array<std::int32_t, 3> fill_margins{12, 24, 48};

/// Returns the width in meters of an area around a rectangle that contains a margin of `cells` cells
/// of the finest level.
double fill_distance(const PointSet &set, std::int32_t cells);

} // namespace thicket
