#pragma once

#include "core/sampling/dart.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The open squares of all cells that wait for their turn: a slot of up to eight, in no order, for each cell that has split; a
/// second one where they are more, and a common list for what few cells have beyond that.
class WaitingSquares {
public:
	static constexpr std::uint32_t slot_size = 8;
	// In the number of a slot.
	static constexpr std::uint32_t has_second = 1u << 30;
	static constexpr std::uint32_t overflows = 1u << 31; ///< The cell has a second slot and more squares in `overflow`.
	static constexpr std::uint32_t slot_mask = has_second - 1;

	struct alignas(64) Slot {
		std::array<DartKey, slot_size> darts;
	};
	struct Extra {
		std::uint32_t cell;
		DartKey dart;
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
	std::uint32_t *seconds() { return seconds_.data(); } ///< Of each slot that has one, the second slot.
	std::vector<Extra> &overflow() { return overflow_; }
	const std::vector<Extra> &overflow() const { return overflow_; }

	std::size_t bytes() const {
		return slots_.capacity() * sizeof(Slot) + seconds_.capacity() * sizeof(std::uint32_t) +
				overflow_.capacity() * sizeof(Extra);
	}

private:
	void grow(std::uint32_t more); // Out of line, for it is rare.

	std::vector<Slot> slots_;
	std::vector<std::uint32_t> seconds_;
	std::vector<Extra> overflow_;
	std::uint32_t used_ = 1;
};

} // namespace thicket
