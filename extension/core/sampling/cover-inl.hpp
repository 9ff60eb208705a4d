// Computes the area that the disk of a point covers. resolver.cpp compiles this file once for each
// instruction set.
#if defined(THICKET_COVER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_COVER_INL
#undef THICKET_COVER_INL
#else
#define THICKET_COVER_INL
#endif

#include "core/sampling/cover_table.hpp"
#include "core/sampling/neighborhood-inl.hpp"
#include "core/sampling/obstacle_parts-inl.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Distances are clamped to this value. Its square fits in 31 bits and exceeds radius^2.
constexpr std::int32_t far = 23171;

/// Returns the parts that the disk of a point at (px, py) covers. A part is 2^part_bits units wide
/// and high. Each lane contains a row, starting at `first_row`, with one bit per column, up to 32
/// columns. A part counts as covered only if all its lattice points lie within the radius. This is
/// the farthest-corner test of section 3.2 of the paper (White, Cline and Egbert, 2007), for a row
/// of squares at once.
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
	// Subtracting 0.01, which exceeds the rounding error of the root, ensures that the result is
	// never too wide.
	const V half = hn::ConvertTo(di, hn::Sub(hn::Sqrt(hn::ConvertTo(df, hn::Max(rest, zero))), hn::Set(df, 0.01f)));
	const V from = hn::Max(hn::ShiftRightSame(hn::Sub(hn::Set(di, px + last), half), part_bits), zero);
	const V to = hn::Min(hn::ShiftRightSame(hn::Add(hn::Set(di, px + 1), half), part_bits), hn::Set(di, columns));
	const auto some = hn::And(hn::Lt(from, to), hn::Gt(rest, hn::Set(di, -1)));
	const auto ones = hn::Set(du, 0xffffffffu);
	const auto above = hn::Shl(ones, hn::BitCast(du, hn::Min(from, hn::Set(di, 31))));
	const auto below = hn::Shr(ones, hn::BitCast(du, hn::Min(hn::Sub(hn::Set(di, 32), to), hn::Set(di, 31))));
	return hn::IfThenElseZero(some, hn::BitCast(di, hn::And(above, below)));
}

/// Performs `covered_parts` for one row, without vectors.
inline std::uint32_t covered_row(
		std::int32_t row, std::int32_t px, std::int32_t py, int part_bits, std::int32_t columns) {
	const hn::CappedTag<float, 1> df;
	const std::int32_t last = (1 << part_bits) - 1;
	const std::int32_t near_edge = (row << part_bits) - py;
	const std::int32_t distance = std::max(std::abs(near_edge), std::abs(near_edge + last));
	if (distance >= far) {
		return 0;
	}
	const std::int32_t rest = static_cast<std::int32_t>(radius_squared) - 1 - distance * distance;
	if (rest < 0) {
		return 0;
	}
	const float root = hn::GetLane(hn::Sqrt(hn::Set(df, static_cast<float>(rest))));
	const auto half = static_cast<std::int32_t>(root - 0.01f);
	const std::int32_t from = std::max((px + last - half) >> part_bits, 0);
	const std::int32_t to = std::min((px + 1 + half) >> part_bits, columns);
	return from < to ? ~0u << from & ~0u >> (32 - to) : 0;
}

/// For each of the 16 cells of a point's neighborhood, the sub-squares that the point's disk
/// covers, one bit each.
struct Cover {
	alignas(64) std::uint64_t cells[16];
};

using CoverBytes = hn::CappedTag<std::uint8_t, 64>;
using CoverCells = hn::RepartitionToWide<hn::RepartitionToWide<hn::RepartitionToWide<CoverBytes>>>;

/// Transposes columns of cells, lowest row first, into rows of four cells.
template <class V>
HWY_INLINE void store_by_rows(const V *columns, Cover &r_cover) {
	const CoverCells d;
	constexpr std::size_t lanes = hn::MaxLanes(d);
	if constexpr (lanes == 8) {
		alignas(64) static constexpr std::uint64_t low[8] = {0, 4, 8, 12, 1, 5, 9, 13};
		alignas(64) static constexpr std::uint64_t high[8] = {2, 6, 10, 14, 3, 7, 11, 15};
		hn::Store(hn::TwoTablesLookupLanes(d, columns[0], columns[1], hn::SetTableIndices(d, low)), d, r_cover.cells);
		hn::Store(hn::TwoTablesLookupLanes(d, columns[0], columns[1], hn::SetTableIndices(d, high)), d,
				r_cover.cells + 8);
	} else if constexpr (lanes == 4) {
		const auto left_even = hn::InterleaveLower(d, columns[0], columns[1]);
		const auto left_odd = hn::InterleaveUpper(d, columns[0], columns[1]);
		const auto right_even = hn::InterleaveLower(d, columns[2], columns[3]);
		const auto right_odd = hn::InterleaveUpper(d, columns[2], columns[3]);
		hn::Store(hn::ConcatLowerLower(d, right_even, left_even), d, r_cover.cells);
		hn::Store(hn::ConcatLowerLower(d, right_odd, left_odd), d, r_cover.cells + 4);
		hn::Store(hn::ConcatUpperUpper(d, right_even, left_even), d, r_cover.cells + 8);
		hn::Store(hn::ConcatUpperUpper(d, right_odd, left_odd), d, r_cover.cells + 12);
	} else {
		for (std::size_t half = 0; half < 2; ++half) {
			for (std::size_t pair = 0; pair < 2; ++pair) {
				const V *from = columns + 4 * half + 2 * pair;
				std::uint64_t *to = r_cover.cells + 8 * half + 2 * pair;
				hn::Store(hn::InterleaveLower(d, from[0], from[1]), d, to);
				hn::Store(hn::InterleaveUpper(d, from[0], from[1]), d, to + 4);
			}
		}
	}
}

/// Computes the covered sub-squares around a point. Many rows of sub-squares are processed at once,
/// one byte each. The function finds where the covered part of each row begins and ends, and then
/// the bits in between for each column of cells.
HWY_INLINE void cover_of(const Neighborhood &around, Cover &r_cover) {
	const CoverRows rows(around.x, around.y);
	if constexpr (is_scalar || HWY_TARGET == HWY_SSE2) {
		plain::cover_of(rows, r_cover.cells);
		return;
	} else {
		const CoverBytes d;
		const hn::CappedTag<std::uint8_t, 32> du;
		const hn::RebindToSigned<CoverBytes> di;
		const hn::RebindToSigned<decltype(du)> dh;
		constexpr std::size_t lanes = hn::MaxLanes(du);
		constexpr std::size_t at_once = hn::MaxLanes(d) / lanes; // Number of columns of cells per vector.
		alignas(16) static constexpr std::uint8_t last_bits[16] = {
				0x00, 0x80, 0xc0, 0xe0, 0xf0, 0xf8, 0xfc, 0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff};
		alignas(64) static constexpr auto column_of = [] {
			std::array<std::int8_t, 64> offsets{};
			for (std::size_t i = 0; i < 64; ++i) {
				offsets[i] = static_cast<std::int8_t>(8 * (i / lanes));
			}
			return offsets;
		}();
		const auto table = hn::LoadDup128(d, last_bits);
		const auto beyond = hn::Set(du, static_cast<std::uint8_t>(rows.beyond));
		const auto short_of = hn::Set(du, static_cast<std::uint8_t>(255 - rows.beyond));
		const auto wide = [&](auto half) {
			if constexpr (at_once == 2) {
				return hn::Combine(di, half, half);
			} else {
				return half;
			}
		};
		hn::Vec<CoverCells> columns[128 / hn::MaxLanes(d)];
		std::size_t count = 0;
		for (std::size_t row = 0; row < 32; row += lanes) {
			const auto whole = hn::LoadU(dh, rows.whole + row);
			const auto part = hn::LoadU(du, rows.part + row);
			const auto is_less = hn::RebindMask(dh, hn::Eq(hn::Max(part, beyond), beyond));
			const auto is_not_more = hn::RebindMask(dh, hn::Eq(hn::Min(part, short_of), part));
			// The number of bits, counted from a column's last bit, at or above the start and the
			// end of the covered range.
			auto from = wide(hn::Add(hn::Add(whole, hn::Set(dh, static_cast<std::int8_t>(8 - rows.column))),
					hn::VecFromMask(dh, is_less)));
			auto to = wide(hn::Sub(hn::Sub(hn::Set(dh, static_cast<std::int8_t>(7 - rows.column)), whole),
					hn::VecFromMask(dh, is_not_more)));
			from = hn::Add(from, hn::Load(di, column_of.data()));
			to = hn::Add(to, hn::Load(di, column_of.data()));
			for (std::size_t column = 0; column < 4; column += at_once) {
				const auto step = hn::Set(di, static_cast<std::int8_t>(8 * column));
				const auto last = hn::Set(di, 15);
				const auto begun = hn::TableLookupBytesOr0(table, hn::BitCast(d, hn::Min(hn::Add(from, step), last)));
				const auto ended = hn::TableLookupBytesOr0(table, hn::BitCast(d, hn::Min(hn::Add(to, step), last)));
				columns[count++] = hn::BitCast(CoverCells(), hn::AndNot(ended, begun));
			}
		}
		store_by_rows(columns, r_cover);
	}
}

/// Finds the covered children of many squares at quadtree level 3 or deeper. Each square is divided
/// into parts, 8 x 8 where the lattice allows. A part is covered if it lies within a single disk.
/// Without this test, squares in slivers between overlapping disks would be split many times.
template <std::uint32_t capacity>
class DeepCover {
public:
	/// Adds a square. `origin` is its lower corner, and `child_level` is the level of its children.
	HWY_INLINE void add(const LevelGrid &grid, std::uint32_t cell, std::uint32_t child_level, CellPosition origin) {
		const std::uint32_t half = cell_size >> child_level;
		const Neighborhood around(grid, cell, origin + half * (1 + cell_size));
		// A disk can reach the square only if the distance between their centers is less than the
		// radius plus half the square's diagonal.
		const std::uint32_t max_distance = far + half + half / 2;
		squares_[count_] = {around.first, static_cast<std::int32_t>(half) - around.x,
				static_cast<std::int32_t>(half) - around.y,
				find_nearby_points(grid, around, static_cast<std::int32_t>(max_distance * max_distance)), child_level,
				cell, origin};
		++count_;
	}

	/// Calls `found(index, covered)` for each square. `covered` has one bit for each child that is
	/// known to be covered.
	template <class Found>
	HWY_INLINE void finish(const LevelGrid &grid, const Found &found) {
		const hn::CappedTag<std::int32_t, 8> di;
		const hn::RebindToUnsigned<decltype(di)> du;
		for (std::uint32_t i = 0; i < count_; ++i) {
			const Square &square = squares_[i];
			const int part_bits = std::max(lattice_bits - static_cast<int>(square.child_level) - 2, 0);
			hn::Vec<decltype(du)> rows[8 / hn::MaxLanes(di)];
			for (auto &row : rows) {
				row = hn::Zero(du);
			}
			std::fill_n(rows_ + 8 * i, 8, 0u);
			for (std::uint32_t left = square.nearby_points; left != 0; left &= left - 1) {
				const auto bit = static_cast<std::uint32_t>(std::countr_zero(left));
				const CellPosition point =
						LevelGrid::position_of(grid.point[square.first + (bit >> 2) * grid.stride + (bit & 3)]);
				// The point's position relative to the square's corner.
				const std::int32_t px = static_cast<std::int32_t>((bit & 3) * cell_size + position_x(point)) + square.x;
				const std::int32_t py =
						static_cast<std::int32_t>((bit >> 2) * cell_size + position_y(point)) + square.y;
				if constexpr (is_scalar) {
					for (std::int32_t row = 0; row < 8; ++row) {
						rows_[8 * i + static_cast<std::uint32_t>(row)] |= covered_row(row, px, py, part_bits, 8);
					}
					continue;
				}
				for (std::size_t part = 0; part < std::size(rows); ++part) {
					const auto bits =
							covered_parts(di, static_cast<std::int32_t>(part * hn::MaxLanes(di)), px, py, part_bits, 8);
					rows[part] = hn::Or(rows[part], hn::BitCast(du, bits));
				}
			}
			for (std::size_t part = 0; !is_scalar && part < std::size(rows); ++part) {
				hn::Store(rows[part], du, rows_ + 8 * i + part * hn::MaxLanes(di));
			}
		}
		if (HWY_UNLIKELY(grid.obstacles != nullptr)) {
			for (std::uint32_t i = 0; i < count_; ++i) {
				const int part_bits = std::max(lattice_bits - static_cast<int>(squares_[i].child_level) - 2, 0);
				add_covered_parts(*grid.obstacles, squares_[i].cell, squares_[i].origin, part_bits, rows_ + 8 * i);
			}
		}
		for (std::uint32_t i = 0; i < count_; ++i) {
			found(i,
					covered(rows_ + 8 * i, std::max(lattice_bits - static_cast<int>(squares_[i].child_level) - 2, 0),
							cell_size >> squares_[i].child_level));
		}
	}

private:
	struct Square {
		std::uint32_t first;
		std::int32_t x;
		std::int32_t y;
		std::uint32_t nearby_points; ///< One bit for each of the 4 x 4 cells whose point's disk can reach the square.
		std::uint32_t child_level;
		std::uint32_t cell;
		CellPosition origin;
	};

	static HWY_INLINE std::uint32_t covered(const std::uint32_t *rows, int part_bits, std::uint32_t half) {
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

	std::uint32_t count_ = 0;
	Square squares_[capacity];
	alignas(64) std::uint32_t rows_[8 * capacity];
};

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
