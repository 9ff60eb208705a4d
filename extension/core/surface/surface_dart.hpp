#pragma once

#include "core/base/philox.hpp"
#include "core/base/split_mix.hpp"
#include "core/sampling/dart.hpp"
#include "core/sampling/point_set.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <bit>
#include <cstdint>

// The definition of the process on surfaces: which darts exist, when and where. These functions determine every placement. The resolver
// only finds out which darts are accepted. core/surface/README.md explains the process.

namespace thicket {

/// Cells are cubes with a side of radius / sqrt(3), so that a cell contains one point at most. Positions in a cell are
/// whole units; a side has 2^surface_bits units; radius^2 = 3 * 4^surface_bits units^2, exactly.
inline constexpr int surface_bits = 20;
inline constexpr std::int32_t surface_cell_size = 1 << surface_bits;
inline constexpr std::int64_t surface_radius_squared = std::int64_t{3} << (2 * surface_bits);

/// Lines run through the middle of squares of 2^(surface_bits - surface_depth) units. Columns are not split further than to such squares.
inline constexpr int surface_depth = 16;

/// How many cells a ball can reach beyond the cell of its center.
inline constexpr std::int32_t surface_reach = 2;

/// A time in the race of exponential clocks: the bits of a positive double, which sort like the times, with the low nine bits replaced by
/// the tag of the cell and axis. So darts of cells that are at most two apart on each axis never tie.
using SurfaceTime = std::uint64_t;
inline constexpr SurfaceTime surface_tag_bits = 511;
inline constexpr SurfaceTime surface_time_unthrown = 0;            ///< Before every dart.
inline constexpr SurfaceTime surface_time_never = ~SurfaceTime{0}; ///< After every dart.

inline SurfaceTime surface_time(double time, std::uint32_t tag) {
	return (std::bit_cast<SurfaceTime>(time) & ~surface_tag_bits) | tag;
}

constexpr std::uint32_t surface_tag(const glm::ivec3 &cell, int axis) {
	return static_cast<std::uint32_t>(axis) + 3 * (mod_5(cell.x) + 5 * (mod_5(cell.y) + 5 * mod_5(cell.z)));
}

/// The two other axes, in the order of their names.
constexpr std::array<int, 2> axes_across(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

/// Along which axes a cell is searched for its surface, and how often. A line along axis i meets an area with the unit normal n with a
/// rate of |n_i|, so a hit is kept with a probability that is inversely proportional to the sum of |n_i| over the searched axes. The
/// darts have a rate of 1 per area of a cell's face, whichever axes are searched.
struct SurfaceSearch {
	static constexpr std::uint8_t all_axes = 3;

	std::uint8_t axis = all_axes; ///< 0 to 2 if one axis suffices, because no normal in the cell is far from it.
	float kept = 1.0f;            ///< A hit is kept with the probability kept / (sum of |n_i| over the searched axes).

	int first_axis() const { return axis == all_axes ? 0 : axis; }
	int last_axis() const { return axis == all_axes ? 2 : axis; }

	/// The number of lines along one axis per unit of time through a whole cell. Kept hits then have a rate of 1 per area of a cell's face.
	double rate() const { return 1.0 / static_cast<double>(kept); }

	friend bool operator==(const SurfaceSearch &, const SurfaceSearch &) = default;
};

/// The next line through a column of a cell: a square of one of its faces, and everything behind it.
struct SurfaceLine {
	SurfaceTime time = surface_time_never;
	std::uint64_t hash = 0; ///< Determines the line, and all later ones in the same column.
	std::array<std::uint16_t, 2>
			corner{}; ///< The column's lower corner across the axis, in squares of the finest depth.
	std::uint8_t axis = 0;
	std::uint8_t depth = 0; ///< The column is 2^-depth cells wide.

	/// The column's width, and its lower corner on the two other axes, in the order of their names, in units within the cell.
	constexpr std::int32_t width() const { return surface_cell_size >> depth; }
	constexpr std::int32_t low_u() const { return corner[0] << (surface_bits - surface_depth); }
	constexpr std::int32_t low_v() const { return corner[1] << (surface_bits - surface_depth); }

	/// The line's position on the two other axes, in the order of their names, in units within the cell.
	struct Course {
		std::int32_t u;
		std::int32_t v;
	};
	Course course() const {
		const std::uint64_t bits = split_mix(hash ^ split_mix_mul_1);
		const auto place = [this](std::uint16_t from, std::uint64_t random) {
			constexpr int square = surface_bits - surface_depth;
			const auto within = static_cast<std::int32_t>((random & 0xffffu) >> depth);
			return ((from + within) << square) + (1 << (square - 1));
		};
		return {place(corner[0], bits), place(corner[1], bits >> 16)};
	}

	/// Returns true, with the given probability, if the line's hits are kept. The result does not depend on the
	/// positions of hits, because these are rounded differently if the same surface is divided into different
	/// triangles.
	bool keeps(double probability) const {
		return static_cast<double>(split_mix(hash ^ split_mix_mul_0) >> 32) < probability * 4294967296.0;
	}

	/// The order in which sheets are tried if the line meets several.
	bool tries_from_above() const { return (hash & 1) != 0; }
};

/// The random source of one level of one point set.
struct SurfaceSource {
	std::array<std::uint32_t, 2> key{}; ///< The seed.
	std::uint32_t stream = 0;           ///< Layer and level of the progressive order.

	static constexpr SurfaceSource of(const PointSet &set, std::uint32_t level) {
		return {{static_cast<std::uint32_t>(set.seed), static_cast<std::uint32_t>(set.seed >> 32)},
				std::uint32_t{set.layer} | level << 16};
	}

	/// A cell's first line along an axis.
	SurfaceLine first(const glm::ivec3 &cell, int axis, double rate) const {
		const auto random =
				philox4x32({static_cast<std::uint32_t>(cell.x), static_cast<std::uint32_t>(cell.y),
								   static_cast<std::uint32_t>(cell.z), stream | static_cast<std::uint32_t>(axis) << 30},
						key);
		SurfaceLine line;
		line.time = surface_time(static_cast<double>(exponential(random[2])) / rate, surface_tag(cell, axis));
		line.hash = std::uint64_t{random[0]} << 32 | random[1];
		line.axis = static_cast<std::uint8_t>(axis);
		return line;
	}
};
static_assert(max_levels <= 1u << 14, "the level must leave the two bits of the axis free");

/// The first line of a part of a line's column, whose clock starts when that line gave no point. A part is 2^-halvings as wide as the
/// column. Parts are numbered by u, then v.
inline SurfaceLine part_line(const SurfaceLine &parent, std::uint32_t part, int halvings, double rate) {
	SurfaceLine next = parent;
	next.hash = split_mix(parent.hash + (part + 1) * split_mix_gamma);
	next.depth = static_cast<std::uint8_t>(parent.depth + halvings);
	const std::uint32_t width = (1u << surface_depth) >> next.depth;
	const std::uint32_t u = part & ((1u << halvings) - 1);
	const std::uint32_t v = part >> halvings;
	next.corner = {static_cast<std::uint16_t>(parent.corner[0] + u * width),
			static_cast<std::uint16_t>(parent.corner[1] + v * width)};
	const double wait = static_cast<double>(exponential(static_cast<std::uint32_t>(next.hash >> 32))) *
			static_cast<double>(std::uint64_t{1} << (2 * next.depth));
	next.time = surface_time(std::bit_cast<double>(parent.time) + wait / rate,
			static_cast<std::uint32_t>(parent.time & surface_tag_bits));
	return next;
}

} // namespace thicket
