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

/// A column of depth d (see SurfaceLine) is searched by lines through the whole column until the time
/// surface_split_time * 4^d, and then separately in its four quarters, so that parts that are
/// covered cost no more time. Columns deeper than surface_patch_depth are split as soon as a line
/// fails.
inline constexpr double surface_split_time = 2.0;
inline constexpr int surface_patch_depth = 3;

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
	float kept = 1.0f;

	int first_axis() const { return axis == all_axes ? 0 : axis; }
	int last_axis() const { return axis == all_axes ? 2 : axis; }

	/// Returns the number of lines along one axis through a whole cell, per unit of time. With this
	/// number, there is one kept hit per unit of time and area of a cell's face.
	double rate() const { return 1.0 / static_cast<double>(kept); }

	friend bool operator==(const SurfaceSearch &, const SurfaceSearch &) = default;
};

/// The next line through a column of a cell. A column is a square on one of the cell's faces,
/// extended through the cell.
struct SurfaceLine {
	SurfaceTime time = surface_time_never;
	std::uint64_t hash = 0;                ///< Determines this line and all later lines in the column.
	std::array<std::uint16_t, 2> corner{}; ///< The column's lower corner (u, v), in squares of the finest depth.
	std::uint8_t axis = 0;
	std::uint8_t depth = 0; ///< The column is 2^-depth cells wide.

	/// Return the column's width and its lower corner (u, v), in units relative to the cell.
	constexpr std::int32_t width() const { return surface_cell_size >> depth; }
	constexpr std::int32_t low_u() const { return corner[0] << (surface_bits - surface_depth); }
	constexpr std::int32_t low_v() const { return corner[1] << (surface_bits - surface_depth); }

	/// The line's position (u, v), in units relative to the cell.
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

	/// Returns true, with the given probability, if the line's hits are kept. The result does not
	/// depend on the positions of hits, because their rounding depends on how the surface is
	/// divided into triangles.
	bool keeps(double probability) const {
		return static_cast<double>(split_mix(hash ^ split_mix_mul_0) >> 32) < probability * 4294967296.0;
	}

	/// Returns true if the highest of several hits along the axis is tried first, and false if the
	/// lowest is.
	bool tries_from_above() const { return (hash & 1) != 0; }
};

/// The source of random numbers for one level of a point set.
struct SurfaceSource {
	std::array<std::uint32_t, 2> key{}; ///< Seed of the point set.
	std::uint32_t stream = 0;           ///< The layer and the level.

	static constexpr SurfaceSource of(const PointSet &set, std::uint32_t level) {
		return {{static_cast<std::uint32_t>(set.seed), static_cast<std::uint32_t>(set.seed >> 32)},
				std::uint32_t{set.layer} | level << 16};
	}

	/// Returns a cell's first line along an axis.
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

/// Returns the next line through the same column.
inline SurfaceLine later_line(const SurfaceLine &line, double rate) {
	SurfaceLine next = line;
	next.hash = split_mix(line.hash + split_mix_gamma);
	const double wait = static_cast<double>(exponential(static_cast<std::uint32_t>(next.hash >> 32))) *
			static_cast<double>(std::uint64_t{1} << (2 * next.depth));
	next.time = surface_time(
			std::bit_cast<double>(line.time) + wait / rate, static_cast<std::uint32_t>(line.time & surface_tag_bits));
	return next;
}

/// Returns `line` with its column replaced by a quarter of it. Quarters are numbered by u, then v.
constexpr SurfaceLine quarter_of(SurfaceLine line, std::uint32_t quarter) {
	++line.depth;
	const std::uint32_t width = (1u << surface_depth) >> line.depth;
	line.corner[0] = static_cast<std::uint16_t>(line.corner[0] + (quarter & 1) * width);
	line.corner[1] = static_cast<std::uint16_t>(line.corner[1] + (quarter >> 1) * width);
	return line;
}

/// Returns the first line of a quarter of a line's column. The quarter's clock starts at the time
/// of `parent`.
inline SurfaceLine quarter_line(const SurfaceLine &parent, std::uint32_t quarter, double rate) {
	SurfaceLine from = quarter_of(parent, quarter);
	from.hash += quarter * split_mix_gamma;
	return later_line(from, rate);
}

} // namespace thicket
