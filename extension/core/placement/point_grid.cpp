#include "core/placement/point_grid.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

/// Maximum number of cells on each side. With more cells, most would be empty.
constexpr double max_cells_on_side = 2048.0;

/// Minimum cell size in mean point spacings. Evenly distributed points then number about four per
/// cell.
constexpr double spacings_per_cell = 2.0;

/// If the search area has at most this many cells on each side, all of them are searched, because
/// visiting them by distance would cost more than it saves.
constexpr int few_cells = 6;

glm::dvec2 from_above(glm::dvec2 position) { return position; }
glm::dvec2 from_above(const glm::dvec3 &position) { return {position.x, position.z}; }

double squared_distance(glm::dvec2 a, glm::dvec2 b) {
	const glm::dvec2 offset = a - b;
	return offset.x * offset.x + offset.y * offset.y;
}
double squared_distance(const glm::dvec3 &a, const glm::dvec3 &b) {
	const glm::dvec3 offset = a - b;
	return offset.x * offset.x + offset.y * offset.y + offset.z * offset.z;
}

} // namespace

template <class Point>
glm::ivec2 PointGrid<Point>::cell_of(glm::dvec2 position) const {
	const glm::dvec2 cell = glm::floor((position - area_.min) * cells_per_meter_);
	return glm::ivec2(glm::clamp(cell, glm::dvec2(0.0), glm::dvec2(cells_ - 1)));
}

template <class Point>
void PointGrid<Point>::set(std::span<const Point> points, const Rect &area, double cell_size) {
	area_ = area;
	const glm::dvec2 size = area.size();
	const double spacing = std::sqrt(size.x * size.y / std::max(1.0, static_cast<double>(points.size())));
	cells_per_meter_ = std::min(std::max(1.0 / cell_size, 1.0 / (spacings_per_cell * spacing)),
			max_cells_on_side / std::max(size.x, size.y));
	cells_ = glm::ivec2(glm::ceil(size * cells_per_meter_)) + 1;
	const auto count = static_cast<std::size_t>(cells_.x) * static_cast<std::size_t>(cells_.y);
	begin_.assign(count + 1, 0);
	const auto index = [this](const Point &position) {
		const glm::ivec2 cell = cell_of(from_above(position));
		return static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(cells_.x) + static_cast<std::size_t>(cell.x);
	};
	for (const Point &point : points) {
		++begin_[index(point)];
	}
	std::uint32_t end = 0;
	for (std::uint32_t &begin : begin_) {
		end += begin;
		begin = end;
	}
	// Each cell is filled from its end, so that every entry finally is the beginning of its cell.
	points_.resize(points.size());
	for (const Point &point : points) {
		points_[--begin_[index(point)]] = point;
	}
}

/// Returns the minimum of `nearest` and the squared distances to the points in the cells `first` to
/// `last` of row `y`.
template <class Point>
double PointGrid<Point>::nearest_in_row(const Point &position, int y, int first, int last, double nearest) const {
	const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_.x);
	const std::uint32_t begin = begin_[row + static_cast<std::size_t>(first)];
	const std::uint32_t end = begin_[row + static_cast<std::size_t>(last) + 1];
	for (std::uint32_t i = begin; i < end; ++i) {
		nearest = std::min(nearest, squared_distance(points_[i], position));
	}
	return nearest;
}

/// Returns the minimum of `nearest` and the squared distances to the points in the cells from
/// `first` to `last`. The search proceeds outward in rings, and stops once no remaining ring can
/// contain a nearer point.
template <class Point>
double PointGrid<Point>::nearest_outwards(
		const Point &position, glm::ivec2 first, glm::ivec2 last, double nearest) const {
	const glm::ivec2 center_cell = cell_of(from_above(position));
	const glm::ivec2 farthest = glm::max(center_cell - first, last - center_cell);
	for (int ring = 0; ring <= std::max(farthest.x, farthest.y); ++ring) {
		// The distance, in cells, to points in a ring is at least one less than the ring's number.
		// One more cell is subtracted to cover rounding.
		const double min_distance = static_cast<double>(ring - 2) / cells_per_meter_;
		if (ring > 2 && min_distance * min_distance >= nearest) {
			// No remaining ring can contain a nearer point.
			break;
		}
		const glm::ivec2 low = glm::max(center_cell - ring, first);
		const glm::ivec2 high = glm::min(center_cell + ring, last);
		for (int y = low.y; y <= high.y; ++y) {
			if (y == center_cell.y - ring || y == center_cell.y + ring) {
				nearest = nearest_in_row(position, y, low.x, high.x, nearest);
				continue;
			}
			if (center_cell.x - ring >= first.x) {
				nearest = nearest_in_row(position, y, center_cell.x - ring, center_cell.x - ring, nearest);
			}
			if (center_cell.x + ring <= last.x) {
				nearest = nearest_in_row(position, y, center_cell.x + ring, center_cell.x + ring, nearest);
			}
		}
	}
	return nearest;
}

template <class Point>
double PointGrid<Point>::nearest_squared(const Point &position, double distance) const {
	double nearest = distance * distance;
	if (points_.empty()) {
		// There are no points.
		return nearest;
	}
	// The range includes one additional cell on each side to cover rounding, which costs little.
	const glm::ivec2 first = glm::max(cell_of(from_above(position) - distance) - 1, glm::ivec2(0));
	const glm::ivec2 last = glm::min(cell_of(from_above(position) + distance) + 1, cells_ - 1);
	if (last.x - first.x >= few_cells || last.y - first.y >= few_cells) {
		// If there are many cells, those farther away than the nearest point are skipped.
		return nearest_outwards(position, first, last, nearest);
	}
	for (int y = first.y; y <= last.y; ++y) {
		nearest = nearest_in_row(position, y, first.x, last.x, nearest);
	}
	return nearest;
}

template class PointGrid<glm::dvec2>;
template class PointGrid<glm::dvec3>;

} // namespace thicket
