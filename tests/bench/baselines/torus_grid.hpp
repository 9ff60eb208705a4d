#pragma once

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket::bench {

/// Finds the neighbors of a position on the torus [0, side)^2 among points that are at least 1
/// apart. Square cells slightly more than two units wide store the points themselves, so that
/// checking a cell reads only a few cache lines.
class TorusGrid {
public:
	/// The minimum width of a cell: more than twice the distance at which boundary sampling
	/// generates points.
	static constexpr double min_cell = 2.0 + 1e-8;

	/// The minimum side of a torus on which a neighborhood of two cells does not overlap itself.
	static constexpr double min_side = 11.0;

	/// Empties the grid. `side` must be at least `min_side`.
	void reset(double side) {
		side_ = side;
		half_side_ = 0.5 * side;
		columns_ = static_cast<int>(side / min_cell);
		per_cell_ = columns_ / side;
		cells_.clear();
		cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(columns_));
	}

	/// Adds a point of the torus. It must be at least 1 from all points that were added before.
	void insert(std::uint32_t index, glm::dvec2 point) {
		Cell &cell = cells_[row_of(column_of(point.y)) + static_cast<std::size_t>(column_of(point.x))];
		cell.indices[cell.count] = index;
		cell.points[cell.count] = point;
		++cell.count;
	}

	/// Calls `visit(index, offset)` for every point in the cells up to `reach` cells from the cell
	/// of `position`. This includes all points up to `reach` * `min_cell` away. `offset` is the
	/// shortest vector from `position` to the point.
	template <typename Visit>
	void visit(glm::dvec2 position, int cell_radius, const Visit &visit) const {
		const int column = column_of(position.x);
		const int row = column_of(position.y);
		for (int y = row - cell_radius; y <= row + cell_radius; ++y) {
			const std::size_t begin = row_of(wrap_column(y));
			for (int x = column - cell_radius; x <= column + cell_radius; ++x) {
				const Cell &cell = cells_[begin + static_cast<std::size_t>(wrap_column(x))];
				for (std::uint32_t i = 0; i < cell.count; ++i) {
					visit(cell.indices[i], offset(position, cell.points[i]));
				}
			}
		}
	}

	/// Wraps a position that is at most one side outside the torus.
	glm::dvec2 wrap(glm::dvec2 position) const { return {wrap(position.x), wrap(position.y)}; }

private:
	/// The maximum number of points in a cell. A square of width w has at most (2 / sqrt(3)) w^2 +
	/// 2 w + 1 points at distance 1 (Oler 1961), and w < 2.41 if there are at least five cells per
	/// side.
	static constexpr std::size_t max_points = 12;

	struct alignas(64) Cell {
		std::uint32_t count = 0;
		std::array<std::uint32_t, max_points> indices;
		alignas(64) std::array<glm::dvec2, max_points> points;
	};

	double side_ = 0.0;
	double half_side_ = 0.0;
	double per_cell_ = 0.0;
	int columns_ = 0;
	std::vector<Cell> cells_;

	int column_of(double coordinate) const { return glm::min(static_cast<int>(coordinate * per_cell_), columns_ - 1); }

	int wrap_column(int column) const {
		return column < 0 ? column + columns_ : column >= columns_ ? column - columns_ : column;
	}

	std::size_t row_of(int row) const { return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_); }

	double shortest(double difference) const {
		return difference > half_side_     ? difference - side_
				: difference < -half_side_ ? difference + side_
										   : difference;
	}

	glm::dvec2 offset(glm::dvec2 from, glm::dvec2 target) const {
		return {shortest(target.x - from.x), shortest(target.y - from.y)};
	}

	double wrap(double coordinate) const {
		const double wrapped = coordinate < 0.0 ? coordinate + side_
				: coordinate >= side_           ? coordinate - side_
												: coordinate;
		// A tiny negative coordinate rounds up to the side itself.
		return wrapped < side_ ? wrapped : 0.0;
	}
};

} // namespace thicket::bench
