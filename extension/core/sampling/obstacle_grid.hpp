#pragma once

#include "core/sampling/level_grid.hpp"
#include "core/sampling/obstacles.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The obstacles that reach the cells of a grid of the finest level. Cells have the indices of that
/// grid. Reuses its memory.
class ObstacleGrid {
public:
	/// An obstacle in lattice units.
	struct Disk {
		glm::dvec2 center;
		double radius;
	};

	/// Finds the obstacles of all cells of `grid`, whose lattice unit is `unit` meters. Throws
	/// std::bad_alloc.
	void set(const LevelGrid &grid, double unit, std::span<const Obstacle> obstacles);

	/// Returns the cell's sub-squares, in the order of LevelGrid::open. A bit is clear if a single
	/// obstacle covers the sub-square.
	std::uint64_t open(std::uint32_t cell) const { return open_[cell]; }

	/// Returns true if an obstacle covers a position. The result is exact.
	bool covers(const LevelGrid &grid, std::uint32_t cell, CellPosition position) const;

	/// Adds the parts of a square that a single obstacle covers to `r_rows`, 8 rows of one bit per
	/// part. A part is 2^part_bits lattice units wide. `origin` is the lower corner of the square in
	/// `cell`.
	void add_covered_parts(std::uint32_t cell, CellPosition origin, int part_bits, std::uint32_t *r_rows) const;

	std::size_t bytes() const;

private:
	/// An entry in the list of a cell's obstacles. The list omits obstacles that do not reach the
	/// cell. It is empty if a single obstacle covers the whole cell.
	struct Entry {
		glm::dvec2 center; ///< In lattice units, relative to the corner of the cell.
		std::uint32_t obstacle;
		std::uint32_t next; ///< Index of the next entry plus 1, or 0.
	};

	bool covers_exactly(const LevelGrid &grid, std::uint32_t cell, CellPosition position, std::uint32_t obstacle) const;
	void cover_whole_cells(const LevelGrid &grid);
	void cover_parts(const LevelGrid &grid);
	void add_entries(const LevelGrid &grid, std::uint32_t obstacle, std::int32_t y);

	double unit_ = 1.0;
	std::span<const Obstacle> obstacles_;
	std::vector<Disk> disks_; ///< The obstacles, relative to the grid's first cell.
	std::vector<std::uint64_t> open_;
	std::vector<std::uint32_t> first_; ///< Index of each cell's first entry plus 1, or 0.
	std::vector<Entry> entries_;
	std::vector<std::int32_t> steps_; ///< Changes, from cell to cell of a row, of the number of covering obstacles.
};

} // namespace thicket
