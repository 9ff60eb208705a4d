// What the disk of a point covers. Compiled once for each instruction set, by resolver.cpp.
#if defined(THICKET_COVER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_COVER_INL
#undef THICKET_COVER_INL
#else
#define THICKET_COVER_INL
#endif

#include "core/sampling/neighborhood-inl.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <bit>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::int32_t sub_bits = lattice_bits - 3;

/// Distances are cut off here, where their squares still fit 31 bits and exceed radius^2.
constexpr std::int32_t far = 23171;

/// The parts, of 2^part_bits by 2^part_bits units, that the disk of a point at (px, py) covers in the rows from `first_row`
/// on, as bits of up to 32 columns. A part counts only when all its lattice points lie within the radius: the test of
/// the paper's section 3.2, by the farthest corner, for a row of squares at once.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V covered_parts(
		D di, std::int32_t first_row, std::int32_t px, std::int32_t py, int part_bits, std::int32_t columns) {
	const hn::RebindToFloat<D> df;
	const hn::RebindToUnsigned<D> du;
	const std::int32_t last = (1 << part_bits) - 1;
	const V zero = hn::Zero(di);
	const V near_edge = hn::Sub(hn::ShiftLeftSame(hn::Iota(di, first_row), part_bits), hn::Set(di, py));
	const V far_edge = hn::Add(near_edge, hn::Set(di, last));
	const V distance = hn::Min(hn::Max(hn::Abs(near_edge), hn::Abs(far_edge)), hn::Set(di, far));
	const V rest = hn::Sub(hn::Set(di, static_cast<std::int32_t>(radius_squared) - 1), hn::Mul(distance, distance));
	// The root's rounding error is below 0.01: never too wide.
	const V half = hn::ConvertTo(di, hn::Sub(hn::Sqrt(hn::ConvertTo(df, hn::Max(rest, zero))), hn::Set(df, 0.01f)));
	const V from = hn::Max(hn::ShiftRightSame(hn::Sub(hn::Set(di, px + last), half), part_bits), zero);
	const V to = hn::Min(hn::ShiftRightSame(hn::Add(hn::Set(di, px + 1), half), part_bits), hn::Set(di, columns));
	const auto some = hn::And(hn::Lt(from, to), hn::Gt(rest, hn::Set(di, -1)));
	const auto ones = hn::Set(du, 0xffffffffu);
	const auto above = hn::Shl(ones, hn::BitCast(du, hn::Min(from, hn::Set(di, 31))));
	const auto below = hn::Shr(ones, hn::BitCast(du, hn::Min(hn::Sub(hn::Set(di, 32), to), hn::Set(di, 31))));
	return hn::IfThenElseZero(some, hn::BitCast(di, hn::And(above, below)));
}

/// Turns eight rows of four bytes into four cells of eight bytes.
HWY_INLINE void rows_to_cells(const std::uint32_t *HWY_RESTRICT rows, std::uint64_t *HWY_RESTRICT r_cells) {
	const hn::FixedTag<std::uint8_t, 16> d8;
	const hn::FixedTag<std::uint32_t, 4> d32;
	const hn::FixedTag<std::uint64_t, 2> d64;
	alignas(16) static constexpr std::uint8_t turn[16] = {0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15};
	const auto order = hn::Load(d8, turn);
	const auto low = hn::BitCast(d32, hn::TableLookupBytes(hn::BitCast(d8, hn::Load(d32, rows)), order));
	const auto high = hn::BitCast(d32, hn::TableLookupBytes(hn::BitCast(d8, hn::Load(d32, rows + 4)), order));
	hn::Store(hn::BitCast(d64, hn::InterleaveLower(d32, low, high)), d64, r_cells);
	hn::Store(hn::BitCast(d64, hn::InterleaveUpper(d32, low, high)), d64, r_cells + 2);
}

/// The sub-squares that a point's disk covers in the 16 cells of its neighborhood.
struct Cover {
	alignas(64) std::uint64_t cells[16];
};

HWY_INLINE void cover_of(const Neighborhood &around, Cover &r_cover) {
	const hn::CappedTag<std::int32_t, 16> di;
	const hn::RebindToUnsigned<decltype(di)> du;
	alignas(64) std::uint32_t rows[32];
	for (std::size_t lane = 0; lane < 32; lane += hn::MaxLanes(di)) {
		const auto bits = covered_parts(di, static_cast<std::int32_t>(lane), around.x, around.y, sub_bits, 32);
		hn::Store(hn::BitCast(du, bits), du, rows + lane);
	}
	for (int row = 0; row < 4; ++row) {
		rows_to_cells(rows + 8 * row, r_cover.cells + 4 * row);
	}
}

/// Which of the four children, of quadtree level `level` > 3, of the square with corner `origin` are known to be covered: the
/// square is cut into parts, 8 x 8 where the lattice allows, and a part is covered when it lies in one disk. Slivers
/// between disks end here that would be split many times.
HWY_INLINE std::uint32_t covered_children(
		const LevelGrid &grid, std::uint32_t cell, std::uint32_t level, CellPosition origin) {
	const hn::CappedTag<std::int32_t, 8> di;
	const hn::RebindToUnsigned<decltype(di)> du;
	const std::uint32_t half = cell_size >> level;
	const int part_bits = std::max(lattice_bits - static_cast<int>(level) - 2, 0);
	const Neighborhood around(grid, cell, origin + half * (1 + cell_size));
	// A disk that reaches the square comes within its half diagonal of the center.
	const std::uint32_t reach = far + half + half / 2;
	alignas(32) std::uint32_t rows[8] = {};
	for (std::uint32_t near = points_near(grid, around, reach * reach); near != 0; near &= near - 1) {
		const auto bit = static_cast<std::uint32_t>(std::countr_zero(near));
		const CellPosition point = grid.point[around.first + (bit >> 2) * grid.stride + (bit & 3)];
		// The point, seen from the square's corner.
		const std::int32_t px = static_cast<std::int32_t>(block_x[bit] + position_x(point) + half) - around.x;
		const std::int32_t py = static_cast<std::int32_t>(block_y[bit] + position_y(point) + half) - around.y;
		for (std::size_t lane = 0; lane < 8; lane += hn::MaxLanes(di)) {
			const auto bits = covered_parts(di, static_cast<std::int32_t>(lane), px, py, part_bits, 8);
			hn::Store(hn::Or(hn::Load(du, rows + lane), hn::BitCast(du, bits)), du, rows + lane);
		}
	}
	const std::uint32_t count = half >> part_bits;
	std::uint32_t below = ~0u;
	std::uint32_t above = ~0u;
	for (std::uint32_t row = 0; row < count; ++row) {
		below &= rows[row];
		above &= rows[count + row];
	}
	const std::uint32_t left = (1u << count) - 1;
	const std::uint32_t right = left << count;
	const auto all = [](std::uint32_t bits, std::uint32_t wanted) {
		return (bits & wanted) == wanted ? 1u : 0u;
	};
	return all(below, left) | all(below, right) << 1 | all(above, left) << 2 | all(above, right) << 3;
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
