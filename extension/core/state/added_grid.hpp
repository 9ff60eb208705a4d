#pragma once

#include "core/base/rect.hpp"

#include <glm/vec2.hpp>

#include <compare>
#include <cstdint>
#include <set>

namespace thicket {

/// Hand-placed instances by their layer and the square of the plane that they stand in.
class AddedGrid {
public:
	/// The layer is the id's, here and below.
	void insert(std::uint64_t id, glm::dvec2 position);
	void erase(std::uint64_t id, glm::dvec2 position) noexcept;

	/// Takes an id over that was inserted into another grid, and takes no memory for it.
	void take(AddedGrid &r_from, std::uint64_t id, glm::dvec2 position) noexcept;

	/// Calls `use(id)` for all of a layer in squares that meet the rectangle, in any order.
	template <typename Use>
	void for_each_near(std::uint16_t layer, const Rect &rect, Use &&use) const {
		const Entry first = corner_of(layer, rect.min);
		const Entry last = corner_of(layer, rect.max);
		auto at = entries_.lower_bound(first);
		while (at != entries_.end() && at->layer == layer && at->column <= last.column) {
			if (at->row < first.row) {
				// Fast path: on to the first row of the same column.
				at = entries_.lower_bound({layer, at->column, first.row, 0});
			} else if (at->row > last.row) {
				// Fast path: on to the next column.
				at = entries_.lower_bound({layer, at->column + 1, first.row, 0});
			} else {
				use(at->id);
				++at;
			}
		}
	}

private:
	struct Entry {
		std::uint16_t layer;
		std::int32_t column;
		std::int32_t row;
		std::uint64_t id;

		friend auto operator<=>(const Entry &, const Entry &) = default;
	};

	static Entry corner_of(std::uint16_t layer, glm::dvec2 position);
	static Entry entry_of(std::uint64_t id, glm::dvec2 position);

	std::set<Entry> entries_; ///< Each a piece of memory of its own, so that it can be had before it is needed.
};

} // namespace thicket
