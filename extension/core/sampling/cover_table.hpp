#pragma once

#include "core/sampling/work.hpp"

#include <array>
#include <cstdint>

namespace thicket {

/// Half the width of a point's disk in each row of sub-squares. Within this width, all lattice
/// points of the row lie within the radius, which is the farthest-corner test of section 3.2 of the
/// paper (White, Cline and Egbert, 2007). The half width is stored as whole sub-squares and 256ths,
/// both rounded down. The table is indexed by the height of the point within its row of
/// sub-squares, rounded so that no width is too large.
struct CoverTable {
	static constexpr std::int32_t heights = 128;
	static constexpr std::int32_t height_bits = sub_bits - 7;
	/// The maximum distance of a point from the lowest row of its neighborhood, in rows.
	static constexpr std::int32_t own_row = 19;
	static constexpr std::int32_t rows = 40;
	static constexpr std::int8_t none = -100; ///< Marks a row in which the disk covers no sub-square.

	struct Line {
		std::array<std::int8_t, rows> whole{};
		std::array<std::uint8_t, rows> part{};
	};
	std::array<Line, heights> lines{};
};

constexpr std::int32_t whole_root(std::int32_t value) {
	std::int32_t root = 0;
	for (std::int32_t bit = 1 << 14; bit != 0; bit >>= 1) {
		root += (root + bit) * (root + bit) <= value ? bit : 0;
	}
	return root;
}

constexpr CoverTable make_cover_table() {
	constexpr std::int32_t size = 1 << sub_bits;
	CoverTable table;
	for (std::int32_t height = 0; height < CoverTable::heights; ++height) {
		const std::int32_t lowest = height << CoverTable::height_bits;
		const std::int32_t highest = lowest + (1 << CoverTable::height_bits) - 1;
		CoverTable::Line &line = table.lines[static_cast<std::size_t>(height)];
		line.whole.fill(CoverTable::none);
		for (std::int32_t row = -12; row <= 12; ++row) {
			// The distance from the point to the farther edge of the row.
			const std::int32_t above = (row + 1) * size - 1 - lowest;
			const std::int32_t below = highest - row * size;
			const std::int32_t distance = above > below ? above : below;
			const std::int32_t rest = static_cast<std::int32_t>(radius_squared) - 1 - distance * distance;
			if (rest >= 0) {
				const std::int32_t half = whole_root(rest);
				const auto index = static_cast<std::size_t>(CoverTable::own_row + row);
				line.whole[index] = static_cast<std::int8_t>(half >> sub_bits);
				line.part[index] = static_cast<std::uint8_t>((half & (size - 1)) >> (sub_bits - 8));
			}
		}
	}
	return table;
}

alignas(64) inline constexpr CoverTable cover_table = make_cover_table();

/// The rows of sub-squares around a point, relative to the lowest cell of its neighborhood.
struct CoverRows {
	const std::int8_t *whole; ///< Whole sub-squares of half the width, for 32 rows, lowest first.
	const std::uint8_t *part;
	std::int32_t column; ///< The column that contains the point.
	std::int32_t beyond; ///< Offset of the point from the column's edge, in 256ths, rounded down.

	CoverRows(std::int32_t x, std::int32_t y) : column(x >> sub_bits), beyond(x >> (sub_bits - 8) & 0xff) {
		constexpr std::int32_t size = 1 << sub_bits;
		const auto &line = cover_table.lines[static_cast<std::size_t>((y & (size - 1)) >> CoverTable::height_bits)];
		const auto first = static_cast<std::size_t>(CoverTable::own_row - (y >> sub_bits));
		whole = line.whole.data() + first;
		part = line.part.data() + first;
	}

	/// Returns the covered columns of a row, one bit each.
	std::uint32_t bits(std::int32_t row) const {
		const std::int32_t from = column - whole[row] + (beyond >= part[row] ? 1 : 0);
		const std::int32_t to = column + whole[row] + (beyond + part[row] >= 256 ? 1 : 0);
		constexpr std::uint64_t one = 1;
		return from < to ? static_cast<std::uint32_t>((one << to) - (one << from)) : 0;
	}
};

} // namespace thicket
