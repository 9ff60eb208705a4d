#include "core/rules/clump_noise.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/rules/clump_impulses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace thicket {

namespace {

/// The noise has one maximum per square of this side length in cells, as measured by make_clump_table.
constexpr double cells_per_clump = 2.1747;

/// Up to this distance, in cells, a double still distinguishes positions within a cell.
constexpr double max_cells = 0x1p48;

/// At each knot, the fraction of the plane where the noise is closer to 0.
constexpr std::array<double, clump_knots> nearer
#include "core/rules/clump_table.inc"
		;
static_assert(nearer.front() == 0.0 && nearer.back() == 1.0);

/// The fraction of the plane where the noise is below `noise`, 0 to 1. Linear interpolation between the knots is accurate to 0.0005.
double share_below(double noise) {
	const double knot = std::min(std::abs(noise) * clump_knots_per_unit, static_cast<double>(clump_knots - 1));
	const std::size_t index = std::min(static_cast<std::size_t>(knot), clump_knots - 2);
	const double part = knot - static_cast<double>(index);
	const double share = nearer[index] + (nearer[index + 1] - nearer[index]) * part;
	return noise < 0.0 ? 0.5 - 0.5 * share : 0.5 + 0.5 * share;
}

} // namespace

Status validate(const Clumping &clumping) {
	const Status size =
			clumping.size == 0.0 ? Status{} : check_range("clump_size", clumping.size, min_clump_size, max_clump_size);
	return first_failure(size, check_range("clump_coverage", clumping.coverage, 0.0, 1.0),
			check_range("clump_softness", clumping.softness, 0.0, 1.0));
}

void ClumpNoise::set(const Clumping &clumping, std::uint64_t seed) {
	constexpr std::uint64_t other_than_sampler = 0xd1b54a32d192ed03;
	clumping_ = clumping;
	seed_ = split_mix(seed ^ other_than_sampler);
}

double ClumpNoise::at(glm::dvec2 position) const {
	if (!active()) {
		return 1.0;
	}
	const double coverage = clumping_.coverage;
	const glm::dvec2 cells = position / (clumping_.size / cells_per_clump);
	if (!(std::abs(cells.x) < max_cells && std::abs(cells.y) < max_cells) || coverage <= 0.0) {
		return 0.0;
	}
	if (coverage >= 1.0) {
		return 1.0;
	}
	// A soft edge extends equally far into a clump and out of it, measured as a fraction of the plane, so that the mean is the coverage.
	const double inside = share_below(clump_impulses(cells, seed_)) - (1.0 - coverage);
	const double half_edge = clumping_.softness * std::min(coverage, 1.0 - coverage);
	if (half_edge <= 0.0) {
		return inside > 0.0 ? 1.0 : 0.0;
	}
	return std::clamp(0.5 + 0.5 * (inside / half_edge), 0.0, 1.0);
}

} // namespace thicket
