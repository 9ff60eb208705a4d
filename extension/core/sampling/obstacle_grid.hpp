#pragma once

#include "core/base/unfilled.hpp"
#include "core/sampling/level_grid.hpp"
#include "core/sampling/obstacles.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The obstacles that reach the cells of a grid of the finest level. Cells have the indices of that
/// grid. Reuses its memory.
class ObstacleGrid {
public:
	/// Distances are shortened by this many lattice units, so that rounding never makes a covered
	/// part too large.
	static constexpr double slack = 0.01;

	/// Up to this radius in lattice units, floats are exact enough.
	static constexpr double float_radius = 1e5;

	/// An obstacle in lattice units.
	struct Disk {
		glm::dvec2 center;
		double radius;
	};

	/// An entry in the list of a cell's obstacles. The list omits obstacles that do not reach the
	/// cell. It is empty if a single obstacle covers the whole cell.
	struct Entry {
		glm::dvec2 center; ///< In lattice units, relative to the corner of the cell.
		std::uint32_t obstacle;
		std::uint32_t next; ///< Index of the next entry plus 1, or 0.
	};

	/// The obstacles of each cell.
	struct Lists {
		/// The cell's sub-squares, in the order of LevelGrid::open. A bit is clear if a single
		/// obstacle covers the sub-square.
		std::vector<std::uint64_t> open;
		std::vector<std::uint32_t> first; ///< Index of each cell's first entry plus 1, or 0.
		UnfilledVector<Entry> entries;
	};

	/// Finds the obstacles of all cells of `grid`, whose lattice unit is `unit` meters. Throws
	/// std::bad_alloc.
	void set(const LevelGrid &grid, double unit, std::span<const Obstacle> obstacles);

	/// Returns the cell's open sub-squares; see Lists::open.
	std::uint64_t open(std::uint32_t cell) const { return lists_.open[cell]; }

	/// Returns true if an obstacle covers a position. The result is exact.
	bool covers(const LevelGrid &grid, std::uint32_t cell, CellPosition position) const;

	/// Calls `visit(disk)` for each obstacle of a cell. The disk is relative to the corner of the cell.
	template <class Visit>
	void for_each(std::uint32_t cell, const Visit &visit) const {
		for (std::uint32_t at = lists_.first[cell]; at != 0; at = lists_.entries[at - 1].next) {
			const Entry &entry = lists_.entries[at - 1];
			visit(Disk{entry.center, disks_[entry.obstacle].radius});
		}
	}

	std::size_t bytes() const;

private:
	bool covers_exactly(const LevelGrid &grid, std::uint32_t cell, CellPosition position, std::uint32_t obstacle) const;
	void cover_whole_cells(const LevelGrid &grid);
	void add_large(const LevelGrid &grid, std::uint32_t obstacle, std::int32_t y);

	double unit_ = 1.0;
	std::span<const Obstacle> obstacles_;
	std::vector<Disk> disks_; ///< The obstacles, relative to the grid's first cell.
	Lists lists_;
	std::vector<std::int32_t> steps_; ///< Changes, from cell to cell of a row, of the number of covering obstacles.
};

/// A range of columns: [from, to).
struct ColumnRange {
	std::int32_t from = 0;
	std::int32_t to = 0;
};

/// Returns a value rounded down and limited to [0, last], without a call of a library.
inline std::int32_t floor_within(double value, std::int32_t last) {
	return static_cast<std::int32_t>(std::clamp(value, 0.0, static_cast<double>(last)));
}

/// Returns the rows of cells that a disk may reach, of `count` rows.
inline ColumnRange reached_rows(const ObstacleGrid::Disk &disk, std::int32_t count) {
	constexpr double per_side = 1.0 / cell_size;
	return {floor_within((disk.center.y - disk.radius - 1.0) * per_side, count),
			floor_within((disk.center.y + disk.radius + 1.0) * per_side + 1.0, count)};
}

/// Returns the cells of row `row` that a disk may reach, of `count` cells.
inline ColumnRange reached_cells(const ObstacleGrid::Disk &disk, std::int32_t row, std::int32_t count) {
	constexpr double per_side = 1.0 / cell_size;
	const double y = static_cast<double>(row) * cell_size;
	const double gap = std::max({0.0, y - disk.center.y, disk.center.y - (y + cell_size - 1.0)}) - ObstacleGrid::slack;
	const double radius = disk.radius + ObstacleGrid::slack;
	if (gap >= radius) {
		return {};
	}
	const double half = (gap > 0.0 ? std::sqrt(radius * radius - gap * gap) : radius) + ObstacleGrid::slack;
	return {floor_within((disk.center.x - half) * per_side, count),
			floor_within((disk.center.x + half) * per_side + 1.0, count)};
}

/// Adds the squares that a disk covers to `r_rows`, for a radius above ObstacleGrid::float_radius. There
/// are 8 rows of 8 squares, one bit each. The squares are `width` lattice units wide.
void add_large_parts(const ObstacleGrid::Disk &disk, double width, std::uint32_t *r_rows);

} // namespace thicket
