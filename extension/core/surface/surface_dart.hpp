#pragma once

#include "core/base/philox.hpp"
#include "core/base/split_mix.hpp"
#include "core/sampling/dart.hpp"
#include "core/sampling/point_set.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <bit>
#include <cstdint>

// The definition of the dart process on surfaces: which darts exist, when and where. A dart is a
// candidate for a point. These functions fully determine the points; SurfaceRace only computes
// which darts are accepted. core/surface/README.md explains the process.

namespace thicket {

/// Cells are cubes with a side of one radius. Positions are whole units, 2^surface_bits per side of
/// a cell.
inline constexpr int surface_bits = 20;
inline constexpr std::int32_t surface_cell_size = 1 << surface_bits;
inline constexpr std::int64_t surface_radius_squared = std::int64_t{1} << (2 * surface_bits);

/// Until this time, lines pass through the whole cell. Afterwards, each column of the cell is
/// searched separately, so that covered columns cost no more time. Until the split time, a column
/// is searched by one line after another. Afterwards, it is split into quarters when a line fails.
inline constexpr double surface_search_time = 8.0;
inline constexpr double surface_split_time = 128.0;

/// A cell has 2^surface_column_depth columns in each direction.
inline constexpr int surface_column_depth = 4;
inline constexpr std::uint32_t surface_column_count = 1u << (2 * surface_column_depth);

/// Columns can be split until they are squares with a side of 2^(surface_bits -
/// surface_depth) units. Lines pass through the centers of these smallest squares.
inline constexpr int surface_depth = 16;

/// Number of cells by which the ball around a point can extend beyond the point's cell, in each
/// direction.
inline constexpr std::int32_t surface_reach = 1;

/// The time of a dart. Each cell and axis has an exponential clock, and earlier darts take
/// priority. A time is the bit pattern of a positive double, which sorts like the number, with its
/// low nine bits replaced by the tag of the cell and axis. Cells that darts of one cell can affect
/// have different tags, so their darts never have equal times.
using SurfaceTime = std::uint64_t;
inline constexpr SurfaceTime surface_tag_bits = 511;
inline constexpr SurfaceTime surface_time_unthrown = 0;            ///< A time before every dart.
inline constexpr SurfaceTime surface_time_never = ~SurfaceTime{0}; ///< A time after every dart.

inline SurfaceTime surface_time(double time, std::uint32_t tag) {
	return (std::bit_cast<SurfaceTime>(time) & ~surface_tag_bits) | tag;
}

constexpr std::uint32_t surface_tag(const glm::ivec3 &cell, int axis) {
	return static_cast<std::uint32_t>(axis) + 3 * (mod_5(cell.x) + 5 * (mod_5(cell.y) + 5 * mod_5(cell.z)));
}

/// Returns the two other axes (u and v), in ascending order.
constexpr std::array<int, 2> axes_across(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

/// The axes along which a cell is searched for its surface, and the rate of lines. Lines along axis
/// i hit a surface with the unit normal n at a rate proportional to |n_i|. A hit is therefore kept
/// with a probability inversely proportional to the sum of |n_i| over the searched axes. For any
/// choice of axes, there is one dart per unit of time and area of a cell's face.
struct SurfaceSearch {
	static constexpr std::uint8_t all_axes = 3;

	std::uint8_t axis = all_axes; ///< 0 to 2 if all normals in the cell are close to that axis; otherwise all_axes.
	/// The probability of keeping a hit is kept / (sum of |n_i| over the searched axes).
	/// Lines along one axis through a cell have a rate of 1 / kept.
	float kept = 1.0f;

	int first_axis() const { return axis == all_axes ? 0 : axis; }
	int last_axis() const { return axis == all_axes ? 2 : axis; }

	friend bool operator==(const SurfaceSearch &, const SurfaceSearch &) = default;
};

/// The next line through a column of a cell. A column is a square on one of the cell's faces,
/// extended through the cell. At depth 0, it is the whole cell.
struct SurfaceLine {
	SurfaceTime time = surface_time_never;
	std::uint64_t hash = 0;                ///< Determines this line and all later lines in the column.
	std::array<std::uint16_t, 2> corner{}; ///< The column's lower corner (u, v), in squares of the finest depth.
	std::uint8_t axis = 0;
	std::uint8_t depth = 0; ///< The column is 2^-depth cells wide.
	bool is_first = false;  ///< True for the first line of a column of depth surface_column_depth.
	/// Number of the column of depth surface_column_depth through which the line passes. Columns are
	/// numbered by u, then v.
	std::uint8_t column = 0;

	/// Return the column's width and its lower corner (u, v), in units relative to the cell.
	constexpr std::int32_t width() const { return surface_cell_size >> depth; }
	constexpr std::int32_t low_u() const { return corner[0] << (surface_bits - surface_depth); }
	constexpr std::int32_t low_v() const { return corner[1] << (surface_bits - surface_depth); }

	/// Returns random bits. The upper half determines the time, the lower half the position.
	constexpr std::uint64_t bits() const { return split_mix(hash); }

	/// The line's position (u, v), in units relative to the cell.
	struct Course {
		std::int32_t u;
		std::int32_t v;
	};
	constexpr Course course() const {
		const std::uint64_t random = bits();
		const auto place = [this](std::uint16_t from, std::uint64_t part) {
			constexpr int square = surface_bits - surface_depth;
			const auto within = static_cast<std::int32_t>((part & 0xffffu) >> depth);
			return ((from + within) << square) + (1 << (square - 1));
		};
		return {place(corner[0], random), place(corner[1], random >> 16)};
	}

	/// Returns true, with the given probability, if the line's hits are kept. The result does not
	/// depend on the positions of hits, because their rounding depends on how the surface is
	/// divided into triangles.
	bool keeps(double probability) const {
		return static_cast<double>(split_mix(hash ^ split_mix_mul_0) >> 32) < probability * 4294967296.0;
	}

	/// Returns true if the highest of several hits along the axis is tried first, and false if the
	/// lowest is.
	bool tries_from_above() const { return (split_mix(hash ^ split_mix_mul_0) & 1) != 0; }
};

/// Returns the time of the next line through a column of this depth after `time`. `random` contains
/// the bits of that line.
inline SurfaceTime later_time(SurfaceTime time, std::uint64_t random, int depth, const SurfaceSearch &search) {
	const double wait = static_cast<double>(exponential(static_cast<std::uint32_t>(random >> 32))) *
			static_cast<double>(std::uint64_t{1} << (2 * depth)) * static_cast<double>(search.kept);
	return surface_time(std::bit_cast<double>(time) + wait, static_cast<std::uint32_t>(time & surface_tag_bits));
}

/// Moves a line of depth 0 to the next line through the cell.
inline void move_to_next(SurfaceLine &r_line, const SurfaceSearch &search) {
	r_line.hash += split_mix_gamma;
	const std::uint64_t random = r_line.bits();
	r_line.time = later_time(r_line.time, random, 0, search);
	constexpr int part = 16 - surface_column_depth;
	constexpr std::uint64_t mask = (1u << surface_column_depth) - 1;
	r_line.column =
			static_cast<std::uint8_t>((random >> part & mask) | (random >> (16 + part) & mask) << surface_column_depth);
}

/// The source of random numbers for one level of a point set.
struct SurfaceSource {
	std::array<std::uint32_t, 2> key{}; ///< Seed of the point set.
	std::uint32_t stream = 0;           ///< The layer and the level.

	static constexpr SurfaceSource of(const PointSet &set, std::uint32_t level) {
		return {{static_cast<std::uint32_t>(set.seed), static_cast<std::uint32_t>(set.seed >> 32)},
				std::uint32_t{set.layer} | level << 16};
	}

	/// Returns a cell's first line along an axis.
	SurfaceLine first(const glm::ivec3 &cell, int axis, const SurfaceSearch &search) const {
		const auto random =
				philox4x32({static_cast<std::uint32_t>(cell.x), static_cast<std::uint32_t>(cell.y),
								   static_cast<std::uint32_t>(cell.z), stream | static_cast<std::uint32_t>(axis) << 30},
						key);
		SurfaceLine line;
		line.time = surface_time(0.0, surface_tag(cell, axis));
		line.hash = std::uint64_t{random[0]} << 32 | random[1];
		line.axis = static_cast<std::uint8_t>(axis);
		move_to_next(line, search);
		return line;
	}
};
static_assert(max_levels <= 1u << 14, "the level must leave the two bits of the axis free");

/// Generates the first line through each column of a cell. These lines follow the lines through the
/// whole cell.
struct SurfaceColumnClocks {
	std::uint64_t hash = 0; ///< The hash of the line that follows the last line through the whole cell.

	/// Orders the first lines by time without computing the times: a higher key means an earlier
	/// line. Keys are positive and distinct.
	using Key = std::uint64_t;

	constexpr std::uint64_t hash_of(std::uint32_t column) const {
		return hash + (column + std::uint64_t{1}) * split_mix_gamma;
	}

	constexpr Key key(std::uint32_t column) const {
		return split_mix(hash_of(column)) >> 32 << 32 | (surface_column_count - column);
	}

	static constexpr std::uint32_t column_of(Key key) {
		return surface_column_count - static_cast<std::uint32_t>(key & 0xffffffffu);
	}

	/// Returns the first line through a column.
	SurfaceLine first(std::uint32_t column, int axis, std::uint32_t tag, const SurfaceSearch &search) const {
		constexpr int shift = surface_depth - surface_column_depth;
		SurfaceLine line;
		line.hash = hash_of(column);
		line.corner[0] = static_cast<std::uint16_t>((column & ((1u << surface_column_depth) - 1)) << shift);
		line.corner[1] = static_cast<std::uint16_t>((column >> surface_column_depth) << shift);
		line.axis = static_cast<std::uint8_t>(axis);
		line.depth = surface_column_depth;
		line.is_first = true;
		line.column = static_cast<std::uint8_t>(column);
		line.time = later_time(surface_time(surface_search_time, tag), line.bits(), line.depth, search);
		return line;
	}

	/// Returns the clocks that generated a first line.
	static constexpr SurfaceColumnClocks of(const SurfaceLine &line) {
		return {line.hash - (line.column + std::uint64_t{1}) * split_mix_gamma};
	}
};

/// Returns the next line through the same column.
inline SurfaceLine later_line(const SurfaceLine &line, const SurfaceSearch &search) {
	SurfaceLine next = line;
	next.is_first = false;
	next.hash = line.bits() + split_mix_gamma;
	next.time = later_time(line.time, next.bits(), next.depth, search);
	return next;
}

/// Returns the first line of a quarter of a line's column. Quarters are numbered by u, then v. The
/// quarter's clock starts at the time of `parent`.
inline SurfaceLine quarter_line(const SurfaceLine &parent, std::uint32_t quarter, const SurfaceSearch &search) {
	SurfaceLine line = parent;
	line.is_first = false;
	++line.depth;
	const std::uint32_t width = (1u << surface_depth) >> line.depth;
	line.corner[0] = static_cast<std::uint16_t>(line.corner[0] + (quarter & 1) * width);
	line.corner[1] = static_cast<std::uint16_t>(line.corner[1] + (quarter >> 1) * width);
	line.hash = parent.bits() + (quarter + 2) * split_mix_gamma;
	line.time = later_time(parent.time, line.bits(), line.depth, search);
	return line;
}

} // namespace thicket
