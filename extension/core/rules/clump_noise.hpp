#pragma once

#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <cstdint>

namespace thicket {

/// How a layer forms clumps.
struct Clumping {
	/// Average distance in meters between the centers of neighboring clumps, where merged neighbors count as two. 0 disables clumping;
	/// otherwise min_clump_size to max_clump_size.
	double size = 0.0;
	double coverage = 0.5;  ///< Fraction of the plane that clumps cover over long distances, 0 to 1.
	double softness = 0.25; ///< How gradually a clump ends: 0 is a sharp edge, 1 is no edge at all.

	friend bool operator==(const Clumping &, const Clumping &) = default;
};

inline constexpr double min_clump_size = 0.1;
inline constexpr double max_clump_size = 1e5;

/// Refuses values that are not finite or outside the ranges above.
Status validate(const Clumping &clumping);

/// The density of a clumped layer: its own low-frequency noise. A function of seed and position, bit-identical
/// everywhere. Its values are transformed to be uniform over [0, 1], so that `coverage` is the covered share.
class ClumpNoise {
public:
	/// `clumping` must be valid.
	void set(const Clumping &clumping, std::uint64_t seed);

	bool active() const { return clumping_.size > 0.0; }

	/// The density, 0 to 1. If the size is 0, returns 1 everywhere. Returns 0 for a position that is not finite or more
	/// than 10^14 sizes away. The mean over a large area is the coverage, whatever the softness.
	double at(glm::dvec2 position) const;

private:
	Clumping clumping_;
	std::uint64_t seed_ = 0;
};

} // namespace thicket
