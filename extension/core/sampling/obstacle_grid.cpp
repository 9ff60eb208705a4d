#include "core/sampling/obstacle_grid.hpp"

#include "core/base/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sampling/obstacle_grid.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/base/floating_point.hpp"
#include "core/sampling/obstacle_parts-inl.hpp"

#if HWY_ONCE

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace thicket {

HWY_EXPORT(list_obstacles);

namespace {

constexpr double side = cell_size;
constexpr double per_side = 1.0 / side;
constexpr double sub_side = 1 << sub_bits;

/// Returns a value rounded up and limited to [0, last], without a call of a library.
std::int32_t ceil_within(double value, std::int32_t last) {
	const std::int32_t below = floor_within(value, last);
	return below < last && static_cast<double>(below) < value ? below + 1 : below;
}

/// Returns the squares of a row that a disk covers as a whole. The row spans the lattice units [y, y
/// + width), relative to the same origin as the disk. There are `count` squares of this width, which
/// is a power of two.
ColumnRange covered_squares(const ObstacleGrid::Disk &disk, double y, double width, std::int32_t count) {
	const double last = width - 1.0;
	const double offset =
			std::max(std::abs(y - disk.center.y), std::abs(y + last - disk.center.y)) + ObstacleGrid::slack;
	if (offset >= disk.radius) {
		return {};
	}
	const double half = std::sqrt(disk.radius * disk.radius - offset * offset) - ObstacleGrid::slack;
	const double per_width = 1.0 / width; // A product with it is exact, and faster than a quotient.
	const ColumnRange range{ceil_within((disk.center.x - half) * per_width, count),
			floor_within((disk.center.x + half + 1.0) * per_width, count)};
	return range.from < range.to ? range : ColumnRange{};
}

/// Returns a mask of the bits [from, to) of a byte.
std::uint32_t bits_between(std::int32_t from, std::int32_t to) {
	const std::int32_t first = std::clamp(from, 0, 8);
	const std::int32_t end = std::clamp(to, 0, 8);
	return first < end ? (0xffu << first & 0xffu) & (0xffu >> (8 - end)) : 0;
}

} // namespace

double fill_distance(const PointSet &set, std::int32_t cells) {
	// The rectangle may begin anywhere in its first cell. One more cell covers rounding.
	return (cells + 2) * set.radius / std::numbers::sqrt2;
}

void ObstacleGrid::set(const LevelGrid &grid, double unit, std::span<const Obstacle> obstacles) {
	unit_ = unit;
	obstacles_ = obstacles;
	const glm::dvec2 corner = glm::dvec2(grid.cells.min) * side;
	disks_.clear();
	for (const Obstacle &obstacle : obstacles) {
		disks_.push_back({obstacle.center / unit - corner, obstacle.radius / unit});
	}
	const std::size_t count =
			std::size_t{grid.stride} * static_cast<std::size_t>(grid.cells.size().y + 2 * LevelGrid::border);
	lists_.open.assign(count, LevelGrid::all_open);
	lists_.first.assign(count, 0);
	lists_.entries.clear();
	cover_whole_cells(grid);
	HWY_DYNAMIC_DISPATCH(list_obstacles)(grid, disks_, lists_);
	for (std::uint32_t obstacle = 0; obstacle < disks_.size(); ++obstacle) {
		if (disks_[obstacle].radius > float_radius) {
			const ColumnRange rows = reached_rows(disks_[obstacle], grid.cells.size().y);
			for (std::int32_t y = rows.from; y < rows.to; ++y) {
				add_large(grid, obstacle, y);
			}
		}
	}
}

/// Closes the cells that a single obstacle covers. Large obstacles cover many cells, so only the ends
/// of each row are visited.
void ObstacleGrid::cover_whole_cells(const LevelGrid &grid) {
	const glm::ivec2 size = grid.cells.size();
	const auto width = static_cast<std::size_t>(size.x) + 1;
	steps_.assign(width * static_cast<std::size_t>(size.y), 0);
	for (const Disk &disk : disks_) {
		if (disk.radius < 0.7 * side) {
			continue; // The disk is smaller than a cell.
		}
		const std::int32_t last = floor_within((disk.center.y + disk.radius) * per_side + 1.0, size.y);
		for (std::int32_t y = floor_within((disk.center.y - disk.radius) * per_side, size.y); y < last; ++y) {
			const ColumnRange covered = covered_squares(disk, y * side, side, size.x);
			std::int32_t *row = steps_.data() + static_cast<std::size_t>(y) * width;
			++row[covered.from];
			--row[covered.to];
		}
	}
	for (std::int32_t y = 0; y < size.y; ++y) {
		const std::int32_t *row = steps_.data() + static_cast<std::size_t>(y) * width;
		const std::uint32_t first = grid.index_of(grid.cells.min + glm::ivec2(0, y));
		std::int32_t covering = 0;
		for (std::int32_t x = 0; x < size.x; ++x) {
			covering += row[x];
			lists_.open[first + static_cast<std::uint32_t>(x)] = covering > 0 ? 0 : LevelGrid::all_open;
		}
	}
}

/// Adds an obstacle to the cells of a row that it reaches, and closes the sub-squares that it covers.
/// Its radius may be larger than float_radius.
void ObstacleGrid::add_large(const LevelGrid &grid, std::uint32_t obstacle, std::int32_t y) {
	const Disk &disk = disks_[obstacle];
	const std::int32_t columns = grid.cells.size().x;
	const ColumnRange reached = reached_cells(disk, y, columns);
	if (reached.from >= reached.to) {
		return;
	}
	const std::uint32_t first = grid.index_of(grid.cells.min + glm::ivec2(0, y));
	const ColumnRange fully_covered = covered_squares(disk, y * side, side, columns);
	std::array<ColumnRange, 8> covered;
	for (std::int32_t row = 0; row < 8; ++row) {
		covered[static_cast<std::size_t>(row)] =
				covered_squares(disk, y * side + row * sub_side, sub_side, 8 * columns);
	}
	for (std::int32_t x = reached.from; x < reached.to; ++x) {
		if (fully_covered.from <= x && x < fully_covered.to) {
			x = fully_covered.to - 1;
			continue;
		}
		std::uint64_t parts = 0;
		for (std::uint32_t row = 0; row < 8; ++row) {
			parts |= std::uint64_t{bits_between(covered[row].from - 8 * x, covered[row].to - 8 * x)} << 8 * row;
		}
		const std::uint32_t cell = first + static_cast<std::uint32_t>(x);
		if (lists_.open[cell] != 0) {
			lists_.open[cell] &= ~parts;
			lists_.entries.push_back({disk.center - glm::dvec2(x, y) * side, obstacle, lists_.first[cell]});
			lists_.first[cell] = static_cast<std::uint32_t>(lists_.entries.size());
		}
	}
}

bool ObstacleGrid::covers(const LevelGrid &grid, std::uint32_t cell, CellPosition position) const {
	if ((lists_.open[cell] >> sub_square_of(position) & 1) == 0) {
		return true;
	}
	if (lists_.first[cell] == 0) {
		return false;
	}
	const glm::dvec2 inside(position_x(position), position_y(position));
	for (std::uint32_t at = lists_.first[cell]; at != 0; at = lists_.entries[at - 1].next) {
		const Entry &entry = lists_.entries[at - 1];
		const glm::dvec2 offset = entry.center - inside;
		const double squared = offset.x * offset.x + offset.y * offset.y;
		const double radius = disks_[entry.obstacle].radius;
		if (squared < (radius - slack) * (radius - slack) && radius > slack) {
			return true;
		}
		if (squared <= (radius + slack) * (radius + slack) && covers_exactly(grid, cell, position, entry.obstacle)) {
			return true;
		}
	}
	return false;
}

/// Compares the distance to an obstacle with the same expressions as for the distances between
/// instances of layers, so that both agree on every bit.
bool ObstacleGrid::covers_exactly(
		const LevelGrid &grid, std::uint32_t cell, CellPosition position, std::uint32_t obstacle) const {
	const glm::ivec2 corner = grid.cell_of(cell);
	const auto world = [this](std::int32_t first, std::uint32_t inside) {
		return static_cast<double>(std::int64_t{first} * cell_size + inside) * unit_;
	};
	const glm::dvec2 world_position(world(corner.x, position_x(position)), world(corner.y, position_y(position)));
	const Obstacle &each = obstacles_[obstacle];
	const glm::dvec2 offset = each.center - world_position;
	return offset.x * offset.x + offset.y * offset.y < each.radius * each.radius;
}

void add_large_parts(const ObstacleGrid::Disk &disk, double width, std::uint32_t *r_rows) {
	for (std::int32_t row = 0; row < 8; ++row) {
		const ColumnRange covered = covered_squares(disk, row * width, width, 8);
		r_rows[row] |= bits_between(covered.from, covered.to);
	}
}

std::size_t ObstacleGrid::bytes() const {
	return disks_.capacity() * sizeof(Disk) + lists_.open.capacity() * sizeof(std::uint64_t) +
			lists_.first.capacity() * sizeof(std::uint32_t) + lists_.entries.capacity() * sizeof(Entry) +
			steps_.capacity() * sizeof(std::int32_t);
}

} // namespace thicket
#endif
