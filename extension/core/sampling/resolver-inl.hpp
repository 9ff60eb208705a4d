// Compiled once for each instruction set, by resolver.cpp.
#if defined(THICKET_RESOLVER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_RESOLVER_INL
#undef THICKET_RESOLVER_INL
#else
#define THICKET_RESOLVER_INL
#endif

#include "core/sampling/cover-inl.hpp"
#include "core/sampling/darts-inl.hpp"
#include "core/sampling/resolver.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::uint32_t sub_square_of(CellPosition position) {
	return (position_y(position) >> sub_bits) * 8 + (position_x(position) >> sub_bits);
}

/// Bits of the sub-squares of a child square of quadtree level 1, 2 or 3 whose corner is bit 0.
constexpr std::uint64_t square_bits(std::uint32_t level) {
	return level == 1 ? 0x0f0f0f0full : level == 2 ? 0x0303ull : 1ull;
}

/// The neighbor that carries the tag of `key`, as an offset in cells.
HWY_INLINE std::uint32_t tagged_neighbor(const LevelGrid &grid, std::uint32_t cell, TimeKey own, TimeKey key) {
	static constexpr std::int8_t offset[9] = {1, 2, -2, -1, 0, 1, 2, -2, -1}; // of (difference mod 5), from -4
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

HWY_INLINE void close_cell(LevelGrid &grid, std::uint32_t cell) {
	grid.time[cell] = time_never;
	grid.open[cell] = 0;
	grid.siblings.release(grid.waiting[cell]);
}

/// Marks what a new point's disk covers, and closes the cells that are left without an open sub-square.
HWY_INLINE void stamp(LevelGrid &grid, std::uint32_t cell, CellPosition position) {
	const Neighborhood around(grid, cell, position);
	Cover cover;
	cover_of(around, cover);
	const hn::CappedTag<std::uint64_t, 4> d;
	std::uint32_t closed = 0;
	for (std::uint32_t row = 0; row < 4; ++row) {
		for (std::uint32_t lane = 0; lane < 4; lane += static_cast<std::uint32_t>(hn::MaxLanes(d))) {
			std::uint64_t *open = grid.open.data() + around.first + row * grid.stride + lane;
			const auto before = hn::LoadU(d, open);
			const auto after = hn::AndNot(hn::Load(d, cover.cells + 4 * row + lane), before);
			hn::StoreU(after, d, open);
			const auto last = hn::And(hn::Eq(after, hn::Zero(d)), hn::Ne(before, hn::Zero(d)));
			closed |= bits_of(d, last) << (4 * row + lane);
		}
	}
	for (; closed != 0; closed &= closed - 1) {
		const auto bit = static_cast<std::uint32_t>(std::countr_zero(closed));
		close_cell(grid, around.first + (bit >> 2) * grid.stride + (bit & 3));
	}
}

HWY_INLINE void place_point(LevelGrid &grid, std::uint32_t cell, CellPosition position, std::uint32_t rank) {
	close_cell(grid, cell);
	grid.point[cell] = position;
	grid.dart[cell] = rank;
	stamp(grid, cell, position);
}

/// Which of the four children of a square are not known to be covered.
HWY_INLINE std::uint32_t open_children(
		const LevelGrid &grid, std::uint32_t cell, std::uint32_t level, CellPosition origin) {
	const std::uint64_t open = grid.open[cell] >> sub_square_of(origin);
	if (level > 3) {
		return (open & 1) == 0 ? 0u : ~covered_children(grid, cell, level, origin) & 15u;
	}
	const std::uint64_t bits = square_bits(level);
	const std::uint32_t step = 8u >> level;
	const auto any = [](std::uint64_t part) {
		return part != 0 ? 1u : 0u;
	};
	return any(open & bits) | any(open >> step & bits) << 1 | any(open >> 8 * step & bits) << 2 |
			any(open >> 9 * step & bits) << 3;
}

/// Without a branch, which would be a coin toss.
HWY_INLINE void sort_pair(DartKey &a, DartKey &b) {
	const DartKey swap = (a ^ b) & (DartKey{0} - DartKey{b < a});
	a ^= swap;
	b ^= swap;
}

/// Splits the square of a rejected dart and returns the cell's next dart, or dart_never.
inline DartKey next_dart(LevelGrid &grid, std::uint32_t cell, DartKey rejected) {
	++grid.darts;
	const std::uint32_t level = dart_level(dart_place(rejected)) + 1;
	const std::uint32_t uncovered =
			level <= lattice_bits ? open_children(grid, cell, level, square_origin(dart_place(rejected))) : 0;
	if (uncovered != 0) {
		grid.squares += static_cast<std::uint64_t>(std::popcount(uncovered));
		std::array<DartKey, 4> darts;
		child_darts(rejected, darts.data());
		for (std::uint32_t child = 0; child < 4; ++child) {
			darts[child] |= DartKey{uncovered >> child & 1} - 1;
		}
		sort_pair(darts[0], darts[1]);
		sort_pair(darts[2], darts[3]);
		sort_pair(darts[0], darts[2]);
		sort_pair(darts[1], darts[3]);
		sort_pair(darts[1], darts[2]);
		if (grid.waiting[cell] == 0) {
			if (darts[1] != dart_never) {
				grid.siblings.add(grid.waiting[cell], {darts[1], darts[2], darts[3], dart_never});
			}
			return darts[0];
		}
		grid.siblings.add(grid.waiting[cell], darts);
	}
	return grid.waiting[cell] != 0 ? grid.siblings.take(grid.waiting[cell]) : dart_never;
}

/// True when a disk covers the position of the dart.
HWY_INLINE bool closed_at(const LevelGrid &grid, std::uint32_t cell, DartKey dart) {
	return (grid.open[cell] >> sub_square_of(dart_position(dart_place(dart))) & 1) == 0;
}

/// Why `settle` stopped, and at which cell.
struct Settled {
	enum Reason : std::uint8_t {
		wanted_time_reached,
		blocked,   ///< By an earlier dart of `cell`.
		not_ready, ///< Points of coarser levels are missing.
		beyond,    ///< A dart outside the grid could be in the way.
	};
	Reason reason;
	std::uint32_t cell;
};

/// Decides a cell's darts up to the time `wanted` for as long as no other cell's dart must be decided first.
HWY_INLINE Settled settle(LevelGrid &grid, std::uint32_t cell, TimeKey wanted) {
	// The dart stays in registers: a vector load over a lane that was just stored would wait for it.
	DartKey dart = make_dart(grid.time[cell], grid.dart[cell]);
	const auto stop = [&](Settled::Reason reason, std::uint32_t at) {
		grid.time[cell] = dart_time(dart);
		grid.dart[cell] = dart_place(dart);
		return Settled{reason, at};
	};
	while (dart_time(dart) <= wanted) {
		if (closed_at(grid, cell, dart)) {
			dart = next_dart(grid, cell, dart);
			continue;
		}
		if (grid.coarser != nullptr && grid.ready[cell] == 0) {
			return stop(Settled::not_ready, cell);
		}
		const Verdict verdict = look_around(grid, cell, dart_position(dart_place(dart)));
		if (verdict.conflict) {
			dart = next_dart(grid, cell, dart);
		} else if (verdict.earliest >= dart_time(dart)) {
			++grid.darts;
			++grid.accepted;
			place_point(
					grid, cell, dart_position(dart_place(dart)), grid.rank(grid.levels, grid.level, dart_time(dart)));
			return {Settled::wanted_time_reached, cell};
		} else if (verdict.earliest == time_unknown) {
			return stop(Settled::beyond, cell);
		} else {
			return stop(Settled::blocked, tagged_neighbor(grid, cell, dart_time(dart), verdict.earliest));
		}
	}
	if (dart == dart_never) {
		close_cell(grid, cell);
		return {Settled::wanted_time_reached, cell};
	}
	return stop(Settled::wanted_time_reached, cell);
}

/// Decides one cell's darts up to the time `until`: follows the chain of blocking cells, each with an earlier dart than the one
/// before. False when the chain leaves the grid.
bool resolve_cell(LevelGrid *levels, std::uint32_t level, std::uint32_t start, TimeKey until);

/// Copies the point of a decided coarse cell, if it has one, to where it stands in the finer grid.
HWY_INLINE void hand_down(const LevelGrid &coarse, glm::ivec2 cell, LevelGrid &grid) {
	const std::uint32_t source = coarse.index_of(cell);
	const CellPosition position = coarse.point[source];
	if (position == LevelGrid::no_point) {
		return;
	}
	// A coarse unit is two fine ones.
	const std::uint32_t x = 2 * position_x(position);
	const std::uint32_t y = 2 * position_y(position);
	const glm::ivec2 target = 2 * cell + glm::ivec2(x >> lattice_bits, y >> lattice_bits);
	if (!grid.cells.contains(target)) {
		return;
	}
	const std::uint32_t index = grid.index_of(target);
	if (grid.point[index] == LevelGrid::no_point) {
		place_point(grid, index, (x & cell_mask) | (y & cell_mask) << lattice_bits, coarse.dart[source]);
	}
}

/// Brings the points of the coarser levels that can reach `cell`, and its siblings in the coarse cell, into the grid.
inline bool make_ready(LevelGrid *levels, std::uint32_t level, std::uint32_t cell) {
	LevelGrid &grid = levels[level];
	LevelGrid &coarse = levels[level + 1];
	const glm::ivec2 parent = grid.cell_of(cell) >> 1;
	if (!coarse.cells.grown(-1).contains(parent)) {
		return false;
	}
	for (std::int32_t y = parent.y - 1; y <= parent.y + 1; ++y) {
		for (std::int32_t x = parent.x - 1; x <= parent.x + 1; ++x) {
			if (!resolve_cell(levels, level + 1, coarse.index_of({x, y}), time_never - 1)) {
				return false;
			}
			hand_down(coarse, {x, y}, grid);
		}
	}
	for (const glm::ivec2 part : {glm::ivec2(0, 0), glm::ivec2(1, 0), glm::ivec2(0, 1), glm::ivec2(1, 1)}) {
		if (grid.cells.contains(2 * parent + part)) {
			grid.ready[grid.index_of(2 * parent + part)] = 1;
		}
	}
	return true;
}

inline bool resolve_cell(LevelGrid *levels, std::uint32_t level, std::uint32_t start, TimeKey until) {
	LevelGrid &grid = levels[level];
	if (grid.time[start] > until) {
		return true;
	}
	auto &chain = grid.chain;
	chain.assign(1, start);
	while (!chain.empty()) {
		const std::uint32_t cell = chain.back();
		// The first cell is wanted up to `until`, each later one until it blocks the one before no more.
		TimeKey wanted = chain.size() > 1 ? grid.time[chain[chain.size() - 2]] : until;
		wanted = wanted == time_never ? time_unknown : wanted;
		const Settled settled = settle(grid, cell, wanted);
		switch (settled.reason) {
			case Settled::wanted_time_reached: chain.pop_back(); break;
			case Settled::blocked: chain.push_back(settled.cell); break;
			case Settled::not_ready:
				if (!make_ready(levels, level, cell)) {
					return false;
				}
				break;
			case Settled::beyond: return false;
		}
	}
	return true;
}

/// Times between which the passes of `resolve_region` double; by then hardly anything is left to cover.
constexpr float first_pass = 0.25f;
constexpr float last_pass = 256.0f;

/// Lists the cells of a row whose next dart is not later than `until` in grid.due.
HWY_INLINE void find_due(LevelGrid &grid, std::uint32_t first, std::uint32_t count, TimeKey until) {
	const hn::ScalableTag<std::int32_t> d;
	const hn::RebindToUnsigned<decltype(d)> du;
	const std::uint32_t lanes = static_cast<std::uint32_t>(hn::MaxLanes(d));
	grid.due.resize(count + 2 * lanes);
	std::size_t found = 0;
	for (std::uint32_t start = 0; start < count; start += lanes) {
		const auto time = hn::BitCast(d, hn::LoadU(du, grid.time.data() + first + start));
		const auto due = hn::And(hn::Lt(time, hn::Set(d, static_cast<std::int32_t>(until) + 1)),
				hn::RebindMask(d, hn::FirstN(du, std::min<std::size_t>(lanes, count - start))));
		found += hn::CompressStore(hn::Iota(du, first + start), hn::RebindMask(du, due), du, grid.due.data() + found);
	}
	grid.due.resize(found);
}

/// Decides all cells of a region of one level, the early darts of all cells first: the points that they leave cover most of
/// the rest, which then need not be looked at. The order changes no result.
inline ResolveResult resolve_region(
		LevelGrid *levels, std::uint32_t level, const CellRect &region, const std::atomic<bool> *cancel) {
	LevelGrid &grid = levels[level];
	const auto width = static_cast<std::uint32_t>(region.size().x);
	for (float until = first_pass; until <= last_pass; until *= 2.0f) {
		const TimeKey due = until < last_pass ? std::bit_cast<TimeKey>(until) : time_never - 1;
		for (std::int32_t y = region.min.y; y < region.max.y; ++y) {
			if (cancel != nullptr && cancel->load(std::memory_order_relaxed)) {
				return ResolveResult::cancelled;
			}
			find_due(grid, grid.index_of({region.min.x, y}), width, due);
			for (const std::uint32_t cell : grid.due) {
				if (!resolve_cell(levels, level, cell, due)) {
					return ResolveResult::margin_too_small;
				}
			}
		}
	}
	return ResolveResult::done;
}

inline ResolveResult resolve_block(
		std::span<LevelGrid> levels, const CellRect &block, const std::atomic<bool> *cancel) {
	for (LevelGrid &grid : levels) {
		throw_base_darts(grid);
	}
	for (std::size_t level = levels.size(); level-- > 0;) {
		CellRect region = block;
		for (std::size_t finer = 0; finer < level; ++finer) {
			region = coarse_cells_around(region);
		}
		const ResolveResult result = resolve_region(levels.data(), static_cast<std::uint32_t>(level), region, cancel);
		if (result != ResolveResult::done) {
			return result;
		}
	}
	return ResolveResult::done;
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
