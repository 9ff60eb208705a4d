#pragma once

#include "core/sampling/waiting_squares.hpp"
#include "core/sampling/work.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// A rectangle of cells, half-open.
struct CellRect {
	glm::ivec2 min{0};
	glm::ivec2 max{0};

	constexpr bool contains(glm::ivec2 cell) const {
		return min.x <= cell.x && cell.x < max.x && min.y <= cell.y && cell.y < max.y;
	}
	constexpr CellRect grown(std::int32_t by) const { return {min - by, max + by}; }
	constexpr glm::ivec2 size() const { return max - min; }
	friend constexpr bool operator==(const CellRect &, const CellRect &) = default;
};

/// The cells of the next coarser level that contain all points that can lie within that level's radius of the given cells.
constexpr CellRect coarse_cells_around(const CellRect &cells) {
	return {(cells.min >> 1) - 1, ((cells.max - 1) >> 1) + 2};
}

/// Maps an accepted dart to its rank in the progressive order.
using RankFunction = std::uint32_t (*)(std::uint32_t levels, std::uint32_t level, TimeKey time);

/// The state of the race over a rectangle of cells of one level of the progressive order. Cells are stored by rows, with a border of
/// `border` cells whose time is unknown. A chain that needs a border cell must start again in a larger grid.
struct LevelGrid {
	static constexpr std::int32_t border = 2; ///< How many cells a disk can reach beyond its own cell.

	/// A point's offset from the center of its cell: x in the low 16 bits, y in the high ones, both signed.
	using PointOffset = std::int32_t;
	static constexpr PointOffset no_point = 0x7fff7fff;

	static constexpr PointOffset offset_of(CellPosition position) {
		constexpr std::uint32_t half = cell_size / 2;
		return static_cast<PointOffset>(
				((position_x(position) - half) & 0xffffu) | (position_y(position) - half) << 16);
	}
	static constexpr CellPosition position_of(PointOffset offset) {
		constexpr std::uint32_t half = cell_size / 2;
		const auto bits = static_cast<std::uint32_t>(offset);
		return ((bits + half) & cell_mask) | (((bits >> 16) + half) & cell_mask) << lattice_bits;
	}

	/// The reason why a cell is visited again.
	enum Listing : std::uint8_t {
		unlisted,
		requested, ///< The cell is in `wanted`, for a cell that it blocks.
		in_region, ///< The cell belongs to the region that is being decided.
	};

	/// A cell whose darts must be decided up to a time, and a cell whose earlier dart blocked it, or `sentinel`.
	struct Wanted {
		std::uint32_t cell;
		TimeKey until;
		std::uint32_t blocker;
	};

	static constexpr std::uint64_t all_open = ~std::uint64_t{0};

	DartSource source{};
	std::uint32_t level = 0;
	std::uint32_t levels = 1;
	RankFunction rank = nullptr;
	LevelGrid *coarser = nullptr; ///< The level whose points are placed here from the start. Null for the coarsest.

	CellRect cells;           ///< Without the border.
	std::uint32_t stride = 0; ///< Offset from one row to the next, in cells.
	CellRect thrown;          ///< Cells whose first darts are thrown. All other cells have time_unthrown.

	std::vector<TimeKey> time;          ///< Time of the cell's next dart; time_never once the cell is decided.
	std::vector<std::uint32_t> dart;    ///< The next dart; the rank once the cell has a point.
	std::vector<PointOffset> point;     ///< The accepted position, or no_point.
	std::vector<std::uint32_t> waiting; ///< The cell's slot in `waiting_squares`; 0 if it has none.
	std::vector<std::uint64_t> open;    ///< 8 x 8 sub-squares by rows, one bit each: not known to be covered.
	/// Whether all points of coarser levels near the cell are placed. Unused without a coarser level.
	std::vector<std::uint8_t> ready;

	WaitingSquares waiting_squares;
	std::uint32_t sentinel = 0; ///< An entry beyond all cells that throws no darts.

	std::vector<Listing> listed;
	std::vector<std::uint32_t> requester; ///< For a requested cell: the cell that it blocks.
	std::vector<Wanted> wanted;           ///< Cells to check in the next round.
	std::vector<Wanted> round;            ///< Cells to check in this round.
	std::vector<std::uint32_t> due;       ///< Cells to check in a pass.
	Splits splits;
	std::uint32_t undecided = nowhere; ///< The cell that depends on a dart outside the grid.
	static constexpr std::uint32_t nowhere = 0;

	std::uint64_t accepted = 0;
	std::uint64_t darts = 0;
	std::uint64_t squares = 0;

	/// Prepares the grid for `p_cells`, reusing memory. The resolver sets the contents of the arrays.
	void reset(const CellRect &p_cells);

	std::uint32_t index_of(glm::ivec2 cell) const {
		const glm::ivec2 offset = cell - cells.min + border;
		return static_cast<std::uint32_t>(offset.y) * stride + static_cast<std::uint32_t>(offset.x);
	}

	glm::ivec2 cell_of(std::uint32_t index) const {
		return cells.min - border +
				glm::ivec2(static_cast<std::int32_t>(index % stride), static_cast<std::int32_t>(index / stride));
	}

	std::size_t bytes() const;
};

} // namespace thicket
