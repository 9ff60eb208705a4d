#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <cstdint>

namespace thicket {

/// Identifies one infinite Poisson-disk point set. Equal values always identify equal sets, on every machine. A
/// different seed or layer results in an unrelated set. A different number of levels alone does not: the finest darts
/// and some of the points stay the same.
struct PointSet {
	std::uint64_t seed = 0;
	double radius = 1.0;      ///< Minimum distance between points in meters. Finite, in [min_radius, max_radius].
	std::uint32_t levels = 1; ///< Levels of the progressive order, 1 to max_levels; 1 is plain dart throwing.
	std::uint16_t layer = 0;  ///< Part of the ids and, along with the seed, of every random number.

	friend bool operator==(const PointSet &, const PointSet &) = default;
};

inline constexpr double min_radius = 1e-3;
inline constexpr double max_radius = 1e6;
inline constexpr std::uint32_t max_levels = 8;

/// The maximum number of points per call, estimated from the density of a jammed set.
inline constexpr double max_points_per_call = 1e8;

/// How far around a block of cells the sampler reads to decide the block's points. The result does not depend on it.
struct SampleMargins {
	/// Margin in cells (radius / sqrt(2) each) that nearly every chain of darts stays in. tests/bench counts the exceptions.
	std::int32_t first = 16;

	/// A block whose chains leave the margin runs again with twice the margin, up to this. Beyond it, the call fails with
	/// ErrorCode::margin_too_wide. The longest chain measured reached 18 cells.
	std::int32_t widest = 256;
};

struct SamplePoint {
	glm::dvec2 position; ///< World meters. A whole multiple of `lattice_unit`, rounded once.
	std::uint64_t id;    ///< A packed InstanceId.
	std::uint32_t
			rank; ///< Position in the progressive order: rank / 2^32 is the fraction of the set that comes before.
	std::uint32_t level; ///< 0 is the finest. The point also belongs to the maximal set of radius r * 2^level.

	friend bool operator==(const SamplePoint &, const SamplePoint &) = default;
};

/// Refuses a radius, a number of levels or a layer outside the ranges above.
Status validate(const PointSet &set);

/// Base squares are 2^lattice_bits units wide and radius^2 = 2 * 4^lattice_bits units^2, exactly.
inline constexpr int lattice_bits = 14;

/// Meters per lattice unit: radius / (sqrt(2) * 2^lattice_bits). All positions are whole multiples of it.
double lattice_unit(const PointSet &set);

/// The exact lattice coordinates of a point, for checks without rounding. |result| < 2^38.
glm::i64vec2 lattice_position(const PointSet &set, const SamplePoint &point);

/// The rank at which a level ends. Points with `rank < level_rank_end(levels, level)` are a maximal Poisson-disk set of radius r *
/// 2^level, on the lattice of that level, whose unit is 2^level times the finest unit. Returns 2^32 for level 0.
std::uint64_t level_rank_end(std::uint32_t levels, std::uint32_t level);

/// The bounds, in world meters, of the base square encoded in the id of a point, extended by one lattice unit on all sides. The point
/// lies within these bounds.
Rect cell_rect(const PointSet &set, std::uint64_t id);

/// Points per square meter of the whole set.
double point_density(const PointSet &set);

} // namespace thicket
