#pragma once

#include "core/base/floating_point.hpp"
#include "core/base/philox.hpp"
#include "core/base/split_mix.hpp"
#include "core/sampling/point_set.hpp"

#include <bit>
#include <cstdint>

// Defines the random process of the plane: which darts exist, at what time and at what position. A
// dart is a candidate for a point; ARCHITECTURE.md explains the process. These functions determine
// every point, and the resolver only decides which darts are accepted. Positions are in lattice
// units within a cell.

namespace thicket {

inline constexpr std::uint32_t cell_size = 1u << lattice_bits;
inline constexpr std::uint32_t cell_mask = cell_size - 1;
inline constexpr std::uint32_t radius_squared = 2u << (2 * lattice_bits);

/// A position in a cell: x in the low lattice_bits bits, y in the bits above.
using CellPosition = std::uint32_t;
inline constexpr std::uint32_t position_mask = (1u << (2 * lattice_bits)) - 1;

constexpr std::uint32_t position_x(CellPosition position) { return position & cell_mask; }
constexpr std::uint32_t position_y(CellPosition position) { return position >> lattice_bits & cell_mask; }

/// A time in the race of exponential clocks, stored as the bits of a positive float, which sort in
/// the same order as the times. The cell's tag replaces the low five bits.
using TimeKey = std::uint32_t;
inline constexpr std::uint32_t tag_bits = 31;
inline constexpr TimeKey time_unknown = 0; ///< Earlier than every dart. Marks cells outside the grid.
/// Earlier than every dart. Marks cells whose first dart was not thrown yet.
inline constexpr TimeKey time_unthrown = 1;
inline constexpr TimeKey time_never = 0x7f800000; ///< Later than every dart. Marks decided cells.

/// Returns the tag of a cell. Cells at most two apart on each axis have different tags, so the
/// times of conflicting darts never tie.
constexpr std::uint32_t tag_of(std::uint32_t x_mod_5, std::uint32_t y_mod_5) { return x_mod_5 + 5 * y_mod_5; }

constexpr std::uint32_t mod_5(std::int32_t cell) {
	const std::int32_t remainder = cell % 5;
	return static_cast<std::uint32_t>(remainder < 0 ? remainder + 5 : remainder);
}

/// Converts random bits to an exponentially distributed number of mean 1: -ln(u), where u is an odd
/// multiple of 2^-24. The logarithm of the mantissa is computed as ln m = 2 artanh((m - 1) / (m +
/// 1)). The function uses only IEEE float operations in a fixed order, so all code paths return the
/// same bits. The error is below 1e-6.
inline float exponential(std::uint32_t random) {
	const float odd = static_cast<float>(static_cast<std::int32_t>(random >> 8 | 1u));
	const auto bits = std::bit_cast<std::uint32_t>(odd);
	// The mantissa is in [0.75, 1.5), so that values of u just below 1 lose no precision to
	// cancellation.
	const std::uint32_t shifted = bits + 0x00400000u;
	const auto exponent = static_cast<std::int32_t>(shifted >> 23) - 127 - 24;
	const float mantissa = std::bit_cast<float>((shifted & 0x007fffffu) + 0x3f400000u);
	const float s = (mantissa - 1.0f) / (mantissa + 1.0f);
	const float s2 = s * s;
	const float s4 = s2 * s2;
	const float low = s2 * (1.0f / 3.0f) + 1.0f;
	const float high = s2 * (1.0f / 7.0f) + (1.0f / 5.0f) + s4 * (1.0f / 9.0f);
	const float series = high * s4 + low;
	const float ln_mantissa = (s + s) * series;
	return static_cast<float>(-exponent) * 0.693147180559945f - ln_mantissa;
}

/// A dart of a cell. From high to low bits, the key contains the TimeKey, the quadtree level of the
/// dart's square (0 is the whole cell), and the CellPosition. Sorting by key sorts a cell's darts
/// by time.
using DartKey = std::uint64_t;

constexpr DartKey make_dart(TimeKey time, std::uint32_t level_position) { return DartKey{time} << 32 | level_position; }

/// Later than every dart, even when the keys are compared as signed numbers.
inline constexpr DartKey dart_never = ~DartKey{0} >> 1;

constexpr TimeKey dart_time(DartKey dart) { return static_cast<TimeKey>(dart >> 32); }
constexpr std::uint32_t dart_level_position(DartKey dart) { return static_cast<std::uint32_t>(dart); }

constexpr std::uint32_t dart_level(std::uint32_t level_position) { return level_position >> (2 * lattice_bits); }
constexpr CellPosition dart_position(std::uint32_t level_position) { return level_position & position_mask; }

/// Returns the lower corner of the dart's square.
constexpr CellPosition square_origin(std::uint32_t level_position) {
	const std::uint32_t inside = cell_mask >> dart_level(level_position);
	return dart_position(level_position) & ~(inside | inside << lattice_bits);
}

/// The random source of one level of one point set.
struct DartSource {
	std::array<std::uint32_t, 2> key; ///< The seed of the point set.
	std::uint32_t stream;             ///< The layer in the low 16 bits, and the level of the progressive order.
	glm::ivec2 period;                ///< PointSet::period in cells of this level.

	static constexpr DartSource of(const PointSet &set, std::uint32_t level) {
		return {{static_cast<std::uint32_t>(set.seed), static_cast<std::uint32_t>(set.seed >> 32)},
				std::uint32_t{set.layer} | level << 16, set.period >> static_cast<std::int32_t>(level)};
	}

	/// Returns the first dart of a cell. Its clock runs at rate 1, the area of a cell. Cells that are a
	/// period apart have equal darts, and their tags are equal, too, because a period is a multiple of 5
	/// cells.
	DartKey base_dart(std::int32_t cell_x, std::int32_t cell_y) const {
		const std::int32_t x = wrapped(cell_x, period.x);
		const std::int32_t y = wrapped(cell_y, period.y);
		const auto random = philox4x32({static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), stream, 0}, key);
		const TimeKey time = (std::bit_cast<TimeKey>(exponential(random[0])) & ~tag_bits) | tag_of(mod_5(x), mod_5(y));
		return make_dart(time, random[1] & position_mask);
	}
};

/// Returns the dart of a child square (0 to 3, x first), hashed from the parent's dart. Its clock
/// starts at the parent's time and runs at rate 4^-level. The child is never earlier than its
/// parent, because float addition is monotonic and both keys have the same tag.
inline DartKey child_dart(DartKey parent, std::uint32_t child) {
	const std::uint64_t random = split_mix(parent + (child + 1) * split_mix_gamma);
	const std::uint32_t level = dart_level(dart_level_position(parent)) + 1;
	const std::uint32_t width = cell_size >> level;
	const CellPosition corner =
			square_origin(dart_level_position(parent)) + (child & 1) * width + (child >> 1) * (width << lattice_bits);
	const float wait = exponential(static_cast<std::uint32_t>(random >> 32)) * static_cast<float>(1u << (2 * level));
	const float time = std::bit_cast<float>(dart_time(parent)) + wait;
	const TimeKey key = (std::bit_cast<TimeKey>(time) & ~tag_bits) | (dart_time(parent) & tag_bits);
	const std::uint32_t inside = (width - 1) | (width - 1) << lattice_bits;
	return make_dart(key, level << (2 * lattice_bits) | corner | (static_cast<std::uint32_t>(random) & inside));
}

} // namespace thicket
