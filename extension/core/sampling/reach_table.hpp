#pragma once

#include "core/sampling/dart.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace thicket {

/// For each of 32 x 32 parts of a cell, the cells that the disk of a dart in that part may reach.
/// The cells are bits of the 4 x 4 neighborhood, in row order, without the dart's own cell. An
/// extra cell only makes a dart wait longer than necessary and never changes a result.
struct ReachTable {
	static constexpr std::uint32_t part_bits = lattice_bits - 5;
	std::array<std::uint16_t, 32 * 32> cells{};

	static constexpr std::size_t index_of(CellPosition position) {
		return (position_y(position) >> part_bits) * 32 + (position_x(position) >> part_bits);
	}
};

constexpr ReachTable make_reach_table() {
	constexpr auto side = static_cast<std::int32_t>(cell_size);
	constexpr std::int32_t part = 1 << ReachTable::part_bits;
	// Returns the gap on one axis between the part and a cell of the neighborhood. The neighborhood
	// starts two cells below the dart's cell if the dart is in the lower half of its cell,
	// otherwise one cell below.
	const auto gap = [](std::int32_t first, std::int32_t cell) {
		const std::int32_t corner = (cell - (first < side / 2 ? 2 : 1)) * side;
		const std::int32_t before = first - (corner + side - 1);
		const std::int32_t behind = corner - (first + part - 1);
		return before > 0 ? before : behind > 0 ? behind : 0;
	};
	ReachTable table;
	for (std::int32_t y = 0; y < 32; ++y) {
		for (std::int32_t x = 0; x < 32; ++x) {
			std::uint32_t bits = 0;
			for (std::int32_t cell = 0; cell < 16; ++cell) {
				const std::int32_t gap_x = gap(x * part, cell % 4);
				const std::int32_t gap_y = gap(y * part, cell / 4);
				const std::int32_t distance2 = gap_x * gap_x + gap_y * gap_y;
				bits |= distance2 > 0 && distance2 < static_cast<std::int32_t>(radius_squared) ? 1u << cell : 0u;
			}
			table.cells[static_cast<std::size_t>(y * 32 + x)] = static_cast<std::uint16_t>(bits);
		}
	}
	return table;
}

alignas(64) inline constexpr ReachTable reach_table = make_reach_table();

inline std::uint32_t reached_cells(CellPosition dart) { return reach_table.cells[ReachTable::index_of(dart)]; }

} // namespace thicket
