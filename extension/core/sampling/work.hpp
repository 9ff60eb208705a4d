#pragma once

#include "core/sampling/dart.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

// Batches of cells and squares that are processed together. Many independent items at a time keep a
// processor busy. With one item at a time, the processor would wait for each branch and each load.

namespace thicket {

/// The number of position bits, per axis, within one of a cell's 8 x 8 sub-squares.
inline constexpr std::int32_t sub_bits = lattice_bits - 3;

constexpr std::uint32_t sub_square_of(CellPosition position) {
	return (position_y(position) >> sub_bits) * 8 + (position_x(position) >> sub_bits);
}

/// A cell whose darts must be decided up to a time. The cell's index is in the low half, and the
/// time is in the high half.
using Item = std::uint64_t;
constexpr Item make_item(std::uint32_t cell, TimeKey until) { return Item{until} << 32 | cell; }
constexpr std::uint32_t cell_of(Item item) { return static_cast<std::uint32_t>(item); }
constexpr TimeKey until_of(Item item) { return static_cast<TimeKey>(item >> 32); }

/// Cells that undergo the same processing step.
struct Group {
	static constexpr std::uint32_t max_count = 80;
	static constexpr std::uint32_t capacity = max_count + 16; ///< Vectors read and write past the last item.

	std::uint32_t count = 0;
	alignas(64) Item items[capacity];

	Group() = default;
	Group(const Group &other) { *this = other; }
	/// Copies only the items in use.
	Group &operator=(const Group &other) {
		count = other.count;
		std::copy_n(other.items, other.count, items);
		return *this;
	}

	/// Adds an item if `condition` is true, without an unpredictable branch.
	void add_if(Item item, bool condition) {
		items[count] = item;
		count += static_cast<std::uint32_t>(condition);
	}
};

/// Cells whose next dart is due.
struct Work {
	Group covered; ///< Cells whose dart falls in a sub-square that is known to be covered.
	Group uncovered;

	std::uint32_t count() const { return covered.count + uncovered.count; }

	/// Adds a cell if its dart is due. `open_parts` has the cell's uncovered sub-squares, and
	/// `level_position` is the packed level and position of its next dart.
	void add_if(Item item, std::uint64_t open_parts, std::uint32_t level_position, bool due) {
		const bool is_open = (open_parts >> sub_square_of(dart_position(level_position)) & 1) != 0;
		covered.add_if(item, due & !is_open);
		uncovered.add_if(item, due & is_open);
	}
};

/// Squares that are about to be split, stored as columns.
struct Splits {
	static constexpr std::uint32_t capacity = Group::capacity;
	static constexpr std::uint32_t child_capacity = 4 * capacity;

	std::uint32_t count = 0;
	alignas(64) Item items[capacity];
	alignas(64) DartKey parent[capacity];
	alignas(64) std::uint64_t open_children[capacity]; ///< One bit for each child that is not known to be covered.

	/// The index, in the columns below, of each square's first open child. One more entry marks the
	/// end.
	std::uint32_t first[capacity + 1];
	/// The number from which the child's dart is hashed; see child_dart().
	alignas(64) std::uint64_t hash_inputs[child_capacity]{};
	/// Position bits that distinguish the child from its siblings.
	alignas(64) std::uint32_t corner[child_capacity]{};
	/// Time and packed level and position of the child's dart. Until that dart is thrown, these are
	/// the values of the parent's dart.
	alignas(64) TimeKey time[child_capacity]{};
	alignas(64) std::uint32_t level_position[child_capacity]{};
};

/// The new darts of one cell, unsorted.
struct Children {
	const TimeKey *time;
	const std::uint32_t *level_position;
	std::uint32_t count;

	static Children of(const Splits &splits, std::uint32_t split) {
		const std::uint32_t first = splits.first[split];
		return {splits.time + first, splits.level_position + first, splits.first[split + 1] - first};
	}

	/// Returns the children without the first `first` ones.
	Children after(std::uint32_t first) const {
		const std::uint32_t skipped = std::min(first, count);
		return {time + skipped, level_position + skipped, count - skipped};
	}
};

} // namespace thicket
