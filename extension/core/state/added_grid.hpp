#pragma once

#include "core/base/rect.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace thicket {

/// Hand-placed instances of a layer by the square of the plane that they stand in.
class AddedGrid {
public:
	void insert(std::uint64_t id, glm::dvec2 position);
	void erase(std::uint64_t id, glm::dvec2 position);

	/// Calls `use(id)` for all in squares that meet the rectangle, in any order.
	template <typename Use>
	void for_each_near(const Rect &rect, Use &&use) const {
		const Square first = square_of(rect.min);
		const Square last = square_of(rect.max);
		for (auto at = squares_.lower_bound(first); at != squares_.end() && at->first.first <= last.first;) {
			const Square square = at->first;
			if (square.second < first.second) {
				at = squares_.lower_bound({square.first, first.second});
			} else if (square.second > last.second) {
				at = squares_.lower_bound({square.first + 1, first.second});
			} else {
				for (const std::uint64_t id : at->second) {
					use(id);
				}
				++at;
			}
		}
	}

private:
	using Square = std::pair<std::int32_t, std::int32_t>; ///< Column, row.

	static Square square_of(glm::dvec2 position);

	std::map<Square, std::vector<std::uint64_t>> squares_;
};

} // namespace thicket
