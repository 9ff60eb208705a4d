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
#include <cstdlib>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

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

/// One row of `covered_parts`, for processors without vectors.
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

/// rows_to_cells within a vector of 8 or 16 rows.
template <class D, class V>
HWY_INLINE V turn_rows(D d, V rows) {
	const hn::Repartition<std::uint8_t, D> d8;
	alignas(16) static constexpr std::uint8_t turn[16] = {0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15};
	alignas(64) static constexpr std::uint32_t pair[16] = {0, 4, 1, 5, 2, 6, 3, 7, 8, 12, 9, 13, 10, 14, 11, 15};
	const auto turned = hn::BitCast(d, hn::TableLookupBytes(hn::BitCast(d8, rows), hn::LoadDup128(d8, turn)));
	return hn::TableLookupLanes(turned, hn::SetTableIndices(d, pair));
}

/// The sub-squares that a point's disk covers in the 16 cells of its neighborhood.
struct Cover {
	alignas(64) std::uint64_t cells[16];
};

HWY_INLINE void cover_of(const Neighborhood &around, Cover &r_cover) {
	const hn::CappedTag<std::int32_t, 16> di;
	const hn::RebindToUnsigned<decltype(di)> du;
	constexpr std::size_t lanes = hn::MaxLanes(di);
	if constexpr (is_plain) {
		for (std::int32_t row = 0; row < 32; ++row) {
			const std::uint64_t bits = covered_row(row, around.x, around.y, sub_bits, 32);
			for (std::int32_t column = 0; column < 4; ++column) {
				std::uint64_t &cell = r_cover.cells[row / 8 * 4 + column];
				const std::uint64_t part = bits >> (8 * column) & 0xff;
				cell = row % 8 == 0 ? part : cell | part << (row % 8 * 8);
			}
		}
		return;
	}
	alignas(64) std::uint32_t rows[32];
	for (std::size_t lane = 0; lane < 32; lane += lanes) {
		const auto bits =
				hn::BitCast(du, covered_parts(di, static_cast<std::int32_t>(lane), around.x, around.y, sub_bits, 32));
		if constexpr (lanes >= 8) {
			hn::Store(hn::BitCast(hn::RepartitionToWide<decltype(du)>(), turn_rows(du, bits)),
					hn::RepartitionToWide<decltype(du)>(), r_cover.cells + lane / 2);
		} else {
			hn::Store(bits, du, rows + lane);
		}
	}
	if constexpr (lanes < 8) {
		for (int row = 0; row < 4; ++row) {
			rows_to_cells(rows + 8 * row, r_cover.cells + 4 * row);
		}
	}
}

/// Finds covered children of many squares of quadtree levels above 3: a square is cut into parts, 8 x 8 where the lattice
/// allows, and a part is covered when it lies in one disk. Slivers between disks end here that would be split many times.
template <std::uint32_t room>
class DeepCover {
public:
	/// `child_level` is that of the children of the square with corner `origin`.
	HWY_INLINE void add(const LevelGrid &grid, std::uint32_t cell, std::uint32_t child_level, CellPosition origin) {
		const std::uint32_t half = cell_size >> child_level;
		const Neighborhood around(grid, cell, origin + half * (1 + cell_size));
		// A disk that reaches the square comes within its half diagonal of the center.
		const std::uint32_t reach = far + half + half / 2;
		squares_[count_] = {around.first, static_cast<std::int32_t>(half) - around.x,
				static_cast<std::int32_t>(half) - around.y,
				points_near(grid, around, static_cast<std::int32_t>(reach * reach)), child_level};
		++count_;
	}

	/// Calls `found` with the index of each square and a bit for each of its children that is known to be covered.
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
			for (std::uint32_t near = square.near; near != 0; near &= near - 1) {
				const auto bit = static_cast<std::uint32_t>(std::countr_zero(near));
				const CellPosition point =
						LevelGrid::position_of(grid.point[square.first + (bit >> 2) * grid.stride + (bit & 3)]);
				// The point, seen from the square's corner.
				const std::int32_t px = static_cast<std::int32_t>((bit & 3) * cell_size + position_x(point)) + square.x;
				const std::int32_t py =
						static_cast<std::int32_t>((bit >> 2) * cell_size + position_y(point)) + square.y;
				if constexpr (is_plain) {
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
			for (std::size_t part = 0; !is_plain && part < std::size(rows); ++part) {
				hn::Store(rows[part], du, rows_ + 8 * i + part * hn::MaxLanes(di));
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
		std::uint32_t near;
		std::uint32_t child_level;
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
	Square squares_[room];
	alignas(64) std::uint32_t rows_[8 * room];
};

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
