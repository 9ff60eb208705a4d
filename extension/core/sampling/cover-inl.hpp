// What the disk of a point covers. Compiled once for each instruction set, by resolver.cpp.
#if defined(THICKET_COVER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_COVER_INL
#undef THICKET_COVER_INL
#else
#define THICKET_COVER_INL
#endif

#include "core/sampling/level_grid.hpp"

#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::int32_t side = static_cast<std::int32_t>(cell_size);
constexpr std::int32_t sub_bits = lattice_bits - 3;
constexpr std::int32_t sub_side = side >> 3;

/// Distances are cut off here, where their squares still add up in 31 bits and exceed radius^2.
constexpr std::int32_t far = 23171;

/// The sub-squares that a point's disk covers in each of the 5 x 5 cells around it; three columns of padding.
struct Cover {
	alignas(64) std::uint64_t cells[5][8];
};

/// Turns eight rows of five bytes into five cells of eight bytes.
HWY_INLINE void rows_to_cells(const std::uint64_t *HWY_RESTRICT rows, std::uint64_t *HWY_RESTRICT r_cells) {
	const hn::FixedTag<std::uint8_t, 16> d8;
	const hn::FixedTag<std::uint16_t, 8> d16;
	const hn::FixedTag<std::uint32_t, 4> d32;
	const hn::FixedTag<std::uint64_t, 2> d64;
	const auto pair = [&](int row) {
		const auto even = hn::BitCast(d8, hn::Set(d64, rows[row]));
		const auto odd = hn::BitCast(d8, hn::Set(d64, rows[row + 1]));
		return hn::BitCast(d16, hn::InterleaveLower(d8, even, odd));
	};
	const auto rows_01 = pair(0);
	const auto rows_23 = pair(2);
	const auto rows_45 = pair(4);
	const auto rows_67 = pair(6);
	const auto low_0123 = hn::BitCast(d32, hn::InterleaveLower(d16, rows_01, rows_23));
	const auto high_0123 = hn::BitCast(d32, hn::InterleaveUpper(d16, rows_01, rows_23));
	const auto low_4567 = hn::BitCast(d32, hn::InterleaveLower(d16, rows_45, rows_67));
	const auto high_4567 = hn::BitCast(d32, hn::InterleaveUpper(d16, rows_45, rows_67));
	hn::Store(hn::BitCast(d64, hn::InterleaveLower(d32, low_0123, low_4567)), d64, r_cells);
	hn::Store(hn::BitCast(d64, hn::InterleaveUpper(d32, low_0123, low_4567)), d64, r_cells + 2);
	hn::Store(hn::BitCast(d64, hn::InterleaveLower(d32, high_0123, high_4567)), d64, r_cells + 4);
}

using RowLanes = hn::CappedTag<std::int32_t, 8>;
using RowLanesUnsigned = hn::RebindToUnsigned<RowLanes>;

/// A half-open span of parts in each of several rows.
template <class V>
struct Span {
	V from;
	V to;
};

/// The parts, of 2^part_bits by 2^part_bits units, that the disk of a point at (px, py) covers in the rows from `first_row`
/// on, cut to [0, parts). A part counts only when all its lattice points lie within the radius: the test of the paper's
/// section 3.2, by the farthest corner, for a row of squares at once.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Span<V> covered_parts(D di, std::int32_t first_row, std::int32_t px, std::int32_t py, std::int32_t part_bits, std::int32_t parts) {
	const hn::RebindToFloat<D> df;
	const std::int32_t last = (1 << part_bits) - 1;
	const V zero = hn::Zero(di);
	const V near_edge = hn::Sub(hn::ShiftLeftSame(hn::Iota(di, first_row), part_bits), hn::Set(di, py));
	const V far_edge = hn::Add(near_edge, hn::Set(di, last));
	const V distance = hn::Min(hn::Max(hn::Abs(near_edge), hn::Abs(far_edge)), hn::Set(di, far));
	const V rest = hn::Max(hn::Sub(hn::Set(di, static_cast<std::int32_t>(radius_squared) - 1), hn::Mul(distance, distance)), zero);
	// The root's rounding error is below 0.01: never too wide.
	const V root = hn::ConvertTo(di, hn::Sub(hn::Sqrt(hn::ConvertTo(df, rest)), hn::Set(df, 0.01f)));
	const V half = hn::IfThenElse(hn::Gt(rest, zero), root, hn::Set(di, -1));
	const V from = hn::Max(hn::ShiftRightSame(hn::Sub(hn::Set(di, px + last), half), part_bits), zero);
	const V to = hn::Min(hn::ShiftRightSame(hn::Add(hn::Set(di, px + 1), half), part_bits), hn::Set(di, parts));
	return {hn::Min(from, hn::Set(di, parts)), hn::Max(to, hn::Min(from, hn::Set(di, parts)))};
}

/// Fills `r_cover` for a point at `position` of the middle cell.
HWY_INLINE void cover_of(CellPosition position, Cover &r_cover) {
	const RowLanes di;
	const RowLanesUnsigned du;
	const hn::CappedTag<std::uint64_t, 8> d64;
	const hn::Rebind<std::uint32_t, decltype(d64)> half_lanes;
	// Seen from the lower corner of the 5 x 5 cells.
	const auto px = static_cast<std::int32_t>(position_x(position)) + 2 * side;
	const auto py = static_cast<std::int32_t>(position_y(position)) + 2 * side;
	for (std::int32_t row = 0; row < 5; ++row) {
		alignas(64) std::uint32_t from[8];
		alignas(64) std::uint32_t to[8];
		for (std::size_t lane = 0; lane < 8; lane += hn::MaxLanes(di)) {
			const auto span = covered_parts(di, row * 8 + static_cast<std::int32_t>(lane), px, py, sub_bits, 40);
			hn::Store(hn::BitCast(du, span.from), du, from + lane);
			hn::Store(hn::BitCast(du, span.to), du, to + lane);
		}
		alignas(64) std::uint64_t columns[8];
		for (std::size_t lane = 0; lane < 8; lane += hn::MaxLanes(d64)) {
			const auto one = hn::Set(d64, 1);
			const auto below_to = hn::Shl(one, hn::PromoteTo(d64, hn::Load(half_lanes, to + lane)));
			const auto below_from = hn::Shl(one, hn::PromoteTo(d64, hn::Load(half_lanes, from + lane)));
			hn::Store(hn::Sub(below_to, below_from), d64, columns + lane);
		}
		rows_to_cells(columns, r_cover.cells[row]);
	}
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
