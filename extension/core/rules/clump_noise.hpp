#pragma once

#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <cstdint>

namespace thicket {

/// How a layer gathers in clumps.
struct Clumping {
	/// Meters from the middle of one clump to that of the next, on average, where neighbors that grow together count as two; 0
	/// for no clumping, else min_clump_size to max_clump_size.
	double size = 0.0;
	double coverage = 0.5;  ///< The part of the plane that clumps cover, 0 to 1, over long distances.
	double softness = 0.25; ///< How gradually a clump ends: 0 a sharp edge, 1 no edge at all; 0 to 1.

	friend bool operator==(const Clumping &, const Clumping &) = default;
};

inline constexpr double min_clump_size = 0.1;
inline constexpr double max_clump_size = 1e5;

/// Refuses what is not finite or outside the ranges above.
Status validate(const Clumping &clumping);

/// The density of a clumped layer: low-frequency noise of its own, a function of seed and position, to the same bits everywhere.
/// Its values are made uniform over [0, 1], so that `coverage` holds.
class ClumpNoise {
public:
	/// `clumping` must be valid.
	void set(const Clumping &clumping, std::uint64_t seed);

	bool active() const { return clumping_.size > 0.0; }

	/// 0 to 1. 1 everywhere for a size of 0; 0 for a position that is not finite or more than 10^14 sizes away. Its mean over long
	/// distances is the coverage, whatever the softness.
	double at(glm::dvec2 position) const;

private:
	Clumping clumping_;
	std::uint64_t seed_ = 0;
};

} // namespace thicket
