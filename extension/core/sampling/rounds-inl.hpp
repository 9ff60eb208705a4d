// Decides cells in rounds, many at a time. resolver.cpp compiles this file once for each
// instruction set.
#if defined(THICKET_ROUNDS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_ROUNDS_INL
#undef THICKET_ROUNDS_INL
#else
#define THICKET_ROUNDS_INL
#endif

#include "core/sampling/splits-inl.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Returns the index of the neighbor whose tag is in `key`. `own` has the tag of `cell`.
HWY_INLINE std::uint32_t tagged_neighbor(const LevelGrid &grid, std::uint32_t cell, TimeKey own, TimeKey key) {
	static constexpr std::int8_t offset[9] = {1, 2, -2, -1, 0, 1, 2, -2, -1}; // Indexed by the tag difference + 4.
	static constexpr std::uint8_t tag_x[32] = {
			0, 1, 2, 3, 4, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4};
	static constexpr std::uint8_t tag_y[32] = {
			0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3, 4, 4, 4, 4, 4};
	const std::uint32_t from = own & tag_bits;
	const std::uint32_t to = key & tag_bits;
	const std::int32_t dx = offset[4 + tag_x[to] - tag_x[from]];
	const std::int32_t dy = offset[4 + tag_y[to] - tag_y[from]];
	return cell + static_cast<std::uint32_t>(dy * static_cast<std::int32_t>(grid.stride) + dx);
}

/// Marks the area that a new point's disk covers. Closes the cells that have no open sub-square
/// left.
HWY_INLINE void stamp(LevelGrid &grid, std::uint32_t cell, CellPosition position) {
	const Neighborhood around(grid, cell, position);
	Cover cover;
	cover_of(around, cover);
	if constexpr (is_scalar) {
		plain::stamp(grid, around.first, cover.cells);
		return;
	}
	const hn::CappedTag<std::uint64_t, 4> d;
	const hn::Rebind<std::uint32_t, decltype(d)> d32;
	for (std::uint32_t row = 0; row < 4; ++row) {
		for (std::uint32_t lane = 0; lane < 4; lane += static_cast<std::uint32_t>(hn::MaxLanes(d))) {
			const std::uint32_t index = around.first + row * grid.stride + lane;
			std::uint64_t *open = grid.open.data() + index;
			const auto after = hn::AndNot(hn::Load(d, cover.cells + 4 * row + lane), hn::LoadU(d, open));
			hn::StoreU(after, d, open);
			// Border cells have no open sub-squares, but their time must stay unknown.
			const auto time = hn::LoadU(d32, grid.time.data() + index);
			const auto closed =
					hn::And(hn::DemoteMaskTo(d32, d, hn::Eq(after, hn::Zero(d))), hn::Ne(time, hn::Zero(d32)));
			hn::StoreU(hn::IfThenElse(closed, hn::Set(d32, time_never), time), d32, grid.time.data() + index);
		}
	}
}

HWY_INLINE void place_point(LevelGrid &grid, std::uint32_t cell, CellPosition position, std::uint32_t rank) {
	grid.point[cell] = LevelGrid::offset_of(position);
	grid.dart[cell] = rank;
	stamp(grid, cell, position);
}

/// Decides the wanted cells of a level. Returns false if the result could depend on a dart outside
/// the level's grid.
bool resolve_wanted(LevelGrid *levels, std::uint32_t level);

HWY_INLINE void want(LevelGrid &grid, std::uint32_t cell, TimeKey until) {
	if (grid.listed[cell] == LevelGrid::unlisted) {
		grid.listed[cell] = LevelGrid::requested;
		grid.wanted.push_back({cell, until, grid.sentinel});
	}
}

/// Copies the point of a decided coarse cell, if it has one, to its position in the finer grid.
HWY_INLINE void hand_down(const LevelGrid &coarse, glm::ivec2 cell, LevelGrid &grid) {
	const std::uint32_t source = coarse.index_of(cell);
	if (coarse.point[source] == LevelGrid::no_point) {
		return;
	}
	const CellPosition position = LevelGrid::position_of(coarse.point[source]);
	// One coarse unit equals two fine units.
	const std::uint32_t x = 2 * position_x(position);
	const std::uint32_t y = 2 * position_y(position);
	const glm::ivec2 target = 2 * cell + glm::ivec2(x >> lattice_bits, y >> lattice_bits);
	if (!grid.cells.contains(target)) {
		return;
	}
	const std::uint32_t index = grid.index_of(target);
	const CellPosition inside = (x & cell_mask) | (y & cell_mask) << lattice_bits;
	if (grid.point[index] == LevelGrid::no_point &&
			(grid.obstacles == nullptr || !grid.obstacles->covers(grid, index, inside))) {
		place_point(grid, index, inside, coarse.dart[source]);
	}
}

/// Copies all coarser points that can reach the cells of `region` into the grid. The coarser level
/// must be decided around these cells.
inline void make_region_ready(const LevelGrid &coarse, LevelGrid &grid, const CellRect &region) {
	const CellRect parents = coarse_cells_around(region);
	for (std::int32_t y = parents.min.y; y < parents.max.y; ++y) {
		for (std::int32_t x = parents.min.x; x < parents.max.x; ++x) {
			hand_down(coarse, {x, y}, grid);
		}
	}
	for (std::int32_t y = region.min.y; y < region.max.y; ++y) {
		std::fill_n(grid.ready.data() + grid.index_of({region.min.x, y}), region.size().x, std::uint8_t{1});
	}
}

/// Copies the coarser points that can reach the cells of `items`, or their siblings in the same
/// coarse cells, into the grid. Decides all required coarse cells together. Returns false if the
/// result could depend on a dart outside the coarse grid.
inline bool make_ready(LevelGrid *levels, std::uint32_t level, const Group &items) {
	LevelGrid &grid = levels[level];
	LevelGrid &coarse = levels[level + 1];
	glm::ivec2 parents[Group::max_count];
	std::uint32_t count = 0;
	std::uint32_t asking = LevelGrid::nowhere;
	for (std::uint32_t i = 0; i < items.count; ++i) {
		const std::uint32_t cell = cell_of(items.items[i]);
		if (grid.ready[cell] != 0) {
			// The points that can reach the cell are already copied.
			continue;
		}
		const glm::ivec2 parent = grid.cell_of(cell) >> 1;
		if (!coarse.cells.grown(-1).contains(parent)) {
			grid.undecided = cell;
			return false;
		}
		if (!coarse.thrown.grown(-1).contains(parent)) {
			throw_all(coarse);
		}
		asking = count == 0 ? cell : asking;
		parents[count++] = parent;
		for (const glm::ivec2 part : {glm::ivec2(0, 0), glm::ivec2(1, 0), glm::ivec2(0, 1), glm::ivec2(1, 1)}) {
			if (grid.cells.contains(2 * parent + part)) {
				grid.ready[grid.index_of(2 * parent + part)] = 1;
			}
		}
		for (std::int32_t y = parent.y - 1; y <= parent.y + 1; ++y) {
			for (std::int32_t x = parent.x - 1; x <= parent.x + 1; ++x) {
				if (coarse.time[coarse.index_of({x, y})] != time_never) {
					want(coarse, coarse.index_of({x, y}), time_never - 1);
				}
			}
		}
	}
	if (count != 0 && !resolve_wanted(levels, level + 1)) {
		grid.undecided = asking;
		return false;
	}
	for (std::uint32_t i = 0; i < count; ++i) {
		for (std::int32_t y = parents[i].y - 1; y <= parents[i].y + 1; ++y) {
			for (std::int32_t x = parents[i].x - 1; x <= parents[i].x + 1; ++x) {
				hand_down(coarse, {x, y}, grid);
			}
		}
	}
	return true;
}

/// Clears the mark of a requested cell. Cells of the region stay marked.
HWY_INLINE void unlist(LevelGrid &grid, std::uint32_t cell) {
	LevelGrid::Listing &listed = grid.listed[cell];
	listed = listed == LevelGrid::requested ? LevelGrid::unlisted : listed;
}

/// Adds a cell that blocks `requester` to the wanted cells, unless it is listed already.
HWY_INLINE void request(LevelGrid &grid, std::uint32_t cell, std::uint32_t requester, TimeKey until) {
	if (grid.listed[cell] == LevelGrid::unlisted) {
		grid.listed[cell] = LevelGrid::requested;
		grid.requester[cell] = requester;
		grid.wanted.push_back({cell, until, grid.sentinel});
	}
}

/// Defers a blocked cell to the next round, and requests the cell that blocks it. Returns false if
/// the blocking dart may lie outside the grid.
HWY_INLINE bool wait(LevelGrid &grid, std::uint32_t cell, TimeKey until) {
	const TimeKey time = grid.time[cell];
	TimeKey earliest = earliest_around(grid, cell, dart_position(grid.dart[cell]));
	if (HWY_UNLIKELY(earliest == time_unthrown)) {
		throw_all(grid);
		earliest = earliest_around(grid, cell, dart_position(grid.dart[cell]));
	}
	if (earliest == time_unknown) {
		grid.undecided = cell;
		return false;
	}
	const std::uint32_t blocker = tagged_neighbor(grid, cell, time, earliest);
	request(grid, blocker, cell, time);
	grid.wanted.push_back({cell, until, blocker});
	return true;
}

/// Moves the cells whose dart falls on an obstacle to `work.covered`.
HWY_NOINLINE void reject_obstructed(const LevelGrid &grid, Work &work) {
	const std::uint32_t count = work.uncovered.count;
	work.uncovered.count = 0;
	for (std::uint32_t i = 0; i < count; ++i) {
		const Item item = work.uncovered.items[i];
		const std::uint32_t cell = cell_of(item);
		const bool is_covered = grid.obstacles->covers(grid, cell, dart_position(grid.dart[cell]));
		work.covered.add_if(item, is_covered);
		work.uncovered.add_if(item, !is_covered);
	}
}

/// Decides one dart of each cell of `work`. The decisions are independent. A dart is accepted only
/// if all other cells that its disk reaches have later darts. It is rejected only because of an
/// accepted point or an obstacle. Blocked cells, and the cells that block them, are added to
/// grid.wanted. Cells whose next dart is due stay in `work`. Returns false if the result could
/// depend on a dart outside the grid.
template <bool from_list>
HWY_NOINLINE bool decide(LevelGrid *levels, std::uint32_t level, Work &work) {
	LevelGrid &grid = levels[level];
	Group accepted, blocked;
	if (HWY_UNLIKELY(grid.obstacles != nullptr)) {
		reject_obstructed(grid, work);
	}
	if (grid.coarser != nullptr && !make_ready(levels, level, work.uncovered)) {
		return false;
	}
	for (std::uint32_t i = 0; i < work.uncovered.count; ++i) {
		const Item item = work.uncovered.items[i];
		const std::uint32_t cell = cell_of(item);
		const Verdict verdict = examine_neighborhood(grid, cell, dart_position(grid.dart[cell]), grid.time[cell]);
		work.covered.add_if(item, verdict.conflict);
		accepted.add_if(item, !verdict.conflict & !verdict.blocked);
		blocked.add_if(item, !verdict.conflict & verdict.blocked);
	}
	for (std::uint32_t i = 0; i < accepted.count; ++i) {
		const std::uint32_t cell = cell_of(accepted.items[i]);
		place_point(grid, cell, dart_position(grid.dart[cell]), grid.rank(grid.levels, grid.level, grid.time[cell]));
	}
	grid.darts += accepted.count;
	grid.accepted += accepted.count;
	for (std::uint32_t i = 0; i < blocked.count; ++i) {
		const std::uint32_t cell = cell_of(blocked.items[i]);
		if (grid.time[cell] == time_never) { // A new point covers the cell.
			unlist(grid, cell);
		} else if (!wait(grid, cell, until_of(blocked.items[i]))) {
			return false;
		}
	}
	Group rejected = work.covered;
	work.covered.count = work.uncovered.count = 0;
	split_squares(grid, rejected, work);
	if (from_list) {
		for (std::uint32_t i = 0; i < accepted.count; ++i) {
			unlist(grid, cell_of(accepted.items[i]));
		}
		for (std::uint32_t i = 0; i < rejected.count; ++i) {
			if (grid.time[cell_of(rejected.items[i])] > until_of(rejected.items[i])) {
				unlist(grid, cell_of(rejected.items[i]));
			}
		}
	}
	return true;
}

/// Sorts the cells of grid.round, starting at `next`, as many as fit into `r_work`. Returns the
/// index after the last sorted cell. Decided cells are dropped. Cells whose requester has been
/// decided since then are dropped, too, because its chain is no longer needed. Cells that are still
/// blocked wait for the next round. The outcomes are unpredictable, so the loop does not branch on
/// them.
HWY_INLINE std::size_t sort_wanted(LevelGrid &grid, std::size_t next, Work &r_work) {
	LevelGrid::Wanted blocked[Group::max_count];
	std::size_t count = 0;
	const LevelGrid::Wanted *round = grid.round.data();
	const std::size_t end = std::min(grid.round.size(), next + Group::max_count);
	for (; r_work.count() < Group::max_count && next < end; ++next) {
		const LevelGrid::Wanted wanted = round[next];
		const TimeKey time = grid.time[wanted.cell];
		const LevelGrid::Listing listed = grid.listed[wanted.cell];
		const std::uint32_t requester = grid.requester[wanted.cell];
		// Converts conditions to integers, because compilers warn about | and & between booleans.
		const auto is = [](bool condition) {
			return static_cast<std::uint32_t>(condition);
		};
		const std::uint32_t is_requested = is(listed == LevelGrid::requested);
		const std::uint32_t is_orphan = is_requested & is(wanted.until != time_never - 1) &
				(is(grid.listed[requester] == LevelGrid::unlisted) | is(grid.time[requester] != wanted.until));
		const std::uint32_t is_done = is(time > wanted.until) | is_orphan;
		const std::uint32_t is_blocked = ~is_done & is(grid.time[wanted.blocker] < time);
		grid.listed[wanted.cell] = (is_done & is_requested) != 0 ? LevelGrid::unlisted : listed;
		blocked[count] = wanted;
		count += is_blocked;
		r_work.add_if(make_item(wanted.cell, wanted.until), grid.open[wanted.cell], grid.dart[wanted.cell],
				(is_done | is_blocked) == 0);
	}
	for (std::size_t i = 0; i < count; ++i) {
		grid.wanted.push_back(blocked[i]);
		request(grid, blocked[i].blocker, blocked[i].cell, grid.time[blocked[i].cell]);
	}
	return next;
}

inline bool resolve_wanted(LevelGrid *levels, std::uint32_t level) {
	LevelGrid &grid = levels[level];
	if (grid.wanted.empty()) {
		return true;
	}
	Work work;
	while (!grid.wanted.empty() || work.count() != 0) {
		std::swap(grid.wanted, grid.round);
		grid.wanted.clear();
		std::size_t next = 0;
		do {
			while (work.count() < Group::max_count && next < grid.round.size()) {
				next = sort_wanted(grid, next, work);
			}
			if (!decide<true>(levels, level, work)) {
				return false;
			}
		} while (next < grid.round.size());
	}
	// The two lists are swapped every round. With equal capacities, they reallocate only when a
	// round is larger than all earlier ones.
	grid.round.clear();
	grid.round.reserve(grid.wanted.capacity());
	grid.wanted.reserve(grid.round.capacity());
	return true;
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
