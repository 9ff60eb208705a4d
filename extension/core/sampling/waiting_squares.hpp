#pragma once

#include "core/sampling/dart.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The open squares of all cells, waiting for their turn. Each cell that has split has a slot of up to eight squares, in no order. A few
/// cells with more squares have a chain of further slots.
class WaitingSquares {
public:
	static constexpr std::uint32_t slot_size = 8;
	// Flags in the number of a cell's slot.
	static constexpr std::uint32_t has_second = 1u << 30; ///< One further slot follows.
	static constexpr std::uint32_t has_more = 1u << 31;   ///< More than one slot follows.
	static constexpr std::uint32_t slot_mask = has_second - 1;

	/// Darts in two columns. The time is time_never where there is no dart.
	struct alignas(64) Slot {
		std::array<TimeKey, slot_size> time;
		std::array<std::uint32_t, slot_size> place;
	};

	/// Frees all slots; keeps the memory.
	void clear();

	/// Reserves room for `more` further slots.
	void reserve(std::uint32_t more) {
		if (used_ + more > slots_.size()) {
			grow(more);
		}
	}

	/// Takes a slot from the reserved ones if `wanted`. Its contents are undefined.
	std::uint32_t take_if(bool wanted) {
		const std::uint32_t index = used_;
		used_ += static_cast<std::uint32_t>(wanted);
		return index;
	}

	/// Slot 0 belongs to no cell and is empty.
	Slot *slots() { return slots_.data(); }
	std::uint32_t *followers() { return followers_.data(); } ///< Next slot in the chain; 0 if there is none.
	const std::uint32_t *followers() const { return followers_.data(); }
	std::vector<DartKey> &gathered() { return gathered_; } ///< Temporary storage for the darts of a cell that has many.

	std::size_t bytes() const {
		return slots_.capacity() * sizeof(Slot) + followers_.capacity() * sizeof(std::uint32_t) +
				gathered_.capacity() * sizeof(DartKey);
	}

private:
	void grow(std::uint32_t more); // Out of line, because it is rarely called.

	std::vector<Slot> slots_;
	std::vector<std::uint32_t> followers_;
	std::vector<DartKey> gathered_;
	std::uint32_t used_ = 1;
};

} // namespace thicket
