#pragma once

#include "core/sampling/dart.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The open squares of all cells, which wait until the times of their darts. Each cell whose square
/// was split has a slot of up to eight squares, unsorted. The few cells with more squares have a
/// chain of slots.
class WaitingSquares {
public:
	static constexpr std::uint32_t slot_size = 8;
	// Flags in a cell's slot index.
	static constexpr std::uint32_t has_second = 1u << 30; ///< Exactly one more slot follows.
	static constexpr std::uint32_t has_more = 1u << 31;   ///< More than one slot follows.
	static constexpr std::uint32_t slot_mask = has_second - 1;

	/// The darts of up to eight squares, stored as two columns. Unused entries have the time
	/// time_never.
	struct alignas(64) Slot {
		std::array<TimeKey, slot_size> time;
		std::array<std::uint32_t, slot_size> level_position;
	};

	/// Releases all slots and keeps the memory.
	void clear();

	/// Ensures that `more` slots can be taken without reallocation. Throws std::bad_alloc.
	void reserve(std::uint32_t more) {
		if (used_ + more > slots_.size()) {
			grow(more);
		}
	}

	/// Takes a reserved slot if `wanted` is true. Returns its index. The slot's contents are
	/// undefined.
	std::uint32_t take_if(bool wanted) {
		const std::uint32_t index = used_;
		used_ += static_cast<std::uint32_t>(wanted);
		return index;
	}

	/// Returns all slots. Slot 0 belongs to no cell and is empty.
	Slot *slots() { return slots_.data(); }
	std::uint32_t *followers() { return followers_.data(); } ///< Next slot in the chain; 0 if there is none.
	const std::uint32_t *followers() const { return followers_.data(); }
	std::vector<DartKey> &gathered() { return gathered_; } ///< Scratch space for the darts of a cell.

	std::size_t bytes() const {
		return slots_.capacity() * sizeof(Slot) + followers_.capacity() * sizeof(std::uint32_t) +
				gathered_.capacity() * sizeof(DartKey);
	}

private:
	void grow(std::uint32_t more); // Not inlined, because it is rarely called.

	std::vector<Slot> slots_;
	std::vector<std::uint32_t> followers_;
	std::vector<DartKey> gathered_;
	std::uint32_t used_ = 1;
};

} // namespace thicket
