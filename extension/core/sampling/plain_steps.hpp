#pragma once

#include "core/sampling/cover_table.hpp"
#include "core/sampling/level_grid.hpp"
#include "core/sampling/reach_table.hpp"
#include "core/sampling/work.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>

// Scalar steps of the resolver for processors without vectors. There, visiting only the entries
// that exist is faster than visiting all lanes. The results are bit-identical to those of the
// vector functions with the same names.

namespace thicket {

/// The result of checking the neighborhood of a dart.
struct Verdict {
	bool conflict; ///< An accepted point lies within the radius of the dart.
	bool blocked;  ///< Another cell that the dart's disk reaches has an earlier dart.
};

namespace plain {

/// Distances are clamped to this value. The sum of two squares of it still fits in 31 bits, and one
/// square exceeds radius^2.
constexpr std::int32_t farthest = 23171;

constexpr std::int32_t square(std::int32_t distance) {
	const std::int32_t capped = std::min(std::abs(distance), farthest);
	return capped * capped;
}

/// Checks the neighborhood of a dart at (x, y), relative to the lower corner of the 4 x 4 cells
/// that its disk can reach.
inline Verdict examine_neighborhood(
		const LevelGrid &grid, std::uint32_t lowest, CellPosition dart, std::int32_t x, std::int32_t y, TimeKey time) {
	constexpr auto side = static_cast<std::int32_t>(cell_size);
	std::uint32_t earlier = 0;
	std::uint32_t points = 0;
	for (std::uint32_t i = 0; i < 16; ++i) {
		const std::uint32_t cell = lowest + i / 4 * grid.stride + i % 4;
		earlier |= std::uint32_t{grid.time[cell] < time} << i;
		points |= std::uint32_t{grid.point[cell] != LevelGrid::no_point} << i;
	}
	const std::uint32_t reached = reached_cells(dart);
	for (points &= reached; points != 0; points &= points - 1) {
		const auto i = static_cast<std::uint32_t>(std::countr_zero(points));
		const CellPosition point = LevelGrid::position_of(grid.point[lowest + i / 4 * grid.stride + i % 4]);
		const std::int32_t dx =
				static_cast<std::int32_t>(i % 4) * side + static_cast<std::int32_t>(position_x(point)) - x;
		const std::int32_t dy =
				static_cast<std::int32_t>(i / 4) * side + static_cast<std::int32_t>(position_y(point)) - y;
		if (square(dx) + square(dy) < static_cast<std::int32_t>(radius_squared)) {
			return {true, false};
		}
	}
	return {false, (earlier & reached) != 0};
}

/// Transposes eight rows of four bytes into four cells of eight bytes. Each 64-bit word contains
/// two rows.
inline void rows_to_cells(const std::uint32_t *rows, std::uint64_t *r_cells) {
	constexpr std::uint64_t bytes = 0x00ff00ff00ff00ff;
	constexpr std::uint64_t pairs = 0x0000ffff0000ffff;
	std::uint64_t words[4];
	for (std::uint32_t i = 0; i < 4; ++i) {
		words[i] = rows[i] | std::uint64_t{rows[i + 4]} << 32;
	}
	const std::uint64_t even[2] = {
			(words[0] & bytes) | (words[1] & bytes) << 8, (words[2] & bytes) | (words[3] & bytes) << 8};
	const std::uint64_t odd[2] = {
			(words[0] >> 8 & bytes) | (words[1] & ~bytes), (words[2] >> 8 & bytes) | (words[3] & ~bytes)};
	r_cells[0] = (even[0] & pairs) | (even[1] & pairs) << 16;
	r_cells[1] = (odd[0] & pairs) | (odd[1] & pairs) << 16;
	r_cells[2] = (even[0] >> 16 & pairs) | (even[1] & ~pairs);
	r_cells[3] = (odd[0] >> 16 & pairs) | (odd[1] & ~pairs);
}

/// Computes the sub-squares that a point's disk covers in the 4 x 4 cells around it.
inline void cover_of(const CoverRows &around, std::uint64_t *r_cells) {
	std::uint32_t rows[32];
	for (std::int32_t row = 0; row < 32; ++row) {
		rows[row] = around.bits(row);
	}
	for (std::uint32_t row = 0; row < 4; ++row) {
		rows_to_cells(rows + 8 * row, r_cells + 4 * row);
	}
}

/// Closes the sub-squares that a new point covers in the 4 x 4 cells around it.
inline void stamp(LevelGrid &grid, std::uint32_t lowest, const std::uint64_t *cover) {
	for (std::uint32_t i = 0; i < 16; ++i) {
		const std::uint32_t cell = lowest + i / 4 * grid.stride + i % 4;
		grid.open[cell] &= ~cover[i];
		if (grid.open[cell] == 0 && grid.time[cell] != time_unknown) {
			grid.time[cell] = time_never;
		}
	}
}

/// Returns the children of the square at the packed `level_position` that have a sub-square not
/// known to be covered, one bit each.
inline std::uint64_t open_children(std::uint32_t level_position, std::uint64_t open) {
	const std::uint32_t level = dart_level(level_position);
	if (level >= static_cast<std::uint32_t>(lattice_bits)) {
		return 0;
	}
	constexpr std::uint64_t child_of[2] = {0x0f0f0f0f, 0x0303};
	const std::uint32_t side = level < 3 ? 7u >> level : 0;
	const std::uint64_t parts = open >> (sub_square_of(dart_position(level_position)) & ~(side | side << 3));
	const std::uint64_t child = level < 2 ? child_of[level] : 1;
	const std::uint32_t step = level < 3 ? 4u >> level : 0;
	const auto bit = [&](std::uint32_t to, std::uint64_t value) {
		return (parts >> to & child) != 0 ? value : 0;
	};
	return bit(0, 1) | bit(step, 2) | bit(8 * step, 4) | bit(9 * step, 8);
}

/// Sorts rejected cells by the open children of their squares; see splits-inl.hpp.
inline void sort_by_children(
		const LevelGrid &grid, const Group &cells, Splits &r_splits, Group &r_deep, Group &r_spent) {
	constexpr std::uint32_t first_deep = 3;
	r_splits.count = 0;
	for (std::uint32_t i = 0; i < cells.count; ++i) {
		const Item item = cells.items[i];
		const std::uint32_t cell = cell_of(item);
		const std::uint64_t open = open_children(grid.dart[cell], grid.open[cell]);
		if (open == 0) {
			r_spent.add_if(item, grid.time[cell] != time_never);
		} else if (dart_level(grid.dart[cell]) >= first_deep) {
			r_deep.add_if(item, true);
		} else {
			r_splits.items[r_splits.count] = item;
			r_splits.parent[r_splits.count] = make_dart(grid.time[cell], grid.dart[cell]);
			r_splits.open_children[r_splits.count] = open;
			++r_splits.count;
		}
	}
}

inline void throw_child_darts(Splits &splits) {
	std::uint32_t count = 0;
	for (std::uint32_t i = 0; i < splits.count; ++i) {
		splits.first[i] = count;
		for (std::uint64_t open = splits.open_children[i]; open != 0; open &= open - 1) {
			const DartKey dart = child_dart(splits.parent[i], static_cast<std::uint32_t>(std::countr_zero(open)));
			splits.time[count] = dart_time(dart);
			splits.level_position[count] = dart_level_position(dart);
			++count;
		}
	}
	splits.first[splits.count] = count;
}

} // namespace plain

} // namespace thicket
