#pragma once

#include "core/sampling/dart.hpp"

#include <cstdint>

namespace thicket {

/// Returns the rank of an accepted dart in the progressive order. The rank is the fraction of the
/// whole set that comes before (level, time), in units of 2^-32. Levels go from coarse (levels - 1)
/// to fine (level 0). Ranks never decrease along this order. They come from tables that are valid
/// for every seed and radius, because the process is scale-invariant.
std::uint32_t rank_of(std::uint32_t levels, std::uint32_t level, TimeKey time);

/// Returns the rank of a point of a level other than the coarsest in the order of EvenOrder. `squared` is
/// its squared spacing in lattice units of its level, from radius_squared to 4 * radius_squared. Ranks
/// never decrease as the spacing decreases.
std::uint32_t even_rank_of(std::uint32_t levels, std::uint32_t level, std::uint32_t squared);

/// The number of tables for even_rank_of: one for each level after the coarsest. Finer levels share the last.
inline constexpr std::uint32_t even_stages = 3;

/// The tables have knots at equal steps of the squared spacing, from 4 * radius_squared down to
/// radius_squared.
inline constexpr std::uint32_t even_knot_shift = 20;
inline constexpr std::uint32_t even_knots = 3 * (radius_squared >> even_knot_shift);

/// Returns the level at which a point of this rank was placed.
std::uint32_t level_of_rank(std::uint32_t levels, std::uint32_t rank);

/// The number of tables: one for each of the coarsest levels. Finer levels share the last table.
inline constexpr std::uint32_t rank_stages = 4;

/// The tables have 32 knots per octave of time, from 2^-16 to 2^33. No clock of a lattice square
/// runs longer than that.
inline constexpr std::uint32_t rank_knot_shift = 18;
inline constexpr TimeKey first_rank_knot = (127u - 16u) << 23;
inline constexpr std::uint32_t rank_knots = (33u + 16u) << (23 - rank_knot_shift);

/// Returns the index of the first knot after `time`, or rank_knots if there is none.
constexpr std::uint32_t rank_knot(TimeKey time) {
	if (time < first_rank_knot) {
		return 0;
	}
	const std::uint32_t knot = ((time - first_rank_knot) >> rank_knot_shift) + 1;
	return knot < rank_knots ? knot : rank_knots;
}

} // namespace thicket
