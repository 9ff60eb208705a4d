#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace thicket {

/// Schedules when the cells of one mesh in a tile are drawn again as viewers move. A cell is due only after a viewer
/// has moved as far as that cell allows. Times are meters of LodSchedule::traveled.
class CellVisits {
public:
	/// Calls `draw(cell)` for each of `cells` cells that is due, or for all of them. `draw` returns how far viewers may move until that
	/// cell must be drawn again: meters, 0 or more. The result is how far they may move until the first cell is due; infinite without
	/// cells. The number of cells may change only if all are visited.
	template <class Draw>
	double visit(std::size_t cells, double traveled, bool all, const Draw &draw) {
		double margin = std::numeric_limits<double>::infinity();
		due_.resize(cells, traveled);
		for (std::size_t cell = 0; cell < cells; ++cell) {
			if (all || due_[cell] <= traveled) {
				due_[cell] = traveled + draw(cell);
			}
			margin = std::min(margin, due_[cell] - traveled);
		}
		return margin;
	}

private:
	std::vector<double> due_; ///< Separate from the cells, because most visits read nothing else.
};

/// How far viewers may move until a tile is visited again, in meters. `margin` is how far they may move until the first
/// of its cells is due, and `division_margin` until the tile may need a different division. `cell_size` is in meters, 0
/// for a tile that is drawn as a whole. A tile in cells waits for at least an eighth of that size, unless its division
/// may change earlier, because one of many cells is always near a change. The result is never 0. Otherwise a tile would
/// be visited endlessly while the viewers stay at the distance of a change.
inline double visit_margin(double margin, double cell_size, double division_margin) {
	constexpr double least = 1e-3;
	constexpr double least_of_cell = 1.0 / 8.0;
	return std::max(std::min(std::max(margin, least_of_cell * cell_size), division_margin), least);
}

} // namespace thicket
