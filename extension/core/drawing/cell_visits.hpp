#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace thicket {

/// Schedules when the cells of one mesh in a tile must be updated as viewers move. A cell is due
/// once a viewer may have moved farther than the cell's margin. Times are values of
/// LodSchedule::traveled, in meters.
class CellVisits {
public:
	/// Calls `draw(cell)` for each of `cells` cells that is due, or for every cell if `check_all`
	/// is true. `draw` returns the cell's margin: the meters, 0 or more, that viewers may move
	/// before the cell must be updated again. `visit` returns the meters until the first cell is
	/// due, or infinity if there are no cells. `cells` may differ from the last call only if
	/// `check_all` is true.
	template <class Draw>
	double visit(std::size_t cells, double traveled, bool check_all, const Draw &draw) {
		double margin = std::numeric_limits<double>::infinity();
		due_times_.resize(cells, traveled);
		for (std::size_t cell = 0; cell < cells; ++cell) {
			if (check_all || due_times_[cell] <= traveled) {
				due_times_[cell] = traveled + draw(cell);
			}
			margin = std::min(margin, due_times_[cell] - traveled);
		}
		return margin;
	}

private:
	/// The time at which each cell is due. The times are stored separately from the cells, because
	/// most visits read nothing else.
	std::vector<double> due_times_;
};

/// Returns the distance in meters that viewers may move before a tile must be visited again.
/// `margin` is the distance until the first cell is due, and `division_margin` the distance until
/// the division may change. `cell_size` is in meters, or 0 for a tile that is drawn as a whole. In
/// a tile with many cells, some cell is always close to a change. For a divided tile, the result is
/// therefore at least an eighth of the cell size, unless its division may change earlier. The
/// result is above 0, so that a tile is not visited endlessly while a viewer is exactly at the
/// distance of a change.
inline double visit_margin(double margin, double cell_size, double division_margin) {
	constexpr double min_margin = 1e-3;
	constexpr double min_fraction_of_cell = 1.0 / 8.0;
	return std::max(std::min(std::max(margin, min_fraction_of_cell * cell_size), division_margin), min_margin);
}

} // namespace thicket
