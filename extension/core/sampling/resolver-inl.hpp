// Resolves whole blocks of cells. resolver.cpp compiles this file once for each instruction set.
#if defined(THICKET_RESOLVER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_RESOLVER_INL
#undef THICKET_RESOLVER_INL
#else
#define THICKET_RESOLVER_INL
#endif

#include "core/base/progress.hpp"
#include "core/sampling/resolver.hpp"
#include "core/sampling/rounds-inl.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Width, in cells, of the area around a region for which the coarser level is decided along with
/// the region. Most chains of darts that leave the region then find the coarser points that they
/// need. Otherwise, they would have to follow the coarser level's chains in each round.
constexpr std::int32_t coarser_margin = 4;

/// Width, in cells, of the area around a region in which the first darts are thrown at the start.
/// Chains rarely go farther. If one does, the resolver throws the first darts of all cells of the
/// grid.
constexpr std::int32_t first_dart_margin = 12;

struct Pass {
	float end; ///< The pass decides darts up to this time.
	/// Number of cells on each side of the region that are also decided, at most `coarser_margin`.
	std::int32_t margin;
};

/// The passes of `resolve_region`. The end times double while much area is uncovered, and then grow
/// faster, because each pass visits all cells. Some chain needs nearly every early dart around a
/// region. Deciding all of them row by row therefore costs less than following the chains one after
/// another.
constexpr Pass passes[] = {{0.125f, 4}, {0.25f, 4}, {0.5f, 3}, {1.0f, 2}, {2.0f, 1}, {4.0f, 1}, {8.0f, 0}, {32.0f, 0},
		{std::numeric_limits<float>::infinity(), 0}};
static_assert(std::ranges::all_of(
		passes, [](const Pass &pass) { return pass.margin <= std::min(coarser_margin, first_dart_margin); }));

/// Returns the cells of a row whose next dart is not later than `until`. The list is valid until
/// the next call.
HWY_INLINE std::span<const std::uint32_t> find_due(
		LevelGrid &grid, std::uint32_t first, std::uint32_t count, TimeKey until) {
	const hn::ScalableTag<std::int32_t> d;
	const hn::RebindToUnsigned<decltype(d)> du;
	const auto lanes = static_cast<std::uint32_t>(hn::MaxLanes(d));
	if (grid.due.size() < count + 2 * lanes) {
		grid.due.resize(count + 2 * lanes);
	}
	std::size_t found = 0;
	if constexpr (is_scalar) {
		for (std::uint32_t cell = first; cell < first + count; ++cell) {
			grid.due[found] = cell;
			found += grid.time[cell] <= until ? 1 : 0;
		}
		return {grid.due.data(), found};
	}
	for (std::uint32_t start = 0; start < count; start += lanes) {
		const auto time = hn::BitCast(d, hn::LoadU(du, grid.time.data() + first + start));
		const auto due = hn::And(hn::Lt(time, hn::Set(d, static_cast<std::int32_t>(until) + 1)),
				hn::RebindMask(d, hn::FirstN(du, std::min<std::size_t>(lanes, count - start))));
		found += hn::CompressStore(hn::Iota(du, first + start), hn::RebindMask(du, due), du, grid.due.data() + found);
	}
	return {grid.due.data(), found};
}

/// Clears the marks of the previous pass, and marks the cells that this pass always visits. All
/// other cells must be unlisted.
HWY_INLINE void list_region(LevelGrid &grid, const CellRect &before, const CellRect &region) {
	const auto mark = [&](const CellRect &cells, LevelGrid::Listing listing) {
		for (std::int32_t y = cells.min.y; y < cells.max.y; ++y) {
			std::fill_n(grid.listed.data() + grid.index_of({cells.min.x, y}), cells.size().x, listing);
		}
	};
	mark(before, LevelGrid::unlisted);
	mark(region, LevelGrid::in_region);
}

/// Decides the darts up to the time `until` in all cells of a region. Returns false if the grid is
/// too small.
inline bool resolve_pass(LevelGrid *levels, std::uint32_t level, const CellRect &region, TimeKey until,
		const std::atomic<bool> *cancel) {
	LevelGrid &grid = levels[level];
	const auto width = static_cast<std::uint32_t>(region.size().x);
	Work work;
	for (std::int32_t y = region.min.y; y < region.max.y; ++y) {
		if (is_cancelled(cancel)) {
			return true;
		}
		for (const std::uint32_t cell : find_due(grid, grid.index_of({region.min.x, y}), width, until)) {
			work.add_if(make_item(cell, until), grid.open[cell], grid.dart[cell], true);
			while (work.count() == Group::max_count) {
				if (!decide<false>(levels, level, work)) {
					return false;
				}
			}
		}
	}
	while (work.count() > 0) {
		if (!decide<false>(levels, level, work)) {
			return false;
		}
	}
	return resolve_wanted(levels, level);
}

/// Decides all cells of a region at one level, starting with the early darts of all cells. Their
/// points cover most of the remaining area, which then needs no checks. The order never affects the
/// result.
inline ResolveResult resolve_region(LevelGrid *levels, std::uint32_t level, const CellRect &region, std::int32_t ahead,
		const std::atomic<bool> *cancel) {
	LevelGrid &grid = levels[level];
	grid.listed.assign(grid.open.size(), LevelGrid::unlisted);
	grid.wanted.clear();
	if (grid.coarser != nullptr) {
		// Performs for all cells at once what make_ready() would do for each requested cell.
		make_region_ready(*grid.coarser, grid, region.grown(ahead));
	}
	CellRect listed;
	for (const Pass &pass : passes) {
		const CellRect cells = region.grown(std::min(pass.margin, ahead));
		if (cells != listed) {
			list_region(grid, listed, cells);
			listed = cells;
		}
		const TimeKey due = std::min(std::bit_cast<TimeKey>(pass.end), time_never - 1);
		if (!resolve_pass(levels, level, cells, due, cancel)) {
			return ResolveResult::margin_too_small;
		}
		if (is_cancelled(cancel)) {
			return ResolveResult::cancelled;
		}
	}
	return ResolveResult::done;
}

inline ResolveResult resolve_block(
		std::span<LevelGrid> levels, const CellRect &block, const std::atomic<bool> *cancel) {
	const std::int32_t margin = block.min.x - levels.front().cells.min.x;
	const std::int32_t ahead = std::min(
			coarser_margin, margin / 2); // Half of each margin suffices for the extra cells of all finer levels.
	for (std::size_t level = levels.size(); level-- > 0;) {
		CellRect region = block;
		for (std::size_t finer = 0; finer < level; ++finer) {
			region = coarse_cells_around(region.grown(ahead));
		}
		start_grid(levels[level], region.grown(first_dart_margin));
		const ResolveResult result =
				resolve_region(levels.data(), static_cast<std::uint32_t>(level), region, ahead, cancel);
		if (result != ResolveResult::done) {
			return result;
		}
	}
	return ResolveResult::done;
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
