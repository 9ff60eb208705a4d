#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <cstdint>

namespace thicket {

/// The faces of a surface on which points may lie: those that point up, those that point down, or
/// all. Vertical faces are always included.
enum class SurfaceFaces : std::uint8_t { all, up, down };

/// Identifies one infinite Poisson-disk point set. Equal values identify equal sets on every
/// machine. A different seed or layer produces an unrelated set. Changing only `levels` keeps the
/// darts of the levels that both sets have, and some of the points.
struct PointSet {
	std::uint64_t seed = 0;
	double radius = 1.0;      ///< Minimum distance between points in meters. Finite, in [min_radius, max_radius].
	std::uint32_t levels = 1; ///< Levels of the progressive order, 1 to max_levels. 1 is plain dart throwing.
	/// Stored in every id. Together with the seed, the layer determines every random number.
	std::uint16_t layer = 0;
	/// True for points on surfaces, with distances in space, which SurfaceSampler (core/surface)
	/// finds. False for points on the plane of x and z, which TileSampler finds.
	bool on_surface = false;
	/// The faces on which points on surfaces may lie; up is world y. Other faces are ignored, so
	/// that points on the underside of a thin bridge do not displace points on its top.
	SurfaceFaces faces = SurfaceFaces::all;
	/// True for points in rows (core/rows), which no sampler of Poisson-disk sets finds. The radius is
	/// then only an estimate of their density, and IDs contain places in rows instead of cells.
	bool in_rows = false;
	/// Width and height, in cells of the finest level, after which the set repeats, so that the plane
	/// becomes a torus. Zero on an axis without an end. Each must be a multiple of period_step. IDs
	/// contain the cell in the first period.
	glm::ivec2 period{0};
	/// True to order the points of each level by their distances (EvenOrder) instead of their times, so that
	/// the points below any rank keep their distance. Changes ranks only, and nothing if `levels` is 1.
	bool even_order = false;

	friend bool operator==(const PointSet &, const PointSet &) = default;
};

inline constexpr double min_radius = 1e-3;
inline constexpr double max_radius = 1e6;
inline constexpr std::uint32_t max_levels = 8;

/// The maximum number of points per call, estimated from the density of a jammed set.
inline constexpr double max_points_per_call = 1e8;

/// Width of the margin that the sampler computes around a block of cells in order to decide the
/// block's points. A dart may depend on earlier darts nearby, which depend on even earlier ones.
/// These darts form a chain. The points do not depend on the width of the margin.
struct SampleMargins {
	/// Initial margin in cells. A cell is radius / sqrt(2) wide. Nearly every chain of dependent
	/// darts stays within this margin; the benchmarks in tests/bench count the exceptions.
	std::int32_t first = 16;

	/// Maximum margin in cells. When a chain leaves the margin, the sampler computes the block
	/// again with twice the margin, up to this maximum. If that is still too small, the call fails
	/// with ErrorCode::margin_too_wide. The longest measured chain reached 18 cells.
	std::int32_t widest = 256;
};

struct SamplePoint {
	glm::dvec2 position; ///< World position in meters: a multiple of `lattice_unit`, rounded once.
	std::uint64_t id;    ///< The packed InstanceId of the point.
	/// Rank in the progressive order: rank / 2^32 is the fraction of the set that precedes the
	/// point.
	std::uint32_t rank;
	std::uint32_t level; ///< 0 is the finest level. The point also belongs to the maximal set of radius r * 2^level.

	friend bool operator==(const SamplePoint &, const SamplePoint &) = default;
};

/// Returns the number of cells of which the period of a set with `levels` levels must be a multiple:
/// cells of the coarsest level repeat with their tags (tag_of).
constexpr std::int32_t period_step(std::uint32_t levels) { return 5 << (levels - 1); }

/// Returns a cell in the first period; `period` is 0 on an axis without an end.
constexpr std::int32_t wrapped(std::int32_t cell, std::int32_t period) {
	if (period == 0) {
		return cell;
	}
	const std::int32_t remainder = cell % period;
	return remainder < 0 ? remainder + period : remainder;
}

/// Returns an error if the radius, the number of levels or the period is out of range.
Status validate(const PointSet &set);

/// A base square is 2^lattice_bits lattice units wide. The squared radius is therefore exactly 2 *
/// 4^lattice_bits square units.
inline constexpr int lattice_bits = 14;

/// Returns the length of a lattice unit in meters: radius / (sqrt(2) * 2^lattice_bits). All
/// positions are multiples of it.
double lattice_unit(const PointSet &set);

/// Returns the exact lattice coordinates of a point, for checks without rounding. Their magnitude
/// is below 2^38.
glm::i64vec2 lattice_position(const PointSet &set, const SamplePoint &point);

/// Returns the rank at which a level ends. The points with `rank < level_rank_end(levels, level)`
/// form a maximal Poisson-disk set of radius r * 2^level. They lie on the lattice of that level,
/// whose unit is 2^level times the finest unit. Returns 2^32 for level 0 and for arguments that are
/// out of range.
std::uint64_t level_rank_end(std::uint32_t levels, std::uint32_t level);

/// Returns the bounds, in world meters, of the base square that is encoded in a point's id. The
/// bounds are extended by one lattice unit on all sides, so they always contain the point. On
/// surfaces, the bounds are those of the cell seen from above.
Rect cell_rect(const PointSet &set, std::uint64_t id);

/// A range of heights in world meters.
struct CellHeights {
	double bottom = 0.0;
	double top = 0.0;
};

/// Returns the range of heights of the cell that is encoded in the id of a point on a surface. The
/// range is extended so that it always contains the point. The set must be on surfaces.
CellHeights cell_heights(const PointSet &set, std::uint64_t id);

/// Returns the side, in meters, of the squares that are encoded in ids: base squares of the
/// lattice, or parts of cells on surfaces.
double id_cell_side(const PointSet &set);

/// Returns the largest distance in meters from the origin, on x and z, of the cells that can be
/// encoded in ids.
double set_extent(const PointSet &set);

/// Returns the expected number of points per square meter, over all levels.
double point_density(const PointSet &set);

} // namespace thicket
