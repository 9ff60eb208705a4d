#pragma once

#include "core/base/progress.hpp"
#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <string>

namespace thicket {

/// How to fill a whole domain: the single-domain methods of White, Cline and Egbert, "Poisson Disk Point Sets by Hierarchical Dart
/// Throwing" (2007). All but `naive` end with a maximal set, down to the precision used.
enum class DomainMethod : std::uint8_t {
	naive,        ///< Darts anywhere in the domain, one by one (section 1). For comparison; never quite maximal.
	hierarchical, ///< Darts at active squares only (section 2), each point stored once (section 3.1).
	accumulator,  ///< Same distribution. A cell stores all points that reach it, so a dart reads one (section 3.1).
	wavefront,    ///< Base squares become active around accepted darts. Large cells, least memory (section 4.3).
};

/// The input of a DomainSampler. The domain is the rectangle [0, size.x) x [0, size.y).
struct DomainRequest {
	glm::dvec2 size{1.0}; ///< Meters, positive and finite. If `toroidal`, at least min_torus_radii radii on each axis.
	double radius = 1.0;  ///< Minimum distance between points in meters. Finite, in [min_radius, max_radius].
	std::uint64_t seed = 0; ///< Determines the result together with all other fields here and the precision.
	DomainMethod method = DomainMethod::hierarchical;
	bool toroidal =
			false; ///< Opposite edges meet: distances are measured around the torus, and the set tiles the plane.
	double cell_size =
			0.0; ///< Width of an accelerator cell in radii, up to max_cell_size; 0 for the method's default. Rounded up
	///< to whole base squares. Changes time and memory, never the points. Ignored by `naive`.
	double darts_each =
			100; ///< Only for `naive`: darts thrown per base square, 1 to 1e6. More darts come closer to maximal.
};

inline constexpr double min_torus_radii = 4.0;
inline constexpr double max_cell_size = 1000.0;

/// The maximum number of points per domain, estimated from the density of a jammed set.
inline constexpr double max_domain_points = 1e9;

/// The longest side in radii at single precision. Up to this size, coordinates are at least 32 times finer than the radius.
inline constexpr double max_single_radii = 131072.0;

/// Refuses requests outside the ranges documented above.
Status validate(const DomainRequest &request);

/// One sentence that describes a refused request, as in core/base/status.hpp, and names the size that would have been accepted.
std::string describe(const DomainRequest &request, const Status &status);

/// The approximate number of points of a maximal set: the density of a jammed set times the area of the domain, extended by half a radius
/// on all sides unless it is a torus.
double expected_points(const DomainRequest &request);

} // namespace thicket
