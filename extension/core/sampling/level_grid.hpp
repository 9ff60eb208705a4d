#pragma once

#include "core/sampling/waiting_squares.hpp"
#include "core/sampling/work.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// A half-open rectangle of cells: [min, max).
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

/// Returns the cells of the next coarser level whose points can be within that level's radius of
/// `cells`.
constexpr CellRect coarse_cells_around(const CellRect &cells) {
	return {(cells.min >> 1) - 1, ((cells.max - 1) >> 1) + 2};
}

class ObstacleGrid;

/// Maps an accepted dart to its rank in the progressive order.
using RankFunction = std::uint32_t (*)(std::uint32_t levels, std::uint32_t level, TimeKey time);

/// The state of the process in a rectangle of cells at one level of the progressive order. Cells
/// are stored in row order, surrounded by `border` cells whose time is unknown. If a chain of
/// dependent darts needs a border cell, the block must be resolved again in a larger grid.
struct LevelGrid {
	static constexpr std::int32_t border = 2; ///< The number of cells by which a disk can extend beyond its own cell.

	/// A point's offset from the center of its cell: x in the low 16 bits, y in the high 16 bits,
	/// both signed.
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

	/// The reason why the resolver visits a cell again.
	enum Listing : std::uint8_t {
		unlisted,
		requested, ///< The cell is in `wanted`, because its dart blocks a dart of another cell.
		in_region, ///< The cell belongs to the region that is being decided.
	};

	/// A cell whose darts must be decided up to a time. `blocker` is the cell whose earlier dart
	/// blocked it, or `sentinel`.
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
	/// The grid of the next coarser level, whose points are also points of this level. Null for the
	/// coarsest level.
	LevelGrid *coarser = nullptr;
	const ObstacleGrid *obstacles = nullptr; ///< Null for coarser levels, and for a set without obstacles.

	CellRect cells;           ///< The cells without the border.
	std::uint32_t stride = 0; ///< Offset from one row to the next, in cells.
	CellRect thrown;          ///< Cells whose first dart has been thrown. All other cells have time_unthrown.

	std::vector<TimeKey> time;          ///< Time of the cell's next dart, or time_never if the cell is decided.
	std::vector<std::uint32_t> dart;    ///< The next dart, or the rank if the cell has a point.
	std::vector<PointOffset> point;     ///< The accepted position, or no_point.
	std::vector<std::uint32_t> waiting; ///< The cell's slot in `waiting_squares`, or 0 if it has none.
	std::vector<std::uint64_t> open;    ///< 8 x 8 sub-squares in row order. A set bit means not known to be covered.
	/// True if all points of coarser levels near the cell have been copied. Unused if there is no
	/// coarser level.
	std::vector<std::uint8_t> ready;

	WaitingSquares waiting_squares;
	std::uint32_t sentinel = 0; ///< Index of an extra entry, beyond all cells, that throws no darts.

	std::vector<Listing> listed;
	/// 8 x 8 sub-squares in row order. A set bit means that the sub-square is not known to be
	/// covered.
	std::vector<std::uint32_t> requester;
	std::vector<Wanted> wanted;     ///< Cells to check in the next round.
	std::vector<Wanted> round;      ///< Cells to check in this round.
	std::vector<std::uint32_t> due; ///< Cells of a row to check in a pass.
	Splits splits;
	std::uint32_t undecided = nowhere; ///< The cell that depends on a dart outside the grid, or `nowhere`.
	static constexpr std::uint32_t nowhere = 0;

	std::uint64_t accepted = 0;
	std::uint64_t darts = 0;
	std::uint64_t squares = 0;

	/// Resizes the grid for `p_cells` and reuses its memory. The resolver initializes most arrays.
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
