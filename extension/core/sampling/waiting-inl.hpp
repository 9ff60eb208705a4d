// The next darts of cells whose dart was rejected. Compiled once for each instruction set, by resolver.cpp.
#if defined(THICKET_WAITING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_WAITING_INL
#undef THICKET_WAITING_INL
#else
#define THICKET_WAITING_INL
#endif

#include "core/sampling/level_grid.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The columns of a grid. Vector stores may alias the vectors' own pointers, which would be loaded again after each.
struct Columns {
	TimeKey *time;
	std::uint32_t *dart;
	std::uint32_t *waiting;
	std::uint64_t *open;
	WaitingSquares::Slot *slots;
	std::uint32_t *seconds;

	explicit Columns(LevelGrid &grid) :
			time(grid.time.data()), dart(grid.dart.data()), waiting(grid.waiting.data()), open(grid.open.data()),
			slots(grid.waiting_squares.slots()), seconds(grid.waiting_squares.seconds()) {}
};

/// Signed numbers are what most processors compare at once.
using SlotLanes = hn::CappedTag<std::int64_t, WaitingSquares::slot_size>;
using SlotWords = hn::RebindToUnsigned<SlotLanes>;
constexpr std::size_t slot_lanes = hn::MaxLanes(SlotLanes());
constexpr std::size_t slot_vectors = WaitingSquares::slot_size / slot_lanes;

/// The darts whose squares have a sub-square that is not known to be covered; the others become dart_never. Of squares larger
/// than a sub-square all are kept.
HWY_INLINE hn::Vec<SlotLanes> still_open(hn::Vec<SlotWords> darts, std::uint64_t open) {
	const SlotLanes d;
	const SlotWords du;
	const auto x = hn::And(hn::ShiftRight<sub_bits>(darts), hn::Set(du, 7));
	const auto y = hn::And(hn::ShiftRight<sub_bits + lattice_bits - 3>(darts), hn::Set(du, 7 << 3));
	const auto level = hn::BitCast(d, hn::And(darts, hn::Set(du, 15ull << (2 * lattice_bits))));
	const auto small = hn::Gt(level, hn::Set(d, (3ll << (2 * lattice_bits)) - 1));
	const auto part = hn::And(hn::Shr(hn::Set(du, open), hn::Or(x, y)), hn::Set(du, 1));
	const auto covered = hn::And(small, hn::Eq(hn::BitCast(d, part), hn::Zero(d)));
	return hn::IfThenElse(covered, hn::Set(d, static_cast<std::int64_t>(dart_never)), hn::BitCast(d, darts));
}

/// `advance` of a cell that has or had more waiting squares than two slots hold.
HWY_NOINLINE void advance_slowly(LevelGrid &grid, std::uint32_t cell, const DartKey *children) {
	std::vector<WaitingSquares::Extra> &overflow = grid.waiting_squares.overflow();
	const std::uint32_t slot = grid.waiting[cell] & WaitingSquares::slot_mask;
	auto &first = grid.waiting_squares.slots()[slot].darts;
	auto &second = grid.waiting_squares.slots()[grid.waiting_squares.seconds()[slot]].darts;
	const auto put = [&](DartKey dart) {
		if (dart != dart_never) {
			overflow.push_back({cell, dart});
		}
	};
	std::for_each(first.begin(), first.end(), put);
	std::for_each(second.begin(), second.end(), put);
	std::for_each(children, children + 4, put);
	const auto mine =
			std::partition(overflow.begin(), overflow.end(), [cell](const auto &extra) { return extra.cell != cell; });
	std::sort(mine, overflow.end(), [](const auto &a, const auto &b) { return a.dart > b.dart; });
	const std::ptrdiff_t others = mine - overflow.begin();
	const auto take = [&] {
		if (std::ssize(overflow) == others) {
			return dart_never;
		}
		const DartKey dart = overflow.back().dart;
		overflow.pop_back();
		return dart;
	};
	const DartKey next = take();
	std::generate(first.begin(), first.end(), take);
	std::generate(second.begin(), second.end(), take);
	grid.waiting[cell] =
			slot | WaitingSquares::has_second | (std::ssize(overflow) > others ? WaitingSquares::overflows : 0);
	grid.time[cell] = std::min(dart_time(next), time_never);
	grid.dart[cell] = dart_place(next);
}

/// Lets darts wait for which the cell's slots have no room, up to dart_never.
template <std::size_t slot_count>
HWY_NOINLINE void put_beyond(LevelGrid &grid, std::uint32_t cell, std::uint32_t slot, const DartKey *darts) {
	if constexpr (slot_count == 1) {
		const std::uint32_t second = grid.waiting_squares.take_if(true);
		grid.waiting_squares.seconds()[slot] = second;
		std::copy_n(darts, WaitingSquares::slot_size, grid.waiting_squares.slots()[second].darts.begin());
		grid.waiting[cell] |= WaitingSquares::has_second;
	} else {
		for (; *darts != dart_never; ++darts) {
			grid.waiting_squares.overflow().push_back({cell, *darts});
		}
		grid.waiting[cell] |= WaitingSquares::overflows;
	}
}

/// `advance_slots` one dart after the other. The darts of a slot stand before any dart_never in it.
template <bool with_children, std::size_t slot_count>
inline void advance_plainly(LevelGrid &grid, const Columns &columns, Item item, const DartKey *children, Work &r_work) {
	constexpr std::uint32_t first_small = 3; // Levels from here on have squares of one sub-square or less.
	const std::uint32_t cell = cell_of(item);
	const std::uint32_t before = columns.waiting[cell] & WaitingSquares::slot_mask;
	const std::uint64_t open = columns.open[cell];
	DartKey darts[slot_count * WaitingSquares::slot_size + 4 + WaitingSquares::slot_size + 1];
	std::size_t count = 0;
	std::size_t first = 0;
	for (std::size_t slot = 0; slot < slot_count; ++slot) {
		for (const DartKey dart : columns.slots[slot == 0 ? before : columns.seconds[before]].darts) {
			if (dart == dart_never) {
				break;
			}
			const std::uint32_t place = dart_place(dart);
			if (dart_level(place) < first_small || (open >> sub_square_of(dart_position(place)) & 1) != 0) {
				darts[count] = dart;
				first = dart < darts[first] ? count : first;
				++count;
			}
		}
	}
	DartKey next = count > 0 ? darts[first] : dart_never;
	if (with_children && children[0] < next) {
		next = *children++;
	} else if (count > 0) {
		darts[first] = darts[--count];
	}
	for (; with_children && *children != dart_never; ++children) {
		darts[count++] = *children;
	}
	std::fill_n(darts + count, WaitingSquares::slot_size + 1, dart_never);
	const TimeKey time = std::min(dart_time(next), time_never);
	columns.time[cell] = time;
	columns.dart[cell] = dart_place(next);
	r_work.add_if(item, open, dart_place(next), time <= until_of(item));
	const std::uint32_t slot = before != 0 || count == 0 ? before : grid.waiting_squares.take_if(true);
	if (slot == 0) {
		return;
	}
	columns.waiting[cell] = slot | (slot_count == 2 ? WaitingSquares::has_second : 0);
	std::copy_n(darts, WaitingSquares::slot_size, columns.slots[slot].darts.begin());
	if constexpr (slot_count == 2) {
		std::copy_n(darts + WaitingSquares::slot_size, WaitingSquares::slot_size,
				columns.slots[columns.seconds[slot]].darts.begin());
	}
	if (count > slot_count * WaitingSquares::slot_size) {
		put_beyond<slot_count>(grid, cell, slot, darts + slot_count * WaitingSquares::slot_size);
	}
}

/// `advance` of a cell that has no waiting squares yet, with at least one child.
HWY_INLINE void advance_first(
		LevelGrid &grid, const Columns &columns, Item item, const DartKey *children, Work &r_work) {
	const std::uint32_t cell = cell_of(item);
	const std::uint32_t slot = grid.waiting_squares.take_if(true);
	const TimeKey time = dart_time(children[0]);
	columns.time[cell] = time;
	columns.dart[cell] = dart_place(children[0]);
	columns.waiting[cell] = slot;
	std::copy_n(children + 1, WaitingSquares::slot_size, columns.slots[slot].darts.begin());
	r_work.add_if(item, columns.open[cell], dart_place(children[0]), time <= until_of(item));
}

/// `advance` of a cell with so many slots at most.
template <bool with_children, std::size_t slot_count>
HWY_INLINE void advance_slots(
		LevelGrid &grid, const Columns &columns, Item item, const DartKey *children, Work &r_work) {
	if constexpr (is_plain) {
		return advance_plainly<with_children, slot_count>(grid, columns, item, children, r_work);
	}
	const SlotLanes d;
	const SlotWords du;
	const auto never = hn::Set(d, static_cast<std::int64_t>(dart_never));
	const std::uint32_t cell = cell_of(item);
	const std::uint32_t before = columns.waiting[cell] & WaitingSquares::slot_mask;
	const std::uint64_t open = columns.open[cell];
	DartKey *slots[2] = {columns.slots[before].darts.data(),
			slot_count == 2 ? columns.slots[columns.seconds[before]].darts.data() : nullptr};
	hn::Vec<SlotLanes> darts[slot_count * slot_vectors];
	auto earliest = with_children ? hn::Set(d, static_cast<std::int64_t>(children[0])) : never;
	for (std::size_t i = 0; i < slot_count * slot_vectors; ++i) {
		darts[i] = still_open(hn::Load(du, slots[i / slot_vectors] + i % slot_vectors * slot_lanes), open);
		earliest = hn::Min(earliest, darts[i]);
	}
	earliest = hn::MinOfLanes(d, earliest);
	const auto next = static_cast<DartKey>(hn::GetLane(earliest));
	const TimeKey time = std::min(dart_time(next), time_never);
	columns.time[cell] = time;
	columns.dart[cell] = dart_place(next);
	r_work.add_if(item, open, dart_place(next), time <= until_of(item));
	const std::uint32_t fresh = grid.waiting_squares.take_if(with_children && before == 0);
	const std::uint32_t slot = before != 0 ? before : fresh;
	if constexpr (with_children) {
		slots[0] = columns.slots[slot].darts.data();
	}
	const DartKey *rest = with_children ? children + (next == children[0]) : nullptr;
	std::size_t room = 0;
	for (std::size_t i = 0; i < slot_count * slot_vectors; ++i) {
		const auto empty = hn::Or(hn::Eq(darts[i], never), hn::Eq(darts[i], earliest));
		DartKey *to = slots[i / slot_vectors] + i % slot_vectors * slot_lanes;
		if constexpr (with_children) {
			const auto fresh_darts =
					hn::LoadExpand(hn::RebindMask(du, empty), du, rest + std::min<std::size_t>(room, 4));
			hn::Store(hn::BitCast(du, hn::IfThenElse(empty, hn::BitCast(d, fresh_darts), darts[i])), du, to);
			room += hn::CountTrue(d, empty);
		} else {
			hn::Store(hn::BitCast(du, hn::IfThenElse(empty, never, darts[i])), du, to);
		}
	}
	if constexpr (with_children) {
		columns.waiting[cell] = slot | (slot_count == 2 ? WaitingSquares::has_second : 0);
		if (HWY_UNLIKELY(room < 4 && rest[room] != dart_never)) {
			put_beyond<slot_count>(grid, cell, slot, rest + room);
		}
	}
}

/// The cell's next dart: the earliest of its waiting squares and of up to four new ones, which stand sorted at `children` before
/// nine times dart_never; the others wait.
template <bool with_children>
HWY_INLINE void advance(LevelGrid &grid, const Columns &columns, Item item, const DartKey *children, Work &r_work) {
	const std::uint32_t cell = cell_of(item);
	const std::uint32_t before = columns.waiting[cell];
	if (HWY_LIKELY(before < WaitingSquares::has_second)) {
		advance_slots<with_children, 1>(grid, columns, item, children, r_work);
	} else if (before < WaitingSquares::overflows) {
		advance_slots<with_children, 2>(grid, columns, item, children, r_work);
	} else {
		static constexpr DartKey none[4] = {dart_never, dart_never, dart_never, dart_never};
		advance_slowly(grid, cell, with_children ? children : none);
		r_work.add_if(item, columns.open[cell], columns.dart[cell], columns.time[cell] <= until_of(item));
	}
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
