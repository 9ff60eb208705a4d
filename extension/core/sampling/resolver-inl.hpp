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
#include <bit>
#include <cstdlib>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes32 = hn::CappedTag<std::uint32_t, 8>;
using SignedLanes32 = hn::RebindToSigned<Lanes32>;

constexpr std::uint32_t sub_square_of(CellPosition position) {
	return (position_y(position) >> sub_bits) * 8 + (position_x(position) >> sub_bits);
}

/// Bits of the sub-squares of a child square of quadtree level 1, 2 or 3 whose corner is bit 0.
constexpr std::uint64_t square_bits(std::uint32_t level) {
	return level == 1 ? 0x0f0f0f0full : level == 2 ? 0x0303ull : 1ull;
}

/// What stands in a dart's way.
struct Verdict {
	bool conflict;     ///< An accepted point lies within the radius.
	TimeKey earliest;  ///< The earliest next dart among the cells that the dart's disk reaches.
};

/// Looks at the 5 x 5 cells around a dart, a row at a time.
HWY_INLINE Verdict look_around(const LevelGrid &grid, std::uint32_t cell, CellPosition position) {
	const Lanes32 d;
	const SignedLanes32 di;
	const auto px = static_cast<std::int32_t>(position_x(position));
	const auto py = static_cast<std::int32_t>(position_y(position));
	const std::uint32_t first = cell - 2 * grid.stride - 2;
	const auto zero = hn::Zero(di);
	auto conflict = hn::Zero(d);
	auto earliest = hn::Set(di, static_cast<std::int32_t>(time_never));
	for (std::size_t lane = 0; lane < 8; lane += hn::MaxLanes(d)) {
		const auto column = hn::ShiftLeft<lattice_bits>(hn::Iota(di, static_cast<std::int32_t>(lane) - 2));
		const auto corner = hn::Sub(column, hn::Set(di, px));
		const auto beyond = hn::Sub(hn::Set(di, px + 1 - side), column);
		const auto gap_x = hn::Min(hn::Max(hn::Max(corner, beyond), zero), hn::Set(di, far));
		const auto gap_x2 = hn::Mul(gap_x, gap_x);
		for (std::int32_t row = -2; row <= 2; ++row) {
			const std::int32_t corner_y = row * side - py;
			const std::int32_t gap_y = std::min(std::max({corner_y, py + 1 - side - row * side, 0}), far);
			const auto reached = hn::Lt(hn::Add(gap_x2, hn::Set(di, gap_y * gap_y)), hn::Set(di, static_cast<std::int32_t>(radius_squared)));
			const std::size_t start = first + static_cast<std::uint32_t>(row + 2) * grid.stride + lane;
			const auto times = hn::BitCast(di, hn::LoadU(d, grid.time.data() + start));
			earliest = hn::Min(earliest, hn::IfThenElse(reached, times, earliest));
			const auto point = hn::LoadU(d, grid.point.data() + start);
			const auto dx = hn::Add(hn::And(point, hn::Set(d, cell_mask)), hn::BitCast(d, corner));
			const auto dy = hn::Add(hn::ShiftRight<lattice_bits>(point), hn::Set(d, static_cast<std::uint32_t>(corner_y)));
			// Exact in 32 bits for every reached cell.
			const auto distance2 = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
			// Zero where the point lies within the radius.
			const auto outside = hn::ShiftRight<2 * lattice_bits + 1>(distance2);
			const auto within = hn::Eq(outside, hn::Zero(d));
			const auto stands = hn::Ne(point, hn::Set(d, LevelGrid::no_point));
			conflict = hn::Or(conflict, hn::IfThenElseZero(hn::And(hn::And(within, stands), hn::RebindMask(d, reached)), hn::Set(d, 1)));
		}
	}
	Verdict verdict;
	verdict.conflict = !hn::AllTrue(d, hn::Eq(conflict, hn::Zero(d)));
	verdict.earliest = static_cast<TimeKey>(hn::GetLane(hn::MinOfLanes(di, earliest)));
	return verdict;
}

/// The neighbour that carries the tag of `key`, as an offset in cells.
HWY_INLINE std::uint32_t tagged_neighbour(const LevelGrid &grid, std::uint32_t cell, TimeKey own, TimeKey key) {
	static constexpr std::int8_t offset[9] = {1, 2, -2, -1, 0, 1, 2, -2, -1}; // of (difference mod 5), from -4
	static constexpr std::uint8_t tag_x[32] = {0, 1, 2, 3, 4, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4};
	static constexpr std::uint8_t tag_y[32] = {0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3, 4, 4, 4, 4, 4};
	const std::uint32_t from = own & tag_bits;
	const std::uint32_t to = key & tag_bits;
	const std::int32_t dx = offset[4 + tag_x[to] - tag_x[from]];
	const std::int32_t dy = offset[4 + tag_y[to] - tag_y[from]];
	return cell + static_cast<std::uint32_t>(dy * static_cast<std::int32_t>(grid.stride) + dx);
}

HWY_INLINE void release_waiting(LevelGrid &grid, std::uint32_t cell) {
	std::uint32_t square = grid.waiting[cell];
	if (square == 0) {
		return;
	}
	grid.waiting[cell] = 0;
	const std::uint32_t first = square;
	while (grid.pool[square].next != 0) {
		square = grid.pool[square].next;
	}
	grid.pool[square].next = grid.free_square;
	grid.free_square = first;
}

HWY_INLINE void close_cell(LevelGrid &grid, std::uint32_t cell) {
	grid.time[cell] = time_never;
	grid.open[cell] = 0;
	release_waiting(grid, cell);
}

/// Marks what a new point's disk covers, and closes the cells that are left without an open sub-square.
HWY_INLINE void stamp(LevelGrid &grid, std::uint32_t cell, CellPosition position) {
	Cover cover;
	cover_of(position, cover);
	std::uint32_t closed[25];
	std::uint32_t closed_count = 0;
	for (std::uint32_t row = 0; row < 5; ++row) {
		const std::uint32_t first = cell + (row - 2) * grid.stride - 2;
		for (std::uint32_t column = 0; column < 5; ++column) {
			const std::uint64_t before = grid.open[first + column];
			const std::uint64_t after = before & ~cover.cells[row][column];
			grid.open[first + column] = after;
			closed[closed_count] = first + column;
			closed_count += after == 0 && before != 0 ? 1 : 0;
		}
	}
	for (std::uint32_t i = 0; i < closed_count; ++i) {
		close_cell(grid, closed[i]);
	}
}

HWY_INLINE void place_point(LevelGrid &grid, std::uint32_t cell, CellPosition position, std::uint32_t rank) {
	close_cell(grid, cell);
	grid.point[cell] = position;
	grid.dart[cell] = rank;
	stamp(grid, cell, position);
}

/// Puts a square into its cell's list, which is sorted by key.
HWY_INLINE void add_waiting(LevelGrid &grid, std::uint32_t cell, std::uint64_t key) {
	std::uint32_t square = grid.free_square;
	if (square != 0) {
		grid.free_square = grid.pool[square].next;
	} else {
		square = static_cast<std::uint32_t>(grid.pool.size());
		grid.pool.emplace_back();
	}
	std::uint32_t *link = &grid.waiting[cell];
	while (*link != 0 && grid.pool[*link].key < key) {
		link = &grid.pool[*link].next;
	}
	grid.pool[square] = {key, *link};
	*link = square;
	++grid.squares;
}

/// The points among the 5 x 5 cells whose squared distance to `centre`, a place in the middle cell, is below `limit`
/// (at most 2^30): bit 8 * row + column.
HWY_INLINE std::uint64_t points_near(const LevelGrid &grid, std::uint32_t cell, CellPosition centre, std::uint32_t limit) {
	const Lanes32 d;
	const SignedLanes32 di;
	const std::uint32_t first = cell - 2 * grid.stride - 2;
	std::uint64_t near = 0;
	for (std::uint32_t row = 0; row < 5; ++row) {
		for (std::size_t lane = 0; lane < 8; lane += hn::MaxLanes(d)) {
			const auto column = hn::ShiftLeft<lattice_bits>(hn::Iota(d, static_cast<std::uint32_t>(lane) - 2));
			const auto point = hn::LoadU(d, grid.point.data() + first + row * grid.stride + lane);
			const auto dx = hn::Add(hn::And(point, hn::Set(d, cell_mask)), hn::Sub(column, hn::Set(d, position_x(centre))));
			const auto dy = hn::Add(hn::ShiftRight<lattice_bits>(point), hn::Set(d, (row - 2) * cell_size - position_y(centre)));
			const auto distance2 = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
			// One unsigned comparison in signed lanes.
			const auto within = hn::Lt(hn::BitCast(di, hn::Sub(distance2, hn::Set(d, 0x80000000u))),
					hn::Set(di, static_cast<std::int32_t>(limit - 0x80000000u)));
			const auto stands = hn::Ne(point, hn::Set(d, LevelGrid::no_point));
			std::uint8_t bits[8] = {};
			hn::StoreMaskBits(d, hn::And(hn::RebindMask(d, within), stands), bits);
			near |= std::uint64_t{bits[0]} << (8 * row + lane);
		}
	}
	// Beyond the corners and the five columns distances overflow; nothing there can be near.
	return near & 0x0e1f1f1f0eull;
}

/// Which of the four children, of quadtree level `level` > 3, of the square with corner `origin` are known to be covered: the
/// square is cut into parts, 8 x 8 where the lattice allows, and a part is covered when it lies in one disk. Slivers
/// between disks end here that would be split many times.
HWY_INLINE std::uint32_t covered_children(const LevelGrid &grid, std::uint32_t cell, std::uint32_t level, CellPosition origin) {
	const RowLanes di;
	const std::uint32_t half = cell_size >> level;
	const std::int32_t part_bits = std::max(lattice_bits - static_cast<std::int32_t>(level) - 2, 0);
	const CellPosition centre = origin + half * (1 + cell_size);
	// A disk that reaches the square comes within its half diagonal of the centre.
	const std::uint32_t reach = far + half + half / 2;
	alignas(32) std::uint32_t rows[8] = {};
	for (std::uint64_t near = points_near(grid, cell, centre, reach * reach); near != 0; near &= near - 1) {
		const auto place = static_cast<std::uint32_t>(std::countr_zero(near));
		const std::uint32_t row = place >> 3;
		const std::uint32_t column = place & 7;
		const CellPosition point = grid.point[cell + (row - 2) * grid.stride + column - 2];
		// The point, seen from the square's corner.
		const auto px = static_cast<std::int32_t>(column * cell_size + position_x(point) - position_x(origin)) - 2 * side;
		const auto py = static_cast<std::int32_t>(row * cell_size + position_y(point) - position_y(origin)) - 2 * side;
		for (std::size_t lane = 0; lane < 8; lane += hn::MaxLanes(di)) {
			const auto span = covered_parts(di, static_cast<std::int32_t>(lane), px, py, part_bits, 8);
			const auto one = hn::Set(di, 1);
			const auto bits = hn::Sub(hn::Shl(one, span.to), hn::Shl(one, span.from));
			const RowLanesUnsigned du;
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
	const auto all = [](std::uint32_t bits, std::uint32_t wanted) { return (bits & wanted) == wanted ? 1u : 0u; };
	return all(below, left) | all(below, right) << 1 | all(above, left) << 2 | all(above, right) << 3;
}

/// Which of the four children of a square are not known to be covered.
HWY_INLINE std::uint32_t open_children(const LevelGrid &grid, std::uint32_t cell, std::uint32_t level, CellPosition origin) {
	const std::uint64_t open = grid.open[cell] >> sub_square_of(origin);
	if (level > 3) {
		return (open & 1) == 0 ? 0u : ~covered_children(grid, cell, level, origin) & 15u;
	}
	const std::uint64_t bits = square_bits(level);
	const std::uint32_t step = 8u >> level;
	const auto any = [](std::uint64_t part) { return part != 0 ? 1u : 0u; };
	return any(open & bits) | any(open >> step & bits) << 1 | any(open >> 8 * step & bits) << 2 | any(open >> 9 * step & bits) << 3;
}

/// The next dart was rejected: splits its square and takes the cell's next one.
inline void advance(LevelGrid &grid, std::uint32_t cell) {
	++grid.darts;
	const std::uint32_t level_position = grid.dart[cell];
	const std::uint32_t level = dart_level(level_position) + 1;
	if (level <= lattice_bits) {
		const CellPosition origin = square_origin(level_position);
		const std::uint32_t uncovered = open_children(grid, cell, level, origin);
		if (uncovered != 0) {
			DartKey darts[4];
			child_darts(make_dart(grid.time[cell], level_position), darts);
			for (std::uint32_t child = 0; child < 4; ++child) {
				if ((uncovered >> child & 1) != 0) {
					add_waiting(grid, cell, darts[child]);
				}
			}
		}
	}
	const std::uint32_t next = grid.waiting[cell];
	if (next == 0) {
		close_cell(grid, cell);
		return;
	}
	PendingSquare &square = grid.pool[next];
	grid.time[cell] = static_cast<TimeKey>(square.key >> 32);
	grid.dart[cell] = static_cast<std::uint32_t>(square.key);
	grid.waiting[cell] = square.next;
	square.next = grid.free_square;
	grid.free_square = next;
}

/// Decides one cell's darts up to the time `until`: follows the chain of blocking cells, each with an earlier dart than the one
/// before. False when the chain leaves the grid.
bool resolve_cell(LevelGrid *levels, std::uint32_t level, std::uint32_t start, TimeKey until);

/// Brings the points of the coarser levels that can reach `cell` into the grid.
inline bool make_ready(LevelGrid *levels, std::uint32_t level, std::uint32_t cell) {
	LevelGrid &grid = levels[level];
	LevelGrid &coarse = levels[level + 1];
	const glm::ivec2 parent = grid.cell_of(cell) >> 1;
	if (!CellRect{coarse.cells.min + 1, coarse.cells.max - 1}.contains(parent)) {
		return false;
	}
	for (std::int32_t y = parent.y - 1; y <= parent.y + 1; ++y) {
		for (std::int32_t x = parent.x - 1; x <= parent.x + 1; ++x) {
			const std::uint32_t source = coarse.index_of({x, y});
			if (!resolve_cell(levels, level + 1, source, time_never - 1)) {
				return false;
			}
			const CellPosition position = coarse.point[source];
			if (position == LevelGrid::no_point) {
				continue;
			}
			const glm::ivec2 target(2 * x + static_cast<std::int32_t>(position_x(position) >> (lattice_bits - 1)),
					2 * y + static_cast<std::int32_t>(position_y(position) >> (lattice_bits - 1)));
			if (!grid.cells.contains(target)) {
				continue;
			}
			const std::uint32_t index = grid.index_of(target);
			if (grid.point[index] == LevelGrid::no_point) {
				const CellPosition doubled = (2 * position_x(position) & cell_mask) | (2 * position_y(position) & cell_mask) << lattice_bits;
				place_point(grid, index, doubled, coarse.dart[source]);
			}
		}
	}
	for (std::int32_t y = 2 * parent.y; y < 2 * parent.y + 2; ++y) {
		for (std::int32_t x = 2 * parent.x; x < 2 * parent.x + 2; ++x) {
			if (grid.cells.contains({x, y})) {
				grid.ready[grid.index_of({x, y})] = 1;
			}
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
		const TimeKey time = grid.time[cell];
		if (time == time_never) {
			chain.pop_back();
			continue;
		}
		if (chain.size() > 1) {
			const TimeKey waiter = grid.time[chain[chain.size() - 2]];
			if (time > waiter || waiter == time_never) {
				chain.pop_back();
				continue;
			}
		} else if (time > until) {
			return true;
		}
		if (grid.coarser != nullptr && grid.ready[cell] == 0) {
			if (!make_ready(levels, level, cell)) {
				return false;
			}
			continue;
		}
		const CellPosition position = dart_position(grid.dart[cell]);
		if ((grid.open[cell] >> sub_square_of(position) & 1) == 0) {
			advance(grid, cell);
			continue;
		}
		const Verdict verdict = look_around(grid, cell, position);
		if (verdict.conflict) {
			advance(grid, cell);
		} else if (verdict.earliest < time) {
			if (verdict.earliest == time_unknown) {
				return false;
			}
			chain.push_back(tagged_neighbour(grid, cell, time, verdict.earliest));
		} else {
			++grid.darts;
			++grid.accepted;
			place_point(grid, cell, position, grid.rank(grid.levels, grid.level, time));
		}
	}
	return true;
}

/// Times between which the passes of `resolve_region` double; by then hardly anything is left to cover.
constexpr float first_pass = 0.25f;
constexpr float last_pass = 256.0f;

/// Lists the cells of a row whose next dart is not later than `until` in grid.due.
HWY_INLINE void find_due(LevelGrid &grid, std::uint32_t first, std::uint32_t count, TimeKey until) {
	grid.due.clear();
	const hn::ScalableTag<std::int32_t> d;
	const hn::RebindToUnsigned<decltype(d)> du;
	for (std::uint32_t start = 0; start < count; start += hn::MaxLanes(d)) {
		const auto own = hn::BitCast(d, hn::LoadU(du, grid.time.data() + first + start));
		std::uint8_t bytes[8] = {};
		hn::StoreMaskBits(d, hn::Lt(own, hn::Set(d, static_cast<std::int32_t>(until) + 1)), bytes);
		std::uint64_t bits = 0;
		std::memcpy(&bits, bytes, sizeof(bits));
		for (; bits != 0; bits &= bits - 1) {
			const auto lane = static_cast<std::uint32_t>(std::countr_zero(bits));
			if (start + lane < count) {
				grid.due.push_back(first + start + lane);
			}
		}
	}
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

inline ResolveResult resolve_block(std::span<LevelGrid> levels, const CellRect &block, const std::atomic<bool> *cancel) {
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
