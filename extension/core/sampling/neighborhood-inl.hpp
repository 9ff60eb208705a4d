// The cells that a disk can reach, all at a glance. Compiled once for each instruction set, by resolver.cpp.
#if defined(THICKET_NEIGHBORHOOD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_NEIGHBORHOOD_INL
#undef THICKET_NEIGHBORHOOD_INL
#else
#define THICKET_NEIGHBORHOOD_INL
#endif

#include "core/sampling/level_grid.hpp"

#include <hwy/highway.h>

#include <cstring>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::int32_t side = static_cast<std::int32_t>(cell_size);

/// A disk's radius is less than one and a half cells, so it reaches two cells beyond its own on the near side and one on the
/// far side of each axis: 4 x 4 cells, which fill one vector of 16 lanes or a few smaller ones, row by row.
struct Neighborhood {
	std::uint32_t first; ///< Index of the lowest cell.
	std::int32_t x;      ///< The disk's center, seen from the lowest cell's corner: 1.5 to 2.5 cells.
	std::int32_t y;

	Neighborhood(const LevelGrid &grid, std::uint32_t cell, CellPosition center) {
		const std::uint32_t left = 2 - (position_x(center) >> (lattice_bits - 1));
		const std::uint32_t below = 2 - (position_y(center) >> (lattice_bits - 1));
		first = cell - below * grid.stride - left;
		x = static_cast<std::int32_t>(position_x(center) + left * cell_size);
		y = static_cast<std::int32_t>(position_y(center) + below * cell_size);
	}
};

using BlockLanes = hn::CappedTag<std::uint32_t, 16>;
constexpr std::size_t block_lanes = hn::MaxLanes(BlockLanes());

/// Corners of the 16 cells.
alignas(64) constexpr std::uint32_t block_x[16] = {0, cell_size, 2 * cell_size, 3 * cell_size, 0, cell_size,
		2 * cell_size, 3 * cell_size, 0, cell_size, 2 * cell_size, 3 * cell_size, 0, cell_size, 2 * cell_size,
		3 * cell_size};
alignas(64) constexpr std::uint32_t block_y[16] = {0, 0, 0, 0, cell_size, cell_size, cell_size, cell_size,
		2 * cell_size, 2 * cell_size, 2 * cell_size, 2 * cell_size, 3 * cell_size, 3 * cell_size, 3 * cell_size,
		3 * cell_size};

/// Loads rows of four cells into one vector, the lowest row first.
template <class D>
HWY_INLINE hn::Vec<D> load_rows(D d, const std::uint32_t *from, std::size_t stride) {
	constexpr std::size_t lanes = hn::MaxLanes(D());
	if constexpr (lanes == 4) {
		return hn::LoadU(d, from);
	} else {
		const hn::Half<D> half;
		return hn::Combine(d, load_rows(half, from + lanes / 8 * stride, stride), load_rows(half, from, stride));
	}
}

template <class D, class M>
HWY_INLINE std::uint32_t bits_of(D d, M mask) {
	// Read back as wide as written: a wider load would wait for the store.
	using Bits = std::conditional_t<(hn::MaxLanes(D()) > 8), std::uint16_t, std::uint8_t>;
	std::uint8_t bytes[8];
	hn::StoreMaskBits(d, mask, bytes);
	Bits bits;
	std::memcpy(&bits, bytes, sizeof(bits));
	return bits;
}

/// Lanes whose squared distance, at most 2^32, is below radius^2.
template <class D, class V = hn::Vec<D>>
HWY_INLINE auto within_radius(D d, V x, V y) {
	return hn::Eq(hn::ShiftRight<2 * lattice_bits + 1>(hn::Add(hn::Mul(x, x), hn::Mul(y, y))), hn::Zero(d));
}

/// The points of some cells, seen from a disk's center.
template <class V, class M>
struct PointOffsets {
	V x;
	V y;
	M stands; ///< False where the cell has no point, and the offset no meaning.
};

/// The points of the cells from `start` on, whose lower corners lie at (corner_x, corner_y) from the center.
template <class V>
HWY_INLINE auto offsets_of_points(const LevelGrid &grid, std::size_t start, V corner_x, V corner_y) {
	const BlockLanes d;
	const auto point = load_rows(d, grid.point.data() + start, grid.stride);
	const auto stands = hn::Ne(point, hn::Set(d, LevelGrid::no_point));
	return PointOffsets<V, decltype(stands)>{hn::Add(hn::And(point, hn::Set(d, cell_mask)), corner_x),
			hn::Add(hn::ShiftRight<lattice_bits>(point), corner_y), stands};
}

/// What stands in a dart's way.
struct Verdict {
	bool conflict;    ///< An accepted point lies within the radius.
	TimeKey earliest; ///< The earliest next dart among the other cells that the dart's disk reaches.
};

/// Looks around a dart of `cell`.
HWY_INLINE Verdict look_around(const LevelGrid &grid, std::uint32_t cell, CellPosition position) {
	const BlockLanes d;
	const hn::RebindToSigned<BlockLanes> di;
	const Neighborhood around(grid, cell, position);
	const auto never = hn::Set(di, static_cast<std::int32_t>(time_never));
	const auto zero = hn::Zero(di);
	auto earliest = never;
	bool conflict = false;
	for (std::size_t lane = 0; lane < 16; lane += block_lanes) {
		const std::size_t start = around.first + lane / 4 * grid.stride;
		// From the dart to the cells' lower corners, and to their nearest lattice points.
		const auto corner_x = hn::Sub(hn::BitCast(di, hn::Load(d, block_x + lane)), hn::Set(di, around.x));
		const auto corner_y = hn::Sub(hn::BitCast(di, hn::Load(d, block_y + lane)), hn::Set(di, around.y));
		const auto last = hn::Set(di, 1 - side);
		const auto gap_x = hn::Max(hn::Max(corner_x, hn::Sub(last, corner_x)), zero);
		const auto gap_y = hn::Max(hn::Max(corner_y, hn::Sub(last, corner_y)), zero);
		const auto reached = hn::RebindMask(di, within_radius(d, hn::BitCast(d, gap_x), hn::BitCast(d, gap_y)));
		const auto own = hn::Eq(hn::Add(gap_x, gap_y), zero);
		const auto times = hn::BitCast(di, load_rows(d, grid.time.data() + start, grid.stride));
		// The cell's own entry is out of date while `settle` holds its dart.
		earliest = hn::Min(earliest, hn::IfThenElse(hn::AndNot(own, reached), times, never));
		const auto points = offsets_of_points(grid, start, hn::BitCast(d, corner_x), hn::BitCast(d, corner_y));
		conflict |= !hn::AllFalse(d, hn::And(within_radius(d, points.x, points.y), points.stands));
	}
	return {conflict, static_cast<TimeKey>(hn::GetLane(hn::MinOfLanes(di, earliest)))};
}

/// The points of the neighborhood whose squared distance to its center is below `limit`: a bit a cell.
HWY_INLINE std::uint32_t points_near(const LevelGrid &grid, const Neighborhood &around, std::uint32_t limit) {
	const BlockLanes d;
	std::uint32_t near = 0;
	for (std::size_t lane = 0; lane < 16; lane += block_lanes) {
		const auto corner_x = hn::Sub(hn::Load(d, block_x + lane), hn::Set(d, static_cast<std::uint32_t>(around.x)));
		const auto corner_y = hn::Sub(hn::Load(d, block_y + lane), hn::Set(d, static_cast<std::uint32_t>(around.y)));
		const auto points = offsets_of_points(grid, around.first + lane / 4 * grid.stride, corner_x, corner_y);
		const auto distance2 = hn::Add(hn::Mul(points.x, points.x), hn::Mul(points.y, points.y));
		near |= bits_of(d, hn::And(hn::Lt(distance2, hn::Set(d, limit)), points.stands)) << lane;
	}
	return near;
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
