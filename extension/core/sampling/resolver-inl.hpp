// Compiled once for each instruction set, by resolver.cpp.
#if defined(THICKET_RESOLVER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_RESOLVER_INL
#undef THICKET_RESOLVER_INL
#else
#define THICKET_RESOLVER_INL
#endif

#include "core/sampling/resolver.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes32 = hn::CappedTag<std::uint32_t, 8>;
using SignedLanes32 = hn::RebindToSigned<Lanes32>;

constexpr std::int32_t side = static_cast<std::int32_t>(cell_size);
constexpr std::int32_t sub_bits = lattice_bits - 3;
constexpr std::int32_t sub_side = side >> 3;

/// Distances are cut off here, where their squares still add up in 31 bits and exceed radius^2.
constexpr std::int32_t far = 23171;

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

/// Half the width of the disk, floored, at `distance` units from its centre: all x with |x| <= half_width have
/// x^2 + distance^2 < radius^2. Negative beyond the disk.
HWY_INLINE std::int32_t half_width(std::int32_t distance) {
	const std::int32_t rest = static_cast<std::int32_t>(radius_squared) - 1 - distance * distance;
	if (distance >= far || rest < 0) {
		return -1;
	}
	// One less than rounded: never too wide.
	return static_cast<std::int32_t>(std::sqrt(static_cast<float>(rest))) - 1;
}

/// Marks what a new point's disk covers, and closes the cells that are left without an open sub-square.
HWY_INLINE void stamp(LevelGrid &grid, std::uint32_t cell, CellPosition position) {
	const auto px = static_cast<std::int32_t>(position_x(position));
	const auto py = static_cast<std::int32_t>(position_y(position));
	for (std::int32_t row = -2; row <= 2; ++row) {
		std::uint64_t cover[5] = {};
		for (std::int32_t sub = 0; sub < 8; ++sub) {
			const std::int32_t y = row * side + sub * sub_side;
			const std::int32_t half = half_width(std::max(std::abs(y - py), std::abs(y + sub_side - 1 - py)));
			const std::int32_t low = (px - half + 2 * side + sub_side - 1) >> sub_bits;
			const std::int32_t high = (px + half + 1 + 2 * side) >> sub_bits;
			if (half < 0 || low >= high) {
				continue;
			}
			const std::uint64_t columns = (std::uint64_t{1} << high) - (std::uint64_t{1} << low);
			for (std::int32_t column = 0; column < 5; ++column) {
				cover[column] |= (columns >> (8 * column) & 0xff) << (8 * sub);
			}
		}
		const std::uint32_t first = cell + static_cast<std::uint32_t>(row * static_cast<std::int32_t>(grid.stride) - 2);
		for (std::uint32_t column = 0; column < 5; ++column) {
			const std::uint64_t before = grid.open[first + column];
			const std::uint64_t after = before & ~cover[column];
			grid.open[first + column] = after;
			if (after == 0 && before != 0) {
				close_cell(grid, first + column);
			}
		}
	}
}

HWY_INLINE void place_point(LevelGrid &grid, std::uint32_t cell, CellPosition position, std::uint32_t rank) {
	close_cell(grid, cell);
	grid.point[cell] = position;
	grid.dart[cell] = rank;
	stamp(grid, cell, position);
}

/// Puts a square into its cell's list, which is sorted by key.
HWY_INLINE void add_waiting(LevelGrid &grid, std::uint32_t cell, const Dart &dart) {
	const std::uint64_t key = std::uint64_t{dart.time} << 32 | dart.level_position;
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

/// True where one accepted point's disk covers the whole square: the test of the paper's section 3.2, by the farthest corner.
inline bool covered_by_one(const LevelGrid &grid, std::uint32_t cell, CellPosition origin, std::int32_t width) {
	const auto x0 = static_cast<std::int32_t>(position_x(origin));
	const auto y0 = static_cast<std::int32_t>(position_y(origin));
	for (std::int32_t row = -2; row <= 2; ++row) {
		for (std::int32_t column = -2; column <= 2; ++column) {
			const std::uint32_t point = grid.point[cell + static_cast<std::uint32_t>(row * static_cast<std::int32_t>(grid.stride) + column)];
			if (point == LevelGrid::no_point) {
				continue;
			}
			const std::int32_t x = column * side + static_cast<std::int32_t>(position_x(point));
			const std::int32_t y = row * side + static_cast<std::int32_t>(position_y(point));
			const std::int32_t dx = std::max(std::abs(x0 - x), std::abs(x0 + width - 1 - x));
			const std::int32_t dy = std::max(std::abs(y0 - y), std::abs(y0 + width - 1 - y));
			if (dx < far && dy < far && dx * dx + dy * dy < static_cast<std::int32_t>(radius_squared)) {
				return true;
			}
		}
	}
	return false;
}

HWY_INLINE bool known_covered(const LevelGrid &grid, std::uint32_t cell, std::uint32_t level, CellPosition origin) {
	const std::uint64_t open = grid.open[cell] >> sub_square_of(origin);
	if (level <= 3) {
		return (open & square_bits(level)) == 0;
	}
	return (open & 1) == 0 || covered_by_one(grid, cell, origin, side >> level);
}

/// The next dart was rejected: splits its square and takes the cell's next one.
inline void advance(LevelGrid &grid, std::uint32_t cell) {
	++grid.darts;
	const std::uint32_t level_position = grid.dart[cell];
	const std::uint32_t level = dart_level(level_position) + 1;
	if (level <= lattice_bits) {
		const CellPosition origin = square_origin(level_position);
		const std::uint32_t half = cell_size >> level;
		const glm::ivec2 where = grid.cell_of(cell);
		for (std::uint32_t child = 0; child < 4; ++child) {
			const CellPosition corner = origin + (child & 1) * half + (child >> 1) * (half << lattice_bits);
			if (!known_covered(grid, cell, level, corner)) {
				add_waiting(grid, cell, grid.source.child_dart(where.x, where.y, grid.time[cell], level, corner));
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

/// Decides one cell: follows the chain of blocking cells, each with an earlier dart than the one before.
/// False when the chain leaves the grid.
bool resolve_cell(LevelGrid *levels, std::uint32_t level, std::uint32_t start);

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
			if (!resolve_cell(levels, level + 1, source)) {
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

inline bool resolve_cell(LevelGrid *levels, std::uint32_t level, std::uint32_t start) {
	LevelGrid &grid = levels[level];
	if (grid.time[start] == time_never) {
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

/// Gives every cell its first dart, and the border its unknown time.
inline void throw_base_darts(LevelGrid &grid) {
	const glm::ivec2 size = grid.cells.size() + 2 * LevelGrid::border;
	const std::size_t count = std::size_t{grid.stride} * static_cast<std::size_t>(size.y);
	std::fill_n(grid.time.begin(), count, time_unknown);
	std::fill_n(grid.point.begin(), count, LevelGrid::no_point);
	std::fill_n(grid.waiting.begin(), count, 0u);
	std::fill_n(grid.open.begin(), count, std::uint64_t{0});
	for (std::int32_t y = grid.cells.min.y; y < grid.cells.max.y; ++y) {
		std::uint32_t index = grid.index_of({grid.cells.min.x, y});
		for (std::int32_t x = grid.cells.min.x; x < grid.cells.max.x; ++x, ++index) {
			const Dart dart = grid.source.base_dart(x, y, tag_of(mod_5(x), mod_5(y)));
			grid.time[index] = dart.time;
			grid.dart[index] = dart.level_position;
			grid.open[index] = LevelGrid::all_open;
		}
	}
	grid.squares += static_cast<std::uint64_t>(grid.cells.size().x) * static_cast<std::uint64_t>(grid.cells.size().y);
}

inline ResolveResult resolve_block(std::span<LevelGrid> levels, const CellRect &block, const std::atomic<bool> *cancel) {
	for (LevelGrid &grid : levels) {
		throw_base_darts(grid);
	}
	for (std::int32_t y = block.min.y; y < block.max.y; ++y) {
		if (cancel != nullptr && cancel->load(std::memory_order_relaxed)) {
			return ResolveResult::cancelled;
		}
		for (std::int32_t x = block.min.x; x < block.max.x; ++x) {
			if (!resolve_cell(levels.data(), 0, levels[0].index_of({x, y}))) {
				return ResolveResult::margin_too_small;
			}
		}
	}
	return ResolveResult::done;
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
