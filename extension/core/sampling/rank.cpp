#include "core/sampling/rank.hpp"

#include <algorithm>
#include <array>

namespace thicket {

namespace {

constexpr std::uint32_t stage_table[rank_stages][rank_knots] = {
#include "core/sampling/rank_tables.inc"
};

constexpr std::uint32_t even_table[even_stages][even_knots + 1] = {
#include "core/sampling/even_tables.inc"
};

/// Points per squared radius, indexed by the number of levels minus one. For one level, this is 4 /
/// pi times the jamming coverage 0.547070. The other values were measured together with
/// rank_tables.inc.
constexpr std::array<double, max_levels> densities = {
		0.696551,
		0.710752,
		0.711502,
		0.711476,
		0.711476,
		0.711476,
		0.711476,
		0.711476,
};

constexpr std::uint64_t full = std::uint64_t{1} << 32;

/// Computes ends[levels - 1][level], the rank at which a level ends.
constexpr auto make_level_ends() {
	std::array<std::array<std::uint64_t, max_levels + 1>, max_levels> ends{};
	for (std::uint32_t levels = 1; levels <= max_levels; ++levels) {
		ends[levels - 1][0] = full;
		double scale = 1.0;
		for (std::uint32_t level = 1; level < levels; ++level) {
			scale /= 4.0;
			const double fraction = densities[levels - 1 - level] * scale / densities[levels - 1];
			ends[levels - 1][level] = static_cast<std::uint64_t>(fraction * static_cast<double>(full));
		}
	}
	return ends;
}

constexpr auto level_ends = make_level_ends();

/// Returns the fraction of a stage's points, in units of 2^-32, whose time is before `time`. The
/// fraction is interpolated linearly between knots, and from 0 to the first knot.
std::uint32_t fraction_before(std::uint32_t stage, TimeKey time) {
	const auto &table = stage_table[stage < rank_stages ? stage : rank_stages - 1];
	const std::uint32_t knot = rank_knot(time);
	if (knot == 0) {
		return static_cast<std::uint32_t>(std::uint64_t{table[0]} * time / first_rank_knot);
	}
	if (knot == rank_knots) {
		return table[rank_knots - 1];
	}
	constexpr std::uint32_t step = 1u << rank_knot_shift;
	const std::uint64_t part = (time - first_rank_knot) & (step - 1);
	return table[knot - 1] + static_cast<std::uint32_t>((table[knot] - table[knot - 1]) * part >> rank_knot_shift);
}

/// Returns the rank of a point of a level before which a fraction of the level's points comes, in units of
/// 2^-32.
std::uint32_t rank_in_level(std::uint32_t levels, std::uint32_t level, std::uint32_t fraction) {
	const auto &ends = level_ends[levels - 1];
	const std::uint64_t start = ends[level + 1];
	const std::uint64_t span = ends[level] - start;
	return static_cast<std::uint32_t>(start + (fraction * span >> 32));
}

} // namespace

std::uint32_t rank_of(std::uint32_t levels, std::uint32_t level, TimeKey time) {
	return rank_in_level(levels, level, fraction_before(levels - 1 - level, time));
}

std::uint32_t even_rank_of(std::uint32_t levels, std::uint32_t level, std::uint32_t squared) {
	const auto &table = even_table[std::min(levels - 1 - level, even_stages) - 1];
	const std::uint64_t below = std::uint64_t{4} * radius_squared - squared;
	const auto knot = static_cast<std::uint32_t>(below >> even_knot_shift);
	if (knot >= even_knots) {
		return rank_in_level(levels, level, table[even_knots]);
	}
	const std::uint64_t part = below & ((1u << even_knot_shift) - 1);
	const std::uint64_t step = (table[knot + 1] - table[knot]) * part >> even_knot_shift;
	return rank_in_level(levels, level, table[knot] + static_cast<std::uint32_t>(step));
}

std::uint32_t level_of_rank(std::uint32_t levels, std::uint32_t rank) {
	std::uint32_t level = levels - 1;
	while (rank >= level_ends[levels - 1][level]) {
		--level;
	}
	return level;
}

std::uint64_t level_rank_end(std::uint32_t levels, std::uint32_t level) {
	return levels >= 1 && levels <= max_levels && level < levels ? level_ends[levels - 1][level] : full;
}

double point_density(const PointSet &set) {
	const std::uint32_t levels = set.levels < 1 ? 1 : set.levels > max_levels ? max_levels : set.levels;
	return densities[levels - 1] / (set.radius * set.radius);
}

} // namespace thicket
