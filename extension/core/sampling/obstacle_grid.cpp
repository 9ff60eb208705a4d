#include "core/sampling/obstacle_grid.hpp"

#include "core/base/floating_point.hpp"

#include <glm/common.hpp>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace thicket {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Distances are shortened by this many lattice units, so that rounding never makes a covered part
/// too large.
constexpr double slack = 0.01;

constexpr double side = cell_size;
constexpr double per_side = 1.0 / side;
constexpr double sub_side = 1 << sub_bits;

/// A range of columns: [from, to).
struct Range {
	std::int32_t from = 0;
	std::int32_t to = 0;
};

/// Return a value rounded down or up, and limited to [0, last]. They need no call of a library.
std::int32_t floor_within(double value, std::int32_t last) {
	return static_cast<std::int32_t>(std::clamp(value, 0.0, static_cast<double>(last)));
}
std::int32_t ceil_within(double value, std::int32_t last) {
	const std::int32_t below = floor_within(value, last);
	return below < last && static_cast<double>(below) < value ? below + 1 : below;
}

/// Returns the squares of a row that a disk covers as a whole. The row spans the lattice units [y, y
/// + width), relative to the same origin as the disk. There are `count` squares of this width, which
/// is a power of two.
Range covered_squares(const ObstacleGrid::Disk &disk, double y, double width, std::int32_t count) {
	const double last = width - 1.0;
	const double apart = std::max(std::abs(y - disk.center.y), std::abs(y + last - disk.center.y)) + slack;
	if (apart >= disk.radius) {
		return {};
	}
	const double half = std::sqrt(disk.radius * disk.radius - apart * apart) - slack;
	const double share = 1.0 / width; // A product with it is exact, and faster than a quotient.
	const Range range{ceil_within((disk.center.x - half) * share, count),
			floor_within((disk.center.x + half + 1.0) * share, count)};
	return range.from < range.to ? range : Range{};
}

/// Returns the cells of a row that a disk may reach.
Range reached_cells(const ObstacleGrid::Disk &disk, double y, std::int32_t count) {
	const double gap = std::max({0.0, y - disk.center.y, disk.center.y - (y + side - 1.0)}) - slack;
	const double radius = disk.radius + slack;
	if (gap >= radius) {
		return {};
	}
	const double half = (gap > 0.0 ? std::sqrt(radius * radius - gap * gap) : radius) + slack;
	return {floor_within((disk.center.x - half) * per_side, count),
			floor_within((disk.center.x + half) * per_side + 1.0, count)};
}

/// Returns a mask of the bits [from, to) of a byte.
std::uint32_t bits_between(std::int32_t from, std::int32_t to) {
	const std::int32_t first = std::clamp(from, 0, 8);
	const std::int32_t end = std::clamp(to, 0, 8);
	return first < end ? (0xffu << first & 0xffu) & (0xffu >> (8 - end)) : 0;
}

/// The sub-squares of this many cells in a row fit in a word.
constexpr std::int32_t cells_in_word = 8;

/// Up to this radius in lattice units, floats are exact enough.
constexpr double float_radius = 1e5;

/// Returns the squares that a disk covers in 8 rows of 64 squares, one bit each. The squares are
/// `width` lattice units wide. The disk is relative to the lower corner of the first square. Its
/// radius is at most float_radius, and it reaches a square. The floats never make the result too
/// large.
std::array<std::uint64_t, 8> covered_words(const ObstacleGrid::Disk &disk, double width) {
	const hn::FixedTag<float, 4> d;
	const hn::RebindToSigned<decltype(d)> di;
	const auto set = [d](double value) {
		return hn::Set(d, static_cast<float>(value));
	};
	const double rounding = slack + 1e-6 * disk.radius; // At least three times the error of the floats.
	const auto radius = set(disk.radius - rounding);
	const auto zero = hn::Zero(d);
	const auto most = set(8.0 * cells_in_word);
	alignas(16) std::int32_t from[8];
	alignas(16) std::int32_t to[8];
	for (std::size_t row = 0; row < 8; row += 4) {
		const auto low = hn::MulAdd(hn::Iota(d, static_cast<float>(row)), set(width), set(-disk.center.y));
		const auto apart = hn::Max(hn::Neg(low), hn::Add(low, set(width - 1.0)));
		const auto rest = hn::Mul(hn::Sub(radius, apart), hn::Add(radius, apart));
		const auto half = hn::Sub(hn::Sqrt(hn::Max(rest, zero)), set(rounding));
		const auto share = set(1.0 / width);
		const auto begin = hn::Min(hn::Max(hn::Mul(hn::Sub(set(disk.center.x), half), share), zero), most);
		const auto end = hn::Min(hn::Max(hn::Mul(hn::Add(set(disk.center.x + 1.0), half), share), zero), most);
		const auto below = hn::ConvertTo(di, begin);
		const auto is_part = hn::RebindMask(di, hn::Lt(hn::ConvertTo(d, below), begin));
		hn::Store(hn::IfThenElse(is_part, hn::Add(below, hn::Set(di, 1)), below), di, from + row);
		// A row that the disk does not reach covers nothing.
		hn::Store(hn::IfThenElseZero(hn::RebindMask(di, hn::Gt(rest, zero)), hn::ConvertTo(di, end)), di, to + row);
	}
	std::array<std::uint64_t, 8> words{};
	for (std::size_t row = 0; row < 8; ++row) {
		if (from[row] < to[row]) {
			words[row] = ~std::uint64_t{0} << from[row] & ~std::uint64_t{0} >> (64 - to[row]);
		}
	}
	return words;
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
	open_.assign(count, LevelGrid::all_open);
	first_.assign(count, 0);
	entries_.clear();
	cover_whole_cells(grid);
	cover_parts(grid);
}

/// Closes the cells that a single obstacle covers. Large obstacles cover many cells, so only the ends
/// of each row are visited.
void ObstacleGrid::cover_whole_cells(const LevelGrid &grid) {
	const glm::ivec2 size = grid.cells.size();
	const auto width = static_cast<std::size_t>(size.x) + 1;
	steps_.assign(width * static_cast<std::size_t>(size.y), 0);
	for (const Disk &disk : disks_) {
		const std::int32_t last = floor_within((disk.center.y + disk.radius) * per_side + 1.0, size.y);
		for (std::int32_t y = floor_within((disk.center.y - disk.radius) * per_side, size.y); y < last; ++y) {
			const Range covered = covered_squares(disk, y * side, side, size.x);
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
			open_[first + static_cast<std::uint32_t>(x)] = covering > 0 ? 0 : LevelGrid::all_open;
		}
	}
}

/// Lists the obstacles of the other cells, and closes the sub-squares that they cover.
void ObstacleGrid::cover_parts(const LevelGrid &grid) {
	const std::int32_t rows = grid.cells.size().y;
	for (std::uint32_t obstacle = 0; obstacle < disks_.size(); ++obstacle) {
		const Disk &disk = disks_[obstacle];
		const std::int32_t last = floor_within((disk.center.y + disk.radius + 1.0) * per_side + 1.0, rows);
		for (std::int32_t y = floor_within((disk.center.y - disk.radius - 1.0) * per_side, rows); y < last; ++y) {
			add_entries(grid, obstacle, y);
		}
	}
}

/// Adds an obstacle to the cells of a row that it reaches.
void ObstacleGrid::add_entries(const LevelGrid &grid, std::uint32_t obstacle, std::int32_t y) {
	const Disk &disk = disks_[obstacle];
	const std::int32_t columns = grid.cells.size().x;
	const Range reached = reached_cells(disk, y * side, columns);
	if (reached.from >= reached.to) {
		return;
	}
	const std::uint32_t first = grid.index_of(grid.cells.min + glm::ivec2(0, y));
	const auto add = [&](std::int32_t x, std::uint64_t parts) {
		const std::uint32_t cell = first + static_cast<std::uint32_t>(x);
		if (open_[cell] != 0) {
			open_[cell] &= ~parts;
			entries_.push_back({disk.center - glm::dvec2(x, y) * side, obstacle, first_[cell]});
			first_[cell] = static_cast<std::uint32_t>(entries_.size());
		}
	};
	if (reached.to - reached.from <= cells_in_word && disk.radius <= float_radius) {
		const auto rows = covered_words({disk.center - glm::dvec2(reached.from, y) * side, disk.radius}, sub_side);
		for (std::int32_t x = reached.from; x < reached.to; ++x) {
			std::uint64_t parts = 0;
			for (std::uint32_t row = 0; row < 8; ++row) {
				parts |= (rows[row] >> 8 * (x - reached.from) & 0xff) << 8 * row;
			}
			add(x, parts);
		}
		return;
	}
	const Range whole = covered_squares(disk, y * side, side, columns);
	std::array<Range, 8> covered;
	for (std::int32_t row = 0; row < 8; ++row) {
		covered[static_cast<std::size_t>(row)] =
				covered_squares(disk, y * side + row * sub_side, sub_side, 8 * columns);
	}
	for (std::int32_t x = reached.from; x < reached.to; ++x) {
		if (whole.from <= x && x < whole.to) {
			x = whole.to - 1;
			continue;
		}
		std::uint64_t parts = 0;
		for (std::uint32_t row = 0; row < 8; ++row) {
			parts |= std::uint64_t{bits_between(covered[row].from - 8 * x, covered[row].to - 8 * x)} << 8 * row;
		}
		add(x, parts);
	}
}

bool ObstacleGrid::covers(const LevelGrid &grid, std::uint32_t cell, CellPosition position) const {
	if ((open_[cell] >> sub_square_of(position) & 1) == 0) {
		return true;
	}
	if (first_[cell] == 0) {
		return false;
	}
	const glm::dvec2 inside(position_x(position), position_y(position));
	for (std::uint32_t at = first_[cell]; at != 0; at = entries_[at - 1].next) {
		const Entry &entry = entries_[at - 1];
		const glm::dvec2 apart = entry.center - inside;
		const double squared = apart.x * apart.x + apart.y * apart.y;
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
	const glm::dvec2 place(world(corner.x, position_x(position)), world(corner.y, position_y(position)));
	const Obstacle &each = obstacles_[obstacle];
	const glm::dvec2 apart = each.center - place;
	return apart.x * apart.x + apart.y * apart.y < each.radius * each.radius;
}

void ObstacleGrid::add_covered_parts(
		std::uint32_t cell, CellPosition origin, int part_bits, std::uint32_t *r_rows) const {
	const double width = 1 << part_bits;
	const glm::dvec2 corner(position_x(origin), position_y(origin));
	for (std::uint32_t at = first_[cell]; at != 0; at = entries_[at - 1].next) {
		const Disk here{entries_[at - 1].center - corner, disks_[entries_[at - 1].obstacle].radius};
		const glm::dvec2 gap = glm::max(glm::max(-here.center, here.center - 8.0 * width), 0.0);
		if (gap.x * gap.x + gap.y * gap.y >= here.radius * here.radius) {
			continue;
		}
		if (here.radius <= float_radius) {
			const auto words = covered_words(here, width);
			for (std::uint32_t row = 0; row < 8; ++row) {
				r_rows[row] |= static_cast<std::uint32_t>(words[row] & 0xff);
			}
			continue;
		}
		for (std::int32_t row = 0; row < 8; ++row) {
			const Range covered = covered_squares(here, row * width, width, 8);
			r_rows[row] |= bits_between(covered.from, covered.to);
		}
	}
}

std::size_t ObstacleGrid::bytes() const {
	return disks_.capacity() * sizeof(Disk) + open_.capacity() * sizeof(std::uint64_t) +
			first_.capacity() * sizeof(std::uint32_t) + entries_.capacity() * sizeof(Entry) +
			steps_.capacity() * sizeof(std::int32_t);
}

} // namespace thicket
