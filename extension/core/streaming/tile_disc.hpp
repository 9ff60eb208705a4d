#pragma once

#include <glm/vec2.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace thicket {

/// The tiles that touch a disc, stored as a span of columns per row. A disc takes little memory and
/// can be compared with another one quickly.
class TileDisc {
public:
	/// Sets the tiles: those of size `tile_size` that are at most `reach` meters (0 or more) from
	/// `center`.
	void set(double tile_size, glm::dvec2 center, double reach);
	void clear() { rows_.clear(); }

	bool contains(glm::ivec2 tile) const {
		const Span span = row(tile.y);
		return span.first <= tile.x && tile.x <= span.last;
	}

	/// Calls `visit(tile)` for each tile that is not in `other`, row by row.
	template <class Visit>
	void visit_without(const TileDisc &other, Visit &&visit) const {
		int y = first_row_;
		for (const Span mine : rows_) {
			const Span theirs = other.row(y);
			const bool are_separate = theirs.last < mine.first || mine.last < theirs.first;
			for (int x = mine.first; x <= (are_separate ? mine.last : std::min(mine.last, theirs.first - 1)); ++x) {
				visit(glm::ivec2(x, y));
			}
			for (int x = are_separate ? mine.last + 1 : std::max(mine.first, theirs.last + 1); x <= mine.last; ++x) {
				visit(glm::ivec2(x, y));
			}
			++y;
		}
	}

private:
	/// A range of columns, inclusive. Empty if `last` is less than `first`.
	struct Span {
		int first = 0;
		int last = -1;
	};

	Span row(int y) const {
		const auto index = static_cast<std::size_t>(static_cast<unsigned>(y) - static_cast<unsigned>(first_row_));
		return index < rows_.size() ? rows_[index] : Span{};
	}

	int first_row_ = 0;
	std::vector<Span> rows_;
};

} // namespace thicket
