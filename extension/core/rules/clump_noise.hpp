#pragma once

#include "core/base/status.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>

namespace thicket {

/// Size, coverage and edge of a layer's clumps.
struct Clumping {
	/// Average distance in meters between the centers of neighboring clumps, counting merged clumps
	/// as two. min_clump_size to max_clump_size, or 0 to disable clumping.
	double size = 0.0;
	double coverage = 0.5;  ///< Fraction of a large area that clumps cover, 0 to 1.
	double softness = 0.25; ///< Softness of a clump's edge, 0 (sharp) to 1 (no discernible edge).

	friend bool operator==(const Clumping &, const Clumping &) = default;
};

inline constexpr double min_clump_size = 0.1;
inline constexpr double max_clump_size = 1e5;

/// Returns an error for values that are not finite or outside the ranges above.
Status validate(const Clumping &clumping);

/// Low-frequency noise at a position on the plane, uniform over [0, 1] and bit-identical on all
/// platforms. `size` is the average distance in meters between neighboring maxima, min_clump_size to
/// max_clump_size. NAN for a position that is not finite or more than 10^14 sizes from the origin.
double uniform_noise(glm::dvec2 position, double size, std::uint64_t seed);

/// Like uniform_noise on the plane, at a position in space.
double uniform_noise(const glm::dvec3 &position, double size, std::uint64_t seed);

/// The density of a clumped layer, from low-frequency noise. The density is a function of seed and
/// position, bit-identical on all platforms. The noise is uniform over [0, 1], so `coverage` is the
/// fraction of the plane that is covered.
class ClumpNoise {
public:
	/// Sets the parameters. `clumping` must be valid.
	void set(const Clumping &clumping, std::uint64_t seed);

	bool active() const { return clumping_.size > 0.0; }

	/// Returns the density, 0 to 1, or always 1 if the size is 0. The result is 0 for a position
	/// that is not finite or more than 10^14 sizes from the origin. The mean over a large area
	/// equals the coverage at any softness.
	double at(glm::dvec2 position) const;

	/// Returns the density at a position in space, for points on surfaces. The limits are the same,
	/// but the noise differs from the noise on the plane. On any plane through the space, clumps
	/// have nearly the size and coverage of the settings.
	double at(const glm::dvec3 &position) const;

private:
	Clumping clumping_;
	std::uint64_t seed_ = 0;
};

} // namespace thicket
