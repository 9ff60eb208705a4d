#pragma once

#include "core/sampling/dart.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The open squares of all cells that wait for their turn: a slot of up to eight, in no order, for each cell that has split, and a
/// chain of more slots for a few cells that have more.
class WaitingSquares {
public:
	static constexpr std::uint32_t slot_size = 8;
	// In the number of a cell's slot.
	static constexpr std::uint32_t has_second = 1u << 30; ///< One more follows it.
	static constexpr std::uint32_t has_more = 1u << 31;   ///< More than one follow it.
	static constexpr std::uint32_t slot_mask = has_second - 1;

	/// Darts in two columns; where none is, the time is time_never.
	struct alignas(64) Slot {
		std::array<TimeKey, slot_size> time;
		std::array<std::uint32_t, slot_size> place;
	};

	/// Frees all slots; keeps the memory.
	void clear();

	/// Makes room for so many more slots.
	void reserve(std::uint32_t more) {
		if (used_ + more > slots_.size()) {
			grow(more);
		}
	}

	/// A slot within what was reserved; what it holds has no meaning.
	std::uint32_t take_if(bool wanted) {
		const std::uint32_t index = used_;
		used_ += static_cast<std::uint32_t>(wanted);
		return index;
	}

	/// Slot 0 is nobody's and empty.
	Slot *slots() { return slots_.data(); }
	std::uint32_t *followers() { return followers_.data(); } ///< Of each slot in a chain, the next one; 0 for none.
	const std::uint32_t *followers() const { return followers_.data(); }
	std::vector<DartKey> &gathered() { return gathered_; } ///< Room for the darts of a cell that has many.

	std::size_t bytes() const {
		return slots_.capacity() * sizeof(Slot) + followers_.capacity() * sizeof(std::uint32_t) +
				gathered_.capacity() * sizeof(DartKey);
	}

private:
	void grow(std::uint32_t more); // Out of line, for it is rare.

	std::vector<Slot> slots_;
	std::vector<std::uint32_t> followers_;
	std::vector<DartKey> gathered_;
	std::uint32_t used_ = 1;
};

} // namespace thicket
