#pragma once

#include "core/sampling/dart.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The open children of a split square that wait for their turn, by time; dart_never where there are fewer than four.
struct Siblings {
	std::array<DartKey, 4> keys;
	std::uint32_t next; ///< The cell's next siblings in the pool, 0 for none.
};

/// The waiting squares of all cells: short lists of siblings, each named by its head, 0 when empty.
class SiblingPool {
public:
	/// Forgets all lists; keeps the memory.
	void clear() {
		used_ = 1; // Entry 0 is nobody's.
		free_ = 0;
	}

	/// Puts siblings, sorted by time, before the others of a list.
	void add(std::uint32_t &head, const std::array<DartKey, 4> &keys) {
		std::uint32_t index = free_;
		if (index != 0) {
			free_ = entries_[index].next;
		} else {
			if (used_ >= entries_.size()) {
				grow();
			}
			index = used_++;
		}
		entries_[index] = {keys, head};
		head = index;
	}

	/// Takes the earliest square out of a list that has one.
	DartKey take(std::uint32_t &head) {
		std::uint32_t *earliest = &head;
		DartKey key = entries_[head].keys[0];
		for (std::uint32_t *link = &entries_[head].next; *link != 0; link = &entries_[*link].next) {
			if (entries_[*link].keys[0] < key) {
				key = entries_[*link].keys[0];
				earliest = link;
			}
		}
		const std::uint32_t index = *earliest;
		Siblings &siblings = entries_[index];
		siblings.keys = {siblings.keys[1], siblings.keys[2], siblings.keys[3], dart_never};
		if (siblings.keys[0] == dart_never) {
			*earliest = siblings.next;
			siblings.next = free_;
			free_ = index;
		}
		return key;
	}

	/// Empties a list.
	void release(std::uint32_t &head) {
		if (head == 0) {
			return;
		}
		std::uint32_t last = head;
		while (entries_[last].next != 0) {
			last = entries_[last].next;
		}
		entries_[last].next = free_;
		free_ = head;
		head = 0;
	}

	std::size_t bytes() const { return entries_.capacity() * sizeof(Siblings); }

private:
	void grow(); // Out of line, for it is rare.

	std::vector<Siblings> entries_;
	std::uint32_t used_ = 1;
	std::uint32_t free_ = 0;
};

} // namespace thicket
