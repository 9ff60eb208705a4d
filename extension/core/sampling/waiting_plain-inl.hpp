// Scalar forms of the functions of waiting-inl.hpp, which process the darts of a cell one by one.
// resolver.cpp compiles this file once for each instruction set.
#if defined(THICKET_WAITING_PLAIN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_WAITING_PLAIN_INL
#undef THICKET_WAITING_PLAIN_INL
#else
#define THICKET_WAITING_PLAIN_INL
#endif

#include "core/sampling/level_grid.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

/// The arrays of a grid as plain pointers. Vector stores may alias the pointers inside std::vector,
/// so the compiler would reload these after each store.
struct Columns {
	TimeKey *time;
	std::uint32_t *dart;
	std::uint32_t *waiting;
	std::uint64_t *open;
	WaitingSquares::Slot *slots;
	std::uint32_t *followers;

	explicit Columns(LevelGrid &grid) :
			time(grid.time.data()), dart(grid.dart.data()), waiting(grid.waiting.data()), open(grid.open.data()),
			slots(grid.waiting_squares.slots()), followers(grid.waiting_squares.followers()) {}
};

/// From this level on, squares are no larger than a sub-square.
constexpr std::uint32_t first_small = 3;

/// Returns false if the dart's square is known to be covered. For squares larger than a sub-square,
/// the result is always true.
HWY_INLINE bool is_still_open(std::uint32_t level_position, std::uint64_t open) {
	return dart_level(level_position) < first_small || (open >> sub_square_of(dart_position(level_position)) & 1) != 0;
}

/// Performs `advance` for cells with any number of slots.
HWY_NOINLINE void advance_slowly(LevelGrid &grid, std::uint32_t cell, Children children) {
	WaitingSquares &squares = grid.waiting_squares;
	std::vector<DartKey> &darts = squares.gathered();
	darts.clear();
	const auto put = [&](TimeKey time, std::uint32_t level_position) {
		if (time != time_never && is_still_open(level_position, grid.open[cell])) {
			darts.push_back(make_dart(time, level_position));
		}
	};
	const std::uint32_t first = grid.waiting[cell] & WaitingSquares::slot_mask;
	const bool has_more = grid.waiting[cell] > WaitingSquares::slot_mask;
	for (std::uint32_t slot = first; slot != 0; slot = has_more ? squares.followers()[slot] : 0) {
		for (std::uint32_t i = 0; i < WaitingSquares::slot_size; ++i) {
			put(squares.slots()[slot].time[i], squares.slots()[slot].level_position[i]);
		}
	}
	for (std::uint32_t i = 0; i < children.count; ++i) {
		put(children.time[i], children.level_position[i]);
	}
	if (darts.empty()) {
		darts.push_back(make_dart(time_never, 0));
	}
	std::swap(*std::ranges::min_element(darts), darts.back());
	grid.time[cell] = dart_time(darts.back());
	grid.dart[cell] = dart_level_position(darts.back());
	darts.pop_back();
	std::uint32_t slot = first != 0 ? first : squares.take_if(true);
	std::uint32_t next = has_more ? squares.followers()[slot] : 0;
	grid.waiting[cell] = slot |
			(darts.size() > 2 * WaitingSquares::slot_size              ? WaitingSquares::has_more
							: darts.size() > WaitingSquares::slot_size ? WaitingSquares::has_second
																	   : 0);
	while (true) {
		for (std::uint32_t i = 0; i < WaitingSquares::slot_size; ++i) {
			const bool some = !darts.empty();
			squares.slots()[slot].time[i] = some ? dart_time(darts.back()) : time_never;
			squares.slots()[slot].level_position[i] = some ? dart_level_position(darts.back()) : 0;
			darts.resize(darts.size() - (some ? 1 : 0));
		}
		if (darts.empty()) {
			squares.followers()[slot] = 0;
			return;
		}
		const std::uint32_t after = next != 0 ? next : squares.take_if(true);
		next = next != 0 ? squares.followers()[next] : 0;
		squares.followers()[slot] = after;
		slot = after;
	}
}

/// Performs `advance` for a cell with at most one slot. Within a slot, the darts precede all
/// time_never entries. Returns false, without changes, if the darts do not fit in one slot.
inline bool advance_plainly(LevelGrid &grid, const Columns &columns, std::uint32_t cell, Children children) {
	const std::uint32_t before = columns.waiting[cell];
	const std::uint64_t open = columns.open[cell];
	DartKey darts[WaitingSquares::slot_size + 4];
	std::uint32_t count = 0;
	std::uint32_t first = 0;
	const auto put = [&](DartKey dart) {
		darts[count] = dart;
		first = dart < darts[first] ? count : first;
		++count;
	};
	const WaitingSquares::Slot &slot = columns.slots[before];
	for (std::uint32_t i = 0; i < WaitingSquares::slot_size && slot.time[i] != time_never; ++i) {
		if (is_still_open(slot.level_position[i], open)) {
			put(make_dart(slot.time[i], slot.level_position[i]));
		}
	}
	for (std::uint32_t i = 0; i < children.count; ++i) {
		put(make_dart(children.time[i], children.level_position[i]));
	}
	if (count > WaitingSquares::slot_size + 1) {
		return false;
	}
	const DartKey next = count > 0 ? darts[first] : make_dart(time_never, 0);
	columns.time[cell] = dart_time(next);
	columns.dart[cell] = dart_level_position(next);
	if (count > 0) {
		darts[first] = darts[--count];
	}
	if (before == 0 && count == 0) {
		return true;
	}
	columns.waiting[cell] = before != 0 ? before : grid.waiting_squares.take_if(true);
	WaitingSquares::Slot &after = columns.slots[columns.waiting[cell]];
	for (std::uint32_t i = 0; i < count; ++i) {
		after.time[i] = dart_time(darts[i]);
		after.level_position[i] = dart_level_position(darts[i]);
	}
	std::fill(after.time.begin() + count, after.time.end(), time_never);
	return true;
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
