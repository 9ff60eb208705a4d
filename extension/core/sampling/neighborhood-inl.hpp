// Reads, in a single step, all cells that a disk can reach. resolver.cpp compiles this file once
// for each instruction set.
#if defined(THICKET_NEIGHBORHOOD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_NEIGHBORHOOD_INL
#undef THICKET_NEIGHBORHOOD_INL
#else
#define THICKET_NEIGHBORHOOD_INL
#endif

#include "core/sampling/darts-inl.hpp"
#include "core/sampling/level_grid.hpp"
#include "core/sampling/plain_steps.hpp"
#include "core/sampling/reach_table.hpp"

#include <hwy/highway.h>

#include <array>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::int32_t side = static_cast<std::int32_t>(cell_size);

/// The 4 x 4 cells that a disk can reach. The radius is less than one and a half cells. On each
/// axis, the disk therefore reaches up to two cells beyond its own on the nearer side, and one cell
/// on the farther side. In row order, these cells fill one vector of 16 lanes or a few narrower
/// ones.
struct Neighborhood {
	std::uint32_t first; ///< Index of the cell at the lower corner.
	std::int32_t x;      ///< The disk's center, relative to the lower corner: 1.5 to 2.5 cells, in lattice units.
	std::int32_t y;

	Neighborhood(const LevelGrid &grid, std::uint32_t cell, CellPosition center) {
		const std::uint32_t left = 2 - (position_x(center) >> (lattice_bits - 1));
		const std::uint32_t below = 2 - (position_y(center) >> (lattice_bits - 1));
		first = cell - below * grid.stride - left;
		x = static_cast<std::int32_t>(position_x(center) + left * cell_size);
		y = static_cast<std::int32_t>(position_y(center) + below * cell_size);
	}
};

using BlockLanes = hn::CappedTag<std::int32_t, 16>;
/// Lanes for both coordinates: x in the even lanes, y in the odd ones.
using HalfLanes = hn::Repartition<std::int16_t, BlockLanes>;
using BlockWords = hn::Vec<BlockLanes>;
using BlockHalves = hn::Vec<HalfLanes>;
using BlockMask = hn::Mask<BlockLanes>;
constexpr std::size_t block_lanes = hn::MaxLanes(BlockLanes());
constexpr std::int32_t radius2 = static_cast<std::int32_t>(radius_squared);

/// Centers of the 16 cells, relative to the lower corner of the neighborhood: x in the low half, y
/// in the high half.
alignas(64) constexpr auto block_centers = [] {
	std::array<std::uint32_t, 16> centers{};
	for (std::uint32_t cell = 0; cell < 16; ++cell) {
		centers[cell] = ((cell & 3) * cell_size + cell_size / 2) | ((cell >> 2) * cell_size + cell_size / 2) << 16;
	}
	return centers;
}();

/// Loads rows of four cells into one vector, the lowest row first.
template <class D, class T>
HWY_INLINE hn::Vec<D> load_rows(D d, const T *from, std::size_t stride) {
	constexpr std::size_t lanes = hn::MaxLanes(D());
	if constexpr (lanes == 4) {
		return hn::LoadU(d, from);
	} else {
		const hn::Half<D> half;
		return hn::Combine(d, load_rows(half, from + lanes / 8 * stride, stride), load_rows(half, from, stride));
	}
}

/// Returns the centers of the cells from `lane` onward, relative to the disk's center. Nearly all
/// offsets fit in 16 bits. An offset that does not fit wraps around to the opposite side, at the
/// same distance.
HWY_INLINE BlockHalves centers_from(const Neighborhood &around, std::size_t lane) {
	const BlockLanes d;
	const HalfLanes d16;
	const auto centers = hn::Load(hn::RebindToUnsigned<BlockLanes>(), block_centers.data() + lane);
	const auto disk = hn::Set(d, around.x | around.y << 16);
	return hn::Sub(hn::BitCast(d16, centers), hn::BitCast(d16, disk));
}

HWY_INLINE BlockWords squared_length(BlockHalves offset) {
	return hn::WidenMulPairwiseAdd(BlockLanes(), offset, offset);
}

/// Returns the cells, other than the dart's own, that the dart's disk reaches. Only targets with
/// vectors of 16 lanes use this function, because there it is faster than the table behind
/// `reached_cells`.
HWY_INLINE BlockMask all_reached_cells(BlockHalves centers) {
	const BlockLanes d;
	const HalfLanes d16;
	constexpr std::int16_t half = cell_size / 2;
	const auto gap = hn::Max(
			hn::Max(hn::SaturatedSub(centers, hn::Set(d16, half)), hn::SaturatedSub(hn::Set(d16, 1 - half), centers)),
			hn::Zero(d16));
	const auto distance2 = squared_length(gap);
	return hn::And(hn::Lt(distance2, hn::Set(d, radius2)), hn::Gt(distance2, hn::Zero(d)));
}

/// Returns the squared distances from the disk's center to the points of the cells, saturated to
/// the lane width. The value is meaningless for a cell without a point.
HWY_INLINE BlockWords distances_to(BlockWords points, BlockHalves centers) {
	const HalfLanes d16;
	const auto offset = hn::SaturatedAdd(hn::BitCast(d16, points), centers);
	return squared_length(hn::Max(offset, hn::Set(d16, -32767)));
}

/// Checks the cells and points that the disk of a dart of `cell` can reach.
HWY_INLINE Verdict examine_neighborhood(
		const LevelGrid &grid, std::uint32_t cell, CellPosition position, TimeKey time) {
	const BlockLanes d;
	const Neighborhood around(grid, cell, position);
	if constexpr (is_scalar) {
		return plain::examine_neighborhood(grid, around.first, position, around.x, around.y, time);
	}
	bool conflict = false;
	bool blocked = false;
	for (std::size_t lane = 0; lane < 16; lane += block_lanes) {
		const std::size_t start = around.first + lane / 4 * grid.stride;
		const BlockHalves centers = centers_from(around, lane);
		const auto times =
				hn::BitCast(d, load_rows(hn::RebindToUnsigned<BlockLanes>(), grid.time.data() + start, grid.stride));
		const auto before = hn::Lt(times, hn::Set(d, static_cast<std::int32_t>(time)));
		if constexpr (block_lanes == 16) {
			blocked = !hn::AllFalse(d, hn::And(before, all_reached_cells(centers)));
		} else {
			blocked |= (bits_of(d, before) & reached_cells(position) >> lane) != 0;
		}
		const auto points = load_rows(d, grid.point.data() + start, grid.stride);
		const auto near = hn::Lt(distances_to(points, centers), hn::Set(d, radius2));
		conflict |= !hn::AllFalse(d, hn::And(near, hn::Ne(points, hn::Set(d, LevelGrid::no_point))));
	}
	return {conflict, blocked};
}

/// Returns the earliest time of the next darts of the cells that the disk of a dart of `cell`
/// reaches.
HWY_INLINE TimeKey earliest_around(const LevelGrid &grid, std::uint32_t cell, CellPosition position) {
	const BlockLanes d;
	const Neighborhood around(grid, cell, position);
	const auto never = hn::Set(d, static_cast<std::int32_t>(time_never));
	auto earliest = never;
	for (std::size_t lane = 0; lane < 16; lane += block_lanes) {
		const std::size_t start = around.first + lane / 4 * grid.stride;
		const auto times =
				hn::BitCast(d, load_rows(hn::RebindToUnsigned<BlockLanes>(), grid.time.data() + start, grid.stride));
		BlockMask reached;
		if constexpr (block_lanes == 16) {
			reached = all_reached_cells(centers_from(around, lane));
		} else {
			reached = mask_of(d, reached_cells(position) >> lane);
		}
		earliest = hn::Min(earliest, hn::IfThenElse(reached, times, never));
	}
	return static_cast<TimeKey>(hn::GetLane(hn::MinOfLanes(d, earliest)));
}

/// Returns the points whose squared distance to the disk's center is below `limit`, one bit per
/// cell.
HWY_INLINE std::uint32_t find_nearby_points(const LevelGrid &grid, const Neighborhood &around, std::int32_t limit) {
	const BlockLanes d;
	std::uint32_t nearby = 0;
	for (std::size_t lane = 0; lane < 16; lane += block_lanes) {
		const auto points = load_rows(d, grid.point.data() + around.first + lane / 4 * grid.stride, grid.stride);
		const auto distance2 = distances_to(points, centers_from(around, lane));
		nearby |=
				bits_of(d,
						hn::And(hn::Lt(distance2, hn::Set(d, limit)), hn::Ne(points, hn::Set(d, LevelGrid::no_point))))
				<< lane;
	}
	return nearby;
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
