#pragma once

#include "core/base/progress.hpp"
#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <string>

namespace thicket {

/// How a whole domain is filled: the single-domain methods of White, Cline and Egbert, "Poisson Disk Point Sets by
/// Hierarchical Dart Throwing" (2007). All but `naive` end with a maximal set, down to the precision used.
enum class DomainMethod : std::uint8_t {
	naive,        ///< Darts at the whole domain, one after the other (section 1): for comparison, never quite maximal.
	hierarchical, ///< Darts at active squares only (section 2), each point stored once (section 3.1).
	accumulator, ///< The same law; a point is stored in every cell that it reaches, so that a dart reads one cell (section 3.1).
	wavefront, ///< Base squares become active around accepted darts; large cells, least memory (section 4.3).
};

/// What is asked of a DomainSampler: the rectangle [0, size.x) x [0, size.y).
struct DomainRequest {
	glm::dvec2 size{1.0}; ///< Meters, positive and finite; with `toroidal` at least min_torus_radii radii on each axis.
	double radius = 1.0;  ///< Meters between any two points, at least; finite, in [min_radius, max_radius].
	std::uint64_t seed = 0; ///< Names the outcome, together with all that stands here and the precision.
	DomainMethod method = DomainMethod::hierarchical;
	bool toroidal =
			false; ///< Opposite edges meet: distances are measured around the torus, and the set tiles the plane.
	double cell_size =
			0.0; ///< Width of an accelerator cell in radii, 0 for the method's own, else up to max_cell_size. Rounded up
	///< to whole base squares. Changes time and memory, never the points. `naive` ignores it.
	double darts_each =
			100; ///< `naive` only: darts thrown for each base square, 1 to 1e6; more come closer to maximal.
};

inline constexpr double min_torus_radii = 4.0;
inline constexpr double max_cell_size = 1000.0;

/// The most points that a domain may be asked for, by the density of a jammed set.
inline constexpr double max_domain_points = 1e9;

/// The widest side in radii at single precision: up to there, coordinates are at least 32 times finer than the radius.
inline constexpr double max_single_radii = 131072.0;

/// Refuses what the docstrings above exclude.
Status validate(const DomainRequest &request);

/// One sentence about a request that was refused, as core/base/status.hpp has it, and which size would not have been.
std::string describe(const DomainRequest &request, const Status &status);

/// About how many points a maximal set has: by the density of a jammed set, over the domain and, unless it is a torus, half a
/// radius around it.
double expected_points(const DomainRequest &request);

} // namespace thicket
