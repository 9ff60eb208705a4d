#pragma once

#include "core/base/progress.hpp"
#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <string>

namespace thicket {

/// The methods for filling a whole domain, from White, Cline and Egbert, "Poisson Disk Point Sets
/// by Hierarchical Dart Throwing" (2007). All methods except `naive` produce a maximal set of the
/// representable positions; see DomainSampler.
enum class DomainMethod : std::uint8_t {
	/// Darts anywhere in the domain, one by one (section 1). For comparison; the set is never quite
	/// maximal.
	naive,
	hierarchical, ///< Darts only at active squares (section 2). Each point is stored once (section 3.1).
	/// The same darts as hierarchical, but cells store all points in reach, so a lookup reads only
	/// one cell (section 3.1).
	accumulator,
	wavefront, ///< Accepted darts activate the base squares around them (section 4.3). Needs the least memory.
};

/// The input of a DomainSampler. The domain is the rectangle [0, size.x) x [0, size.y).
struct DomainRequest {
	glm::dvec2 size{1.0}; ///< Meters, positive and finite. If `toroidal`, at least min_torus_radii radii on each axis.
	double radius = 1.0;  ///< Minimum distance between points in meters. Finite, in [min_radius, max_radius].
	/// Any number. The seed determines the points, together with the precision and all other fields
	/// except cell_size.
	std::uint64_t seed = 0;
	DomainMethod method = DomainMethod::hierarchical;
	/// True to join opposite edges. Distances are then measured around the torus, so the set tiles
	/// the plane.
	bool toroidal = false;
	/// Width of an acceleration grid cell in radii, up to max_cell_size, or 0 for the method's
	/// default. The width is rounded up to whole base squares. It affects time and memory, never
	/// the points. `naive` ignores it.
	double cell_size = 0.0;
	/// Number of darts thrown per base square, 1 to 1e6. Only `naive` uses this number. More darts
	/// bring the set closer to maximal.
	double darts_each = 100;
};

inline constexpr double min_torus_radii = 4.0;
inline constexpr double max_cell_size = 1000.0;

/// The maximum expected number of points per domain; see expected_points().
inline constexpr double max_domain_points = 1e9;

/// The longest side in radii for float coordinates. Up to this size, the radius is at least 32
/// times the coordinate resolution.
inline constexpr double max_single_radii = 131072.0;

/// Returns an error if a field of the request is out of range.
Status validate(const DomainRequest &request);

/// Returns a message that explains why a request was rejected, like describe() in
/// core/base/status.hpp. If the size is out of range, the message contains the limit.
std::string describe(const DomainRequest &request, const Status &status);

/// Returns the approximate number of points of a maximal set: the density of a jammed set times the
/// area of the domain. Unless the domain is toroidal, the area is extended by half a radius on all
/// sides.
double expected_points(const DomainRequest &request);

} // namespace thicket
