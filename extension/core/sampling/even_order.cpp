#include "core/sampling/even_order.hpp"

#include "core/sampling/dart.hpp"
#include "core/sampling/rank.hpp"

#include <algorithm>
#include <cstdint>

namespace thicket {

namespace {

/// The squared radius of the next coarser level, which no clearance exceeds, in lattice units of a level.
constexpr std::uint32_t widest_squared = 4 * radius_squared;

/// Returns the cells of a level that contain `block`, given in cells of the finest level.
CellRect cells_of_level(const CellRect &block, std::uint32_t level) {
	return {block.min >> static_cast<std::int32_t>(level), ((block.max - 1) >> static_cast<std::int32_t>(level)) + 1};
}

std::uint64_t squared_distance(glm::ivec2 a, glm::ivec2 b) {
	const glm::i64vec2 offset = b - a;
	return static_cast<std::uint64_t>(offset.x * offset.x + offset.y * offset.y);
}

} // namespace

void EvenOrder::Area::reset(const CellRect &p_cells) {
	cells = p_cells;
	points.clear();
	point_at.assign(static_cast<std::size_t>(cells.size().x) * static_cast<std::size_t>(cells.size().y), none);
}

std::size_t EvenOrder::Area::index_of(glm::ivec2 cell) const {
	const glm::ivec2 offset = cell - cells.min;
	return static_cast<std::size_t>(offset.y) * static_cast<std::size_t>(cells.size().x) +
			static_cast<std::size_t>(offset.x);
}

void EvenOrder::collect(std::span<const LevelGrid> levels, std::uint32_t level, const CellRect &block) {
	own_.reset(cells_of_level(block, level).grown(margin));
	coarser_.reset(cells_of_level(own_.cells, 1).grown(2));
	const auto add = [&](const LevelGrid &grid, Area &r_area, std::int32_t scale, auto &&wanted) {
		for (std::int32_t y = r_area.cells.min.y; y < r_area.cells.max.y; ++y) {
			for (std::int32_t x = r_area.cells.min.x; x < r_area.cells.max.x; ++x) {
				const std::uint32_t index = grid.index_of({x, y});
				if (grid.point[index] == LevelGrid::no_point || !wanted(grid.dart[index])) {
					continue;
				}
				const CellPosition position = LevelGrid::position_of(grid.point[index]);
				const glm::ivec2 within(position_x(position), position_y(position));
				r_area.point_at[r_area.index_of({x, y})] = static_cast<std::int32_t>(r_area.points.size());
				const glm::ivec2 cell = (glm::ivec2(x, y) << scale) - own_.cells.min;
				r_area.points.push_back(cell * static_cast<std::int32_t>(cell_size) + (within << scale));
			}
		}
	};
	const auto count = static_cast<std::uint32_t>(levels.size());
	add(levels[level], own_, 0, [&](std::uint32_t rank) { return level_of_rank(count, rank) == level; });
	add(levels[level + 1], coarser_, 1, [](std::uint32_t) { return true; });
	clearance_.clear();
	for (std::int32_t y = own_.cells.min.y; y < own_.cells.max.y; ++y) {
		for (std::int32_t x = own_.cells.min.x; x < own_.cells.max.x; ++x) {
			if (const std::int32_t number = own_.point_at[own_.index_of({x, y})]; number != Area::none) {
				clearance_.push_back(clearance_of({x, y}, own_.points[static_cast<std::size_t>(number)]));
			}
		}
	}
}

/// Returns the squared clearance of a point of `own_`.
std::uint32_t EvenOrder::clearance_of(glm::ivec2 cell, glm::ivec2 point) const {
	constexpr std::int32_t reach = 2; // The radius of a level is less than two of its cells.
	const glm::ivec2 parent = cell >> 1;
	std::uint64_t least = widest_squared;
	for (std::int32_t y = parent.y - reach; y <= parent.y + reach; ++y) {
		const std::int32_t *row = coarser_.point_at.data() + coarser_.index_of({parent.x - reach, y});
		for (std::int32_t column = 0; column <= 2 * reach; ++column) {
			if (row[column] != Area::none) {
				least = std::min(
						least, squared_distance(point, coarser_.points[static_cast<std::size_t>(row[column])]));
			}
		}
	}
	return static_cast<std::uint32_t>(least);
}

/// Returns the squared spacing of a point of `own_`.
std::uint32_t EvenOrder::spacing_of(glm::ivec2 cell, std::int32_t number) const {
	const std::uint32_t clearance = clearance_[static_cast<std::size_t>(number)];
	const glm::ivec2 point = own_.points[static_cast<std::size_t>(number)];
	const std::int32_t reach = clearance <= 4 * cell_size * cell_size ? 2 : margin;
	std::uint64_t least = clearance;
	for (std::int32_t y = cell.y - reach; y <= cell.y + reach; ++y) {
		const std::int32_t *row = own_.point_at.data() + own_.index_of({cell.x - reach, y});
		for (std::int32_t column = 0; column <= 2 * reach; ++column) {
			const std::int32_t other = row[column];
			if (other == Area::none) {
				continue;
			}
			// Points are numbered row by row, which breaks ties equally in all windows.
			const std::uint32_t its = clearance_[static_cast<std::size_t>(other)];
			if (its > clearance || (its == clearance && other < number)) {
				least = std::min(least, squared_distance(point, own_.points[static_cast<std::size_t>(other)]));
			}
		}
	}
	return static_cast<std::uint32_t>(least);
}

void EvenOrder::visit(std::span<const LevelGrid> levels, const CellRect &block, const Visit &visitor) {
	for (std::uint32_t level = 0; level + 1 < levels.size(); ++level) {
		collect(levels, level, block);
		const CellRect cells = cells_of_level(block, level);
		const std::int32_t to_cell = lattice_bits - static_cast<std::int32_t>(level);
		for (std::int32_t y = cells.min.y; y < cells.max.y; ++y) {
			for (std::int32_t x = cells.min.x; x < cells.max.x; ++x) {
				const std::int32_t number = own_.point_at[own_.index_of({x, y})];
				if (number == Area::none) {
					continue;
				}
				const glm::ivec2 cell = (own_.cells.min << static_cast<std::int32_t>(level)) +
						(own_.points[static_cast<std::size_t>(number)] >> to_cell);
				if (block.contains(cell)) {
					visitor(cell, level, spacing_of({x, y}, number));
				}
			}
		}
	}
}

} // namespace thicket
