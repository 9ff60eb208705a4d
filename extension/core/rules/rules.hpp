#pragma once

#include "core/base/status.hpp"
#include "core/terrain/terrain.hpp"

#include <cstdint>

namespace thicket {

/// A height limit at or beyond this (metres, either sign) is no limit.
inline constexpr double unlimited_height = 1e6;

/// Which points of a set become instances. Each rule is a pure function of one point and the ground under it: a
/// rule takes points away, it never moves one, and it changes nothing for the others. Defaults let all ground pass.
///
/// Limits are hard: nothing stands outside them. A falloff thins inside, towards the limit: the chance to stand falls
/// linearly from 1, a falloff away from the limit, to 0 at it. Where the bands of both limits meet, the smaller chance
/// counts. A limit that limits nothing (0 and 90 degrees, unlimited_height) has no falloff either.
struct Rules {
	double density = 1.0;           ///< Fraction of the set, 0 to 1: keeps the points of the lowest ranks.
	double min_slope_degrees = 0.0; ///< Angle between the normal and straight up, 0 to 90 true degrees.
	double max_slope_degrees = 90.0;
	double slope_falloff = 0.0;            ///< Degrees, 0 to 90; 0 is a sharp limit.
	double min_height = -unlimited_height; ///< World metres, the limit included.
	double max_height = unlimited_height;
	double height_falloff = 0.0; ///< Metres, 0 or more; 0 is a sharp limit.

	friend bool operator==(const Rules &, const Rules &) = default;
};

/// Refuses what is not finite, outside the ranges above, or a minimum above its maximum.
Status validate(const Rules &rules);

/// One range with its falloff, ready to be asked.
class PreparedRange {
public:
	PreparedRange() = default; ///< Lets all pass.

	/// `min_open` and `max_open` switch a limit off, with its falloff.
	PreparedRange(double min, bool min_open, double max, bool max_open, double falloff);

	/// The chance to pass, 0 to 1. NAN has none.
	double chance(double value) const;

	/// True when every finite value passes.
	bool open() const { return min_open_ && max_open_; }

private:
	double min_ = 0.0;
	double max_ = 0.0;
	double falloff_ = 0.0;
	bool min_open_ = true;
	bool max_open_ = true;
};

/// Rules made ready for many points. Immutable after `set`, so threads may share one.
class PreparedRules {
public:
	/// Prepares `rules`, or refuses them as `validate` does and stays as it was.
	Status set(const Rules &rules);

	const Rules &rules() const { return rules_; }

	/// Density: depends on the rank alone, so it can be asked before the ground is known.
	bool passes_density(std::uint32_t rank) const { return rank < rank_end_; }

	/// All other rules. No ground (a height or a normal that is not finite, a normal that does not point up) never
	/// passes. `id` and `seed` give the point's own random numbers, which a falloff compares its chance with.
	bool passes_ground(const Ground &ground, std::uint64_t id, std::uint64_t seed) const;

private:
	Rules rules_;
	std::uint64_t rank_end_ = std::uint64_t{1} << 32;
	PreparedRange slope_;
	PreparedRange height_;
};

} // namespace thicket
