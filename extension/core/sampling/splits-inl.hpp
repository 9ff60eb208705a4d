// Splits the squares of rejected darts. resolver.cpp compiles this file once for each instruction
// set.
#if defined(THICKET_SPLITS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_SPLITS_INL
#undef THICKET_SPLITS_INL
#else
#define THICKET_SPLITS_INL
#endif

#include "core/sampling/children-inl.hpp"
#include "core/sampling/cover-inl.hpp"
#include "core/sampling/waiting-inl.hpp"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <bit>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Loads a vector value by value. This is faster than a gather, which narrow vectors only emulate.
template <class Value>
HWY_INLINE hn::Vec<SplitLanes> load_each(SplitLanes d, const Value &value) {
	if constexpr (hn::MaxLanes(d) == 2) {
		return hn::Dup128VecFromValues(d, value(0), value(1));
	}
	alignas(64) std::uint64_t values[hn::MaxLanes(d)];
	for (std::size_t lane = 0; lane < hn::MaxLanes(d); ++lane) {
		values[lane] = value(lane);
	}
	return hn::Load(d, values);
}

/// Sorts rejected cells by the open children of their squares. Squares with open children go to
/// `r_splits`, or to `r_deep` if they need another check. Cells whose square has no open child go
/// to `r_spent`. Cells that a new point closed are dropped.
HWY_INLINE void sort_by_children(
		const Columns &columns, std::uint32_t sentinel, Group &cells, Splits &r_splits, Group &r_deep, Group &r_spent) {
	const SplitLanes d;
	std::uint32_t splits = 0;
	std::fill_n(cells.items + cells.count, hn::MaxLanes(d), make_item(sentinel, 0));
	for (std::uint32_t i = 0; i < cells.count; i += static_cast<std::uint32_t>(hn::MaxLanes(d))) {
		const auto items = hn::Load(d, cells.items + i);
		const auto parent = load_each(d, [&](std::size_t lane) {
			const std::uint32_t cell = cell_of(cells.items[i + lane]);
			return make_dart(columns.time[cell], columns.dart[cell]);
		});
		const auto level_position = hn::And(parent, hn::Set(d, 0xffffffff));
		const auto time = hn::ShiftRight<32>(parent);
		const auto parts = load_each(d, [&](std::size_t lane) { return columns.open[cell_of(cells.items[i + lane])]; });
		const auto open = open_children(level_position, parts);
		const auto none = hn::Eq(open, hn::Zero(d));
		const auto is_deep = hn::Gt(level_position, hn::Set(d, (3u << (2 * lattice_bits)) - 1));
		const auto split = hn::Not(hn::Or(none, is_deep));
		hn::CompressStore(items, split, d, r_splits.items + splits);
		hn::CompressStore(parent, split, d, r_splits.parent + splits);
		splits += static_cast<std::uint32_t>(hn::CompressStore(open, split, d, r_splits.open_children + splits));
		r_deep.count += static_cast<std::uint32_t>(
				hn::CompressStore(items, hn::AndNot(none, is_deep), d, r_deep.items + r_deep.count));
		// Drops cells that a new point closed.
		const auto spent = hn::And(none, hn::Ne(time, hn::Set(d, time_never)));
		r_spent.count += static_cast<std::uint32_t>(hn::CompressStore(items, spent, d, r_spent.items + r_spent.count));
	}
	r_splits.count = splits;
}

/// Finds the children that are not known to be covered, for the squares of rejected darts. Cells
/// whose square has no such child go to `r_spent`.
HWY_INLINE void find_open_children(LevelGrid &grid, Group &cells, Splits &r_splits, Group &r_spent) {
	const Columns columns(grid);
	DeepCover<Group::capacity> deep_cover;
	Group deep;
	for (std::uint32_t i = 0; i < cells.count; ++i) {
		hwy::Prefetch(columns.slots + (columns.waiting[cell_of(cells.items[i])] & WaitingSquares::slot_mask));
	}
	if constexpr (is_scalar || HWY_TARGET == HWY_SSE2) {
		plain::sort_by_children(grid, cells, r_splits, deep, r_spent);
	} else {
		sort_by_children(columns, grid.sentinel, cells, r_splits, deep, r_spent);
	}
	std::uint32_t splits = r_splits.count;
	for (std::uint32_t i = 0; i < deep.count; ++i) {
		const std::uint32_t cell = cell_of(deep.items[i]);
		const std::uint32_t level_position = columns.dart[cell];
		deep_cover.add(grid, cell, dart_level(level_position) + 1, square_origin(level_position));
	}
	deep_cover.finish(grid, [&](std::uint32_t i, std::uint32_t covered) {
		const Item item = deep.items[i];
		r_splits.items[splits] = item;
		r_splits.parent[splits] = make_dart(columns.time[cell_of(item)], columns.dart[cell_of(item)]);
		r_splits.open_children[splits] = covered ^ 15;
		splits += covered != 15;
		r_spent.add_if(item, covered == 15);
	});
	r_splits.count = splits;
}

/// Splits the squares of the cells' rejected darts and sets the next dart of each cell, if there is
/// one. Replaces `r_work` with the cells whose next dart is also due.
HWY_INLINE void split_squares(LevelGrid &grid, Group &cells, Work &r_work) {
	Splits &splits = grid.splits;
	Group spent;
	grid.waiting_squares.reserve(2 * cells.count);
	find_open_children(grid, cells, splits, spent);
	if constexpr (is_scalar) {
		plain::throw_child_darts(splits);
	} else {
		throw_child_darts(splits);
	}
	const Columns columns(grid);
	Work next;
	std::uint32_t first_ones[Group::capacity];
	std::uint32_t others[Group::capacity];
	std::uint32_t count_of_first = 0;
	std::uint32_t count_of_others = 0;
	for (std::uint32_t i = 0; i < splits.count; ++i) {
		const bool is_first = columns.waiting[cell_of(splits.items[i])] == 0;
		first_ones[count_of_first] = i;
		count_of_first += is_first;
		others[count_of_others] = i;
		count_of_others += !is_first;
	}
	for (std::uint32_t i = 0; i < count_of_first; ++i) {
		const std::uint32_t split = first_ones[i];
		advance_first(grid, columns, splits.items[split], Children::of(splits, split), next);
	}
	for (std::uint32_t i = 0; i < count_of_others; ++i) {
		const std::uint32_t split = others[i];
		advance<true>(grid, columns, splits.items[split], Children::of(splits, split), next);
	}
	for (std::uint32_t i = 0; i < spent.count; ++i) {
		advance<false>(grid, columns, spent.items[i], {}, next);
	}
	r_work = next;
	grid.darts += cells.count;
	grid.squares += splits.first[splits.count];
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
