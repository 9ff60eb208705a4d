#include "core/rules/clump_noise.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/rules/clump_impulses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace thicket {

namespace {

/// The edge length, in cells, of a square that contains one maximum of the noise on average: for
/// noise on the plane, and on a plane through noise in space. Measured by make_clump_table.
constexpr double cells_per_clump = 2.1747;
constexpr double cells_per_clump_in_space = 2.1074;

/// Up to this distance in cells, a double still resolves positions within a cell.
constexpr double max_cells = 0x1p48;

/// For each knot, the fraction of the plane, or of space, in which the noise is closer to 0 than
/// the knot.
using ClumpTable = std::array<double, clump_knots>;
constexpr ClumpTable nearer
#include "core/rules/clump_table.inc"
		;
constexpr ClumpTable nearer_in_space
#include "core/rules/clump_table_space.inc"
		;
static_assert(nearer.front() == 0.0 && nearer.back() == 1.0);
static_assert(nearer_in_space.front() == 0.0 && nearer_in_space.back() == 1.0);

/// Returns the fraction of the plane or of space, 0 to 1, in which the noise is below `noise`.
/// `nearer` is the table for that noise. Linear interpolation between the knots is accurate to
/// 0.0005.
double fraction_below(double noise, const ClumpTable &nearer) {
	const double knot = std::min(std::abs(noise) * clump_knots_per_unit, static_cast<double>(clump_knots - 1));
	const std::size_t index = std::min(static_cast<std::size_t>(knot), clump_knots - 2);
	const double weight = knot - static_cast<double>(index);
	const double fraction = nearer[index] + (nearer[index + 1] - nearer[index]) * weight;
	return noise < 0.0 ? 0.5 - 0.5 * fraction : 0.5 + 0.5 * fraction;
}

/// Returns the density where the noise exceeds the fraction `fraction` of all noise values.
double density_of(const Clumping &clumping, double fraction) {
	const double coverage = clumping.coverage;
	// A soft edge covers the same fraction of the ground inside a clump as outside it. The mean
	// density therefore equals the coverage.
	const double inside = fraction - (1.0 - coverage);
	const double half_edge = clumping.softness * std::min(coverage, 1.0 - coverage);
	if (half_edge <= 0.0) {
		return inside > 0.0 ? 1.0 : 0.0;
	}
	return std::clamp(0.5 + 0.5 * (inside / half_edge), 0.0, 1.0);
}

/// Returns true if a position in cells, on the plane or in space, is precise enough for noise.
// Without the vector functions of GLM, which compilers do not inline here.
bool is_resolved(const glm::dvec2 &cells) { return std::abs(cells.x) < max_cells && std::abs(cells.y) < max_cells; }

bool is_resolved(const glm::dvec3 &cells) {
	return std::abs(cells.x) < max_cells && std::abs(cells.y) < max_cells && std::abs(cells.z) < max_cells;
}

template <class Cells>
double noise_at(const Cells &cells, std::uint64_t seed, const ClumpTable &nearer) {
	return is_resolved(cells) ? fraction_below(clump_impulses(cells, seed), nearer)
							  : std::numeric_limits<double>::quiet_NaN();
}

/// Returns the density at a position in cells, on the plane or in space. `nearer` is the table for
/// that noise.
template <class Cells>
double density_at(const Clumping &clumping, std::uint64_t seed, const Cells &cells, const ClumpTable &nearer) {
	if (!is_resolved(cells) || clumping.coverage <= 0.0) {
		return 0.0;
	}
	return clumping.coverage >= 1.0 ? 1.0 : density_of(clumping, fraction_below(clump_impulses(cells, seed), nearer));
}

} // namespace

Status validate(const Clumping &clumping) {
	const Status size =
			clumping.size == 0.0 ? Status{} : check_range("clump_size", clumping.size, min_clump_size, max_clump_size);
	return first_failure(size, check_range("clump_coverage", clumping.coverage, 0.0, 1.0),
			check_range("clump_softness", clumping.softness, 0.0, 1.0));
}

double uniform_noise(glm::dvec2 position, double size, std::uint64_t seed) {
	return noise_at(position / (size / cells_per_clump), seed, nearer);
}

double uniform_noise(const glm::dvec3 &position, double size, std::uint64_t seed) {
	return noise_at(position / (size / cells_per_clump_in_space), seed, nearer_in_space);
}

void ClumpNoise::set(const Clumping &clumping, std::uint64_t seed) {
	constexpr std::uint64_t other_than_sampler = 0xd1b54a32d192ed03;
	clumping_ = clumping;
	seed_ = split_mix(seed ^ other_than_sampler);
}

double ClumpNoise::at(glm::dvec2 position) const {
	const double cell = clumping_.size / cells_per_clump;
	return active() ? density_at(clumping_, seed_, position / cell, nearer) : 1.0;
}

double ClumpNoise::at(const glm::dvec3 &position) const {
	const double cell = clumping_.size / cells_per_clump_in_space;
	return active() ? density_at(clumping_, seed_, position / cell, nearer_in_space) : 1.0;
}

} // namespace thicket
