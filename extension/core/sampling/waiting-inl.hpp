// Finds the next dart of each cell whose dart was rejected. resolver.cpp compiles this file once
// for each instruction set.
#if defined(THICKET_WAITING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_WAITING_INL
#undef THICKET_WAITING_INL
#else
#define THICKET_WAITING_INL
#endif

#include "core/sampling/darts-inl.hpp"
#include "core/sampling/empty_entries.hpp"
#include "core/sampling/level_grid.hpp"
#include "core/sampling/waiting_plain-inl.hpp"

#include <hwy/highway.h>

#include <bit>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The lanes are signed, because most processors can compare only signed integers in vectors.
using SlotLanes = hn::CappedTag<std::int32_t, WaitingSquares::slot_size>;
using SlotWords = hn::RebindToUnsigned<SlotLanes>;
constexpr std::size_t slot_lanes = hn::MaxLanes(SlotLanes());
constexpr std::size_t slot_vectors = WaitingSquares::slot_size / slot_lanes;

/// True for targets that only emulate vectors or byte shuffles. These process squares one by one.
constexpr bool is_waiting_scalar = is_scalar || HWY_TARGET == HWY_SSE2;

/// True if the target has an instruction that compresses the lanes of a vector.
constexpr bool has_native_compress = hn::MaxLanes(hn::ScalableTag<std::uint32_t>()) == 16;

/// Returns the times of the darts for which `is_still_open` is true, and time_never for all other
/// darts.
HWY_INLINE hn::Vec<SlotLanes> still_open(
		hn::Vec<SlotLanes> time, hn::Vec<SlotWords> level_position, std::uint64_t open) {
	const SlotLanes d;
	const SlotWords du;
	const hn::Repartition<std::uint8_t, SlotLanes> bytes;
	const hn::Repartition<std::uint64_t, SlotLanes> words;
	alignas(16) static constexpr std::uint8_t bit_of[16] = {1, 2, 4, 8, 16, 32, 64, 128};
	const auto seven = hn::Set(du, 7);
	// Puts the row's byte and the column's bit into the lowest byte of each lane. The other bytes
	// have no bit set.
	const auto y = hn::And(hn::ShiftRight<sub_bits + lattice_bits>(level_position), seven);
	const auto x = hn::Or(hn::And(hn::ShiftRight<sub_bits>(level_position), seven), hn::Set(du, 0x80808000u));
	const auto row = hn::TableLookupBytes(hn::BitCast(bytes, hn::Set(words, open)), hn::BitCast(bytes, y));
	const auto bit = hn::TableLookupBytesOr0(hn::LoadDup128(bytes, bit_of), hn::BitCast(bytes, x));
	const auto is_covered = hn::Eq(hn::BitCast(d, hn::And(row, bit)), hn::Zero(d));
	const auto level = hn::BitCast(d, hn::ShiftRight<2 * lattice_bits>(level_position));
	const auto is_small = hn::Gt(level, hn::Set(d, static_cast<std::int32_t>(first_small) - 1));
	return hn::IfThenElse(hn::And(is_small, is_covered), hn::Set(d, static_cast<std::int32_t>(time_never)), time);
}

/// Returns the times of the children, followed by time_never in the remaining lanes.
template <class D>
HWY_INLINE hn::Vec<D> times_of(D d, Children children) {
	const auto times = hn::BitCast(d, hn::LoadU(hn::RebindToUnsigned<D>(), children.time));
	const auto never = hn::Set(d, static_cast<std::int32_t>(time_never));
	if constexpr (has_native_compress) {
		return hn::IfThenElse(mask_of(d, (1u << children.count) - 1), times, never);
	}
	return hn::IfThenElse(hn::FirstN(d, children.count), times, never);
}

/// Returns 1 if more than one dart has the earliest time, so that their positions decide which is
/// next.
HWY_INLINE std::uint32_t is_tie(std::uint32_t earliest_ones, TimeKey time) {
	// This expression avoids an unpredictable branch.
	const std::uint32_t ones = time != time_never ? earliest_ones : 0;
	return (ones & (ones - 1)) != 0 ? 1 : 0;
}

/// Performs `advance` for a cell that has no waiting squares yet. There must be at least one child.
/// Returns false, without changes, if the slow path is needed.
HWY_INLINE bool start_slot(LevelGrid &grid, const Columns &columns, std::uint32_t cell, Children children) {
	const hn::CappedTag<std::int32_t, 4> d;
	const hn::RebindToUnsigned<decltype(d)> du;
	const auto never = hn::Set(d, static_cast<std::int32_t>(time_never));
	const auto times = times_of(d, children);
	const auto earliest = hn::MinOfLanes(d, times);
	const auto is_next = hn::Eq(times, earliest);
	const std::uint32_t next = bits_of(d, is_next);
	const auto time = static_cast<TimeKey>(hn::GetLane(earliest));
	if (HWY_UNLIKELY(is_tie(next, time) != 0)) {
		return false;
	}
	// There is no tie, so the times alone determine the next dart.
	const std::uint32_t slot = grid.waiting_squares.take_if(true);
	columns.time[cell] = time;
	columns.dart[cell] = children.level_position[std::countr_zero(next)];
	columns.waiting[cell] = slot;
	WaitingSquares::Slot &waiting = columns.slots[slot];
	hn::Store(hn::BitCast(du, hn::IfThenElse(is_next, never, times)), du, waiting.time.data());
	hn::Store(hn::BitCast(du, never), du, waiting.time.data() + 4);
	hn::Store(hn::LoadU(du, children.level_position), du, waiting.level_position.data());
	return true;
}

/// Writes children into the empty entries of a slot. `empty` has one bit per empty entry; there
/// must be enough of them.
HWY_INLINE void fill_slot(
		WaitingSquares::Slot &slot, std::uint32_t empty, hn::Vec<SlotLanes> times, Children children) {
	alignas(64) TimeKey time[slot_lanes];
	hn::Store(hn::BitCast(SlotWords(), times), SlotWords(), time);
	for (std::uint32_t child = 4; child-- > 0;) { // Earlier children overwrite later ones in the same entry.
		const std::uint32_t entry = empty_entries[empty][child];
		slot.time[entry] = time[child];
		slot.level_position[entry] = children.level_position[child];
	}
}

/// Returns `to` with the lanes of `from` moved, in order, into its empty lanes.
template <class V>
HWY_INLINE V filled(V to, hn::Mask<SlotLanes> is_empty, [[maybe_unused]] std::uint32_t empty, V from) {
	const hn::DFromV<V> d;
	const auto lanes = hn::RebindMask(d, is_empty);
#if HWY_TARGET == HWY_AVX2 // Highway would copy its table at each use.
	const auto order =
			hn::PromoteTo(SlotWords(), hn::LoadU(hn::CappedTag<std::uint8_t, 8>(), entries_before[empty].data()));
	return hn::IfThenElse(lanes, hn::TableLookupLanes(from, hn::IndicesFromVec(d, order)), to);
#else
	return hn::IfThenElse(lanes, hn::Expand(from, lanes), to);
#endif
}

/// The slots of a cell that has one or two.
template <std::size_t slot_count>
struct CellSlots {
	WaitingSquares::Slot *slots[slot_count];
	/// The times of the squares' darts; time_never where the square is covered.
	hn::Vec<SlotLanes> times[slot_count][slot_vectors];
	hn::Mask<SlotLanes> is_empty[slot_count][slot_vectors];
	std::uint32_t empty[slot_count] = {}; ///< One bit for each empty entry.
	std::uint32_t empty_count = 0;        ///< Number of empty entries.
	std::uint32_t next = 0; ///< One bit for each entry with the earliest dart, followed by the bits of the children.

	HWY_INLINE CellSlots(const Columns &columns, std::uint32_t cell) {
		const std::uint32_t first = columns.waiting[cell] & WaitingSquares::slot_mask;
		slots[0] = columns.slots + first;
		if constexpr (slot_count == 2) {
			slots[1] = columns.slots + columns.followers[first];
		}
		const SlotLanes d;
		const SlotWords du;
		for (std::size_t slot = 0; slot < slot_count; ++slot) {
			for (std::size_t i = 0; i < slot_vectors; ++i) {
				const auto time = hn::BitCast(d, hn::Load(du, slots[slot]->time.data() + i * slot_lanes));
				const auto level_position = hn::Load(du, slots[slot]->level_position.data() + i * slot_lanes);
				times[slot][i] = still_open(time, level_position, columns.open[cell]);
			}
		}
	}

	/// Returns the earliest time of the slots' darts and of the children, in all lanes.
	HWY_INLINE hn::Vec<SlotLanes> earliest(hn::Vec<SlotLanes> fresh) const {
		const SlotLanes d;
		for (const auto &slot : times) {
			for (const auto &time : slot) {
				fresh = hn::Min(fresh, time);
			}
		}
		return hn::MinOfLanes(d, fresh);
	}

	/// Marks the entry of the earliest dart as empty.
	HWY_INLINE void take(hn::Vec<SlotLanes> earliest) {
		const SlotLanes d;
		const auto never = hn::Set(d, static_cast<std::int32_t>(time_never));
		for (std::size_t slot = 0; slot < slot_count; ++slot) {
			for (std::size_t i = 0; i < slot_vectors; ++i) {
				const auto is_next = hn::Eq(times[slot][i], earliest);
				is_empty[slot][i] = hn::Or(is_next, hn::Eq(times[slot][i], never));
				next |= bits_of(d, is_next) << (slot * WaitingSquares::slot_size + i * slot_lanes);
				empty[slot] |= bits_of(d, is_empty[slot][i]) << (i * slot_lanes);
			}
			empty_count += static_cast<std::uint32_t>(std::popcount(empty[slot]));
		}
	}

	/// Returns the level and position (dart_level_position) of the earliest dart.
	template <bool with_children>
	HWY_INLINE std::uint32_t next_level_position(
			hn::Vec<SlotLanes> earliest, hn::Vec<SlotLanes> fresh, const Children &children) const {
		if constexpr (has_native_compress) {
			const SlotWords du;
			auto level_positions = hn::Zero(du);
			const auto take_if = [&](hn::Mask<SlotLanes> is_next, const std::uint32_t *from) {
				const auto lanes = hn::RebindMask(du, is_next);
				level_positions =
						hn::Or(level_positions, hn::Compress(hn::IfThenElseZero(lanes, hn::LoadU(du, from)), lanes));
			};
			for (std::size_t slot = 0; slot < slot_count; ++slot) {
				take_if(hn::Eq(times[slot][0], earliest), slots[slot]->level_position.data());
			}
			if constexpr (with_children) {
				take_if(hn::Eq(fresh, earliest), children.level_position);
			}
			return hn::GetLane(level_positions);
		}
		// There is no branch on the slot that contains the dart, because it would be unpredictable.
		const auto at = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(next));
		const auto level_position_if = [at](const std::uint32_t *level_positions, std::uint32_t begin) {
			const std::uint32_t mask = 0u - static_cast<std::uint32_t>(at / WaitingSquares::slot_size == begin);
			return level_positions[at % WaitingSquares::slot_size] & mask;
		};
		std::uint32_t level_position = with_children ? level_position_if(children.level_position, slot_count) : 0;
		for (std::uint32_t slot = 0; slot < slot_count; ++slot) {
			level_position |= level_position_if(slots[slot]->level_position.data(), slot);
		}
		return level_position;
	}

	/// Writes a slot back to memory, with children in its empty entries.
	template <bool with_children>
	HWY_INLINE void store(std::size_t slot, hn::Vec<SlotLanes> fresh, const Children &children) {
		const SlotLanes d;
		const SlotWords du;
		WaitingSquares::Slot &to = *slots[slot];
		if constexpr (with_children && slot_vectors == 1) {
			const auto level_positions = hn::Load(du, to.level_position.data());
			const auto rest = filled(times[slot][0], is_empty[slot][0], empty[slot], fresh);
			hn::Store(hn::BitCast(du, rest), du, to.time.data());
			const auto child_level_positions = hn::LoadU(du, children.level_position);
			hn::Store(filled(level_positions, is_empty[slot][0], empty[slot], child_level_positions), du,
					to.level_position.data());
			return;
		}
		const auto never = hn::Set(d, static_cast<std::int32_t>(time_never));
		for (std::size_t i = 0; i < slot_vectors; ++i) {
			const auto rest = hn::IfThenElse(is_empty[slot][i], never, times[slot][i]);
			hn::Store(hn::BitCast(du, rest), du, to.time.data() + i * slot_lanes);
		}
		if (with_children && (slot_count == 1 || empty[slot] != 0)) {
			fill_slot(to, empty[slot], fresh, children);
		}
	}
};

/// Performs `advance` for a cell with `slot_count` slots, or with neither slots nor children.
/// Returns false, without changes, if the slow path is needed.
template <bool with_children, std::size_t slot_count>
HWY_INLINE bool advance_slots(const Columns &columns, std::uint32_t cell, Children children) {
	const SlotLanes d;
	const auto never = hn::Set(d, static_cast<std::int32_t>(time_never));
	CellSlots<slot_count> slots(columns, cell);
	auto fresh = never;
	if constexpr (with_children) {
		fresh = times_of(d, children);
	}
	const auto earliest = slots.earliest(fresh);
	slots.take(earliest);
	if constexpr (with_children) {
		slots.next |= bits_of(d, hn::Eq(fresh, earliest)) << (slot_count * WaitingSquares::slot_size);
	}
	const auto time = static_cast<TimeKey>(hn::GetLane(earliest));
	const std::uint32_t is_full = with_children && slots.empty_count < children.count ? 1 : 0;
	if (HWY_UNLIKELY((is_full | is_tie(slots.next, time)) != 0)) {
		return false;
	}
	// There is no tie, and the slots have enough empty entries for all darts.
	columns.time[cell] = time;
	columns.dart[cell] = slots.template next_level_position<with_children>(earliest, fresh, children);
	for (std::size_t slot = 0; slot < slot_count; ++slot) {
		if constexpr (with_children) {
			fresh = hn::IfThenElse(hn::Eq(fresh, earliest), never, fresh);
		}
		slots.template store<with_children>(slot, fresh, children);
		if (with_children && slot + 1 < slot_count) { // The second slot takes the remaining children.
			children = children.after(static_cast<std::uint32_t>(std::popcount(slots.empty[0])));
			fresh = times_of(d, children);
		}
	}
	return true;
}

/// Advances a cell whose only slot is full, after adding a second slot.
HWY_NOINLINE void advance_to_second(LevelGrid &grid, const Columns &columns, std::uint32_t cell, Children children) {
	if constexpr (!is_waiting_scalar) {
		const std::uint32_t first = columns.waiting[cell];
		if (first != 0 && children.count != 0) {
			const std::uint32_t second = grid.waiting_squares.take_if(true);
			columns.slots[second].time.fill(time_never);
			columns.followers[first] = second;
			columns.followers[second] = 0;
			columns.waiting[cell] = first | WaitingSquares::has_second;
			if (advance_slots<true, 2>(columns, cell, children)) {
				return;
			}
		}
	}
	advance_slowly(grid, cell, children);
}

/// Sets the cell's next dart to the earliest dart of its waiting squares and of the new children.
/// All other darts wait. The cell is added to `r_work` if its next dart is due.
template <bool with_children>
HWY_INLINE void advance(LevelGrid &grid, const Columns &columns, Item item, Children children, Work &r_work) {
	const std::uint32_t cell = cell_of(item);
	const std::uint32_t waiting = columns.waiting[cell];
	if (HWY_LIKELY(waiting < WaitingSquares::has_second)) {
		bool done = false;
		if constexpr (is_waiting_scalar) {
			done = advance_plainly(grid, columns, cell, children);
		} else {
			done = advance_slots<with_children, 1>(columns, cell, children);
		}
		if (HWY_UNLIKELY(!done)) {
			advance_to_second(grid, columns, cell, children);
		}
	} else if (is_waiting_scalar || waiting >= WaitingSquares::has_more ||
			!advance_slots<with_children, 2>(columns, cell, children)) {
		advance_slowly(grid, cell, children);
	}
	r_work.add_if(item, columns.open[cell], columns.dart[cell], columns.time[cell] <= until_of(item));
}

/// Performs `advance` for a cell that has no waiting squares yet. There must be at least one child.
HWY_INLINE void advance_first(LevelGrid &grid, const Columns &columns, Item item, Children children, Work &r_work) {
	const std::uint32_t cell = cell_of(item);
	if constexpr (is_waiting_scalar) {
		return advance<true>(grid, columns, item, children, r_work);
	}
	if (HWY_UNLIKELY(!start_slot(grid, columns, cell, children))) {
		advance_slowly(grid, cell, children);
	}
	r_work.add_if(item, columns.open[cell], columns.dart[cell], columns.time[cell] <= until_of(item));
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
