// Computes the area that obstacles cover. obstacle_grid.cpp and resolver.cpp compile this file once
// for each instruction set.
#if defined(THICKET_OBSTACLE_PARTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_OBSTACLE_PARTS_INL
#undef THICKET_OBSTACLE_PARTS_INL
#else
#define THICKET_OBSTACLE_PARTS_INL
#endif

#include "core/sampling/obstacle_grid.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Computes which squares a disk covers in 8 rows of 64 squares, one bit each. The squares are
/// `width` lattice units wide, which is a power of two. The disk is relative to the lower corner of
/// the first square. Its radius is at most ObstacleGrid::float_radius, and it reaches a square. The
/// floats never make the result too large.
HWY_INLINE void covered_words(const ObstacleGrid::Disk &disk, double width, std::uint64_t *r_words) {
	const hn::CappedTag<float, 8> d;
	const hn::RebindToSigned<decltype(d)> di;
	const auto set = [d](double value) {
		return hn::Set(d, static_cast<float>(value));
	};
	const double rounding = ObstacleGrid::slack + 1e-6 * disk.radius; // At least three times the error of the floats.
	const auto radius = set(disk.radius - rounding);
	const auto zero = hn::Zero(d);
	const auto most = set(64.0);
	const auto per_width = set(1.0 / width); // A product with it is exact.
	alignas(32) std::int32_t from[8];
	alignas(32) std::int32_t to[8];
	for (std::size_t row = 0; row < 8; row += hn::MaxLanes(d)) {
		const auto low = hn::MulAdd(hn::Iota(d, static_cast<float>(row)), set(width), set(-disk.center.y));
		const auto gap = hn::Max(hn::Neg(low), hn::Add(low, set(width - 1.0)));
		const auto rest = hn::Mul(hn::Sub(radius, gap), hn::Add(radius, gap));
		const auto half = hn::Sub(hn::Sqrt(hn::Max(rest, zero)), set(rounding));
		const auto begin = hn::Min(hn::Max(hn::Mul(hn::Sub(set(disk.center.x), half), per_width), zero), most);
		const auto end = hn::Min(hn::Max(hn::Mul(hn::Add(set(disk.center.x + 1.0), half), per_width), zero), most);
		const auto below = hn::ConvertTo(di, begin);
		const auto is_part = hn::RebindMask(di, hn::Lt(hn::ConvertTo(d, below), begin));
		hn::Store(hn::IfThenElse(is_part, hn::Add(below, hn::Set(di, 1)), below), di, from + row);
		// A row that the disk does not reach covers nothing.
		hn::Store(hn::IfThenElseZero(hn::RebindMask(di, hn::Gt(rest, zero)), hn::ConvertTo(di, end)), di, to + row);
	}
	const hn::CappedTag<std::uint64_t, 8> d64;
	const hn::Rebind<std::uint32_t, decltype(d64)> d32;
	const auto load = [&](const std::int32_t *at) {
		return hn::PromoteTo(d64, hn::BitCast(d32, hn::LoadU(hn::RebindToSigned<decltype(d32)>(), at)));
	};
	const auto ones = hn::Set(d64, ~std::uint64_t{0});
	const auto last = hn::Set(d64, std::uint64_t{63});
	for (std::size_t row = 0; row < 8; row += hn::MaxLanes(d64)) {
		const auto begin = load(from + row);
		const auto end = load(to + row);
		const auto above = hn::Shl(ones, hn::And(begin, last));
		const auto below = hn::Shr(ones, hn::And(hn::Sub(hn::Zero(d64), end), last)); // By 64 bits less than `end`.
		hn::StoreU(hn::IfThenElseZero(hn::Lt(begin, end), hn::And(above, below)), d64, r_words + row);
	}
}

/// Exchanges rows and columns of 8 x 8 bytes: byte x of word y becomes byte y of word x. `rows` has
/// one more word, which is read but not used.
HWY_INLINE void exchange_bytes(const std::uint64_t *rows, std::uint64_t *r_columns) {
	const hn::FixedTag<std::uint64_t, 2> d8;
	const hn::Repartition<std::uint8_t, decltype(d8)> d1;
	const hn::Repartition<std::uint16_t, decltype(d8)> d2;
	const hn::Repartition<std::uint32_t, decltype(d8)> d4;
	const auto pair = [&](std::size_t row) {
		return hn::BitCast(d2,
				hn::InterleaveLower(d1, hn::BitCast(d1, hn::LoadU(d8, rows + row)),
						hn::BitCast(d1, hn::LoadU(d8, rows + row + 1))));
	};
	const auto p0 = pair(0);
	const auto p1 = pair(2);
	const auto p2 = pair(4);
	const auto p3 = pair(6);
	const auto low_0 = hn::BitCast(d4, hn::InterleaveLower(d2, p0, p1));
	const auto low_1 = hn::BitCast(d4, hn::InterleaveUpper(d2, p0, p1));
	const auto high_0 = hn::BitCast(d4, hn::InterleaveLower(d2, p2, p3));
	const auto high_1 = hn::BitCast(d4, hn::InterleaveUpper(d2, p2, p3));
	hn::StoreU(hn::BitCast(d8, hn::InterleaveLower(d4, low_0, high_0)), d8, r_columns);
	hn::StoreU(hn::BitCast(d8, hn::InterleaveUpper(d4, low_0, high_0)), d8, r_columns + 2);
	hn::StoreU(hn::BitCast(d8, hn::InterleaveLower(d4, low_1, high_1)), d8, r_columns + 4);
	hn::StoreU(hn::BitCast(d8, hn::InterleaveUpper(d4, low_1, high_1)), d8, r_columns + 6);
}

/// Adds the parts of a square that a single obstacle of its cell covers to `r_rows`, 8 rows of one bit
/// per part. A part is 2^part_bits lattice units wide. `origin` is the lower corner of the square.
inline void add_covered_parts(
		const ObstacleGrid &obstacles, std::uint32_t cell, CellPosition origin, int part_bits, std::uint32_t *r_rows) {
	const double width = 1 << part_bits;
	const double x = position_x(origin);
	const double y = position_y(origin);
	obstacles.for_each(cell, [&](ObstacleGrid::Disk disk) {
		disk.center.x -= x;
		disk.center.y -= y;
		const double gap_x = std::max({-disk.center.x, disk.center.x - 8.0 * width, 0.0});
		const double gap_y = std::max({-disk.center.y, disk.center.y - 8.0 * width, 0.0});
		if (gap_x * gap_x + gap_y * gap_y >= disk.radius * disk.radius) {
			return;
		}
		if (disk.radius > ObstacleGrid::float_radius) {
			add_large_parts(disk, width, r_rows);
			return;
		}
		std::uint64_t words[8];
		covered_words(disk, width, words);
		for (std::uint32_t row = 0; row < 8; ++row) {
			r_rows[row] |= static_cast<std::uint32_t>(words[row] & 0xff);
		}
	});
}

/// Adds all obstacles of at most float_radius to the lists of the cells that they reach, and closes
/// the sub-squares that they cover. Cells that are closed already get no entries.
inline void list_obstacles(
		const LevelGrid &grid, std::span<const ObstacleGrid::Disk> disks, ObstacleGrid::Lists &r_lists) {
	constexpr std::int32_t cells_in_word = 8;
	constexpr double side = cell_size;
	const std::int32_t columns = grid.cells.size().x;
	const std::uint32_t corner = grid.index_of(grid.cells.min);
	std::uint64_t rows[9] = {};
	std::uint64_t parts[cells_in_word];
	std::size_t count = r_lists.entries.size();
	for (std::uint32_t obstacle = 0; obstacle < disks.size(); ++obstacle) {
		const ObstacleGrid::Disk &disk = disks[obstacle];
		if (disk.radius > ObstacleGrid::float_radius) {
			continue;
		}
		const ColumnRange reached_y = reached_rows(disk, grid.cells.size().y);
		for (std::int32_t y = reached_y.from; y < reached_y.to; ++y) {
			const ColumnRange reached = reached_cells(disk, y, columns);
			for (std::int32_t start = reached.from; start < reached.to; start += cells_in_word) {
				const std::int32_t end = std::min(start + cells_in_word, reached.to);
				ObstacleGrid::Disk here = disk;
				here.center.x -= start * side;
				here.center.y -= y * side;
				covered_words(here, static_cast<double>(1 << sub_bits), rows);
				exchange_bytes(rows, parts);
				if (r_lists.entries.size() < count + cells_in_word) {
					r_lists.entries.resize(2 * count + 1024);
				}
				const std::uint32_t cell =
						corner + static_cast<std::uint32_t>(y) * grid.stride + static_cast<std::uint32_t>(start);
				std::uint64_t *open = r_lists.open.data() + cell;
				std::uint32_t *first = r_lists.first.data() + cell;
				for (std::int32_t x = 0; x < end - start; ++x) {
					if (open[x] != 0) {
						open[x] &= ~parts[x];
						r_lists.entries[count] = {here.center, obstacle, first[x]};
						first[x] = static_cast<std::uint32_t>(++count);
					}
					here.center.x -= side;
				}
			}
		}
	}
	r_lists.entries.resize(count);
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
