#include "core/placement/point_grid.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

/// More cells than this do not help, because they would be empty.
constexpr double max_cells_on_side = 2048.0;

/// If points are evenly spread, a cell holds at most four of them.
constexpr double spacings_per_cell = 2.0;

/// If there are at most this many cells on a side, all of them are searched: visiting them by distance would cost more than it saves.
constexpr int few_cells = 6;

} // namespace

glm::ivec2 PointGrid::cell_of(glm::dvec2 position) const {
	const glm::dvec2 cell = glm::floor((position - area_.min) * cells_per_meter_);
	return glm::ivec2(glm::clamp(cell, glm::dvec2(0.0), glm::dvec2(cells_ - 1)));
}

void PointGrid::set(std::span<const glm::dvec2> points, const Rect &area, double cell_size) {
	area_ = area;
	const glm::dvec2 size = area.size();
	const double spacing = std::sqrt(size.x * size.y / std::max(1.0, static_cast<double>(points.size())));
	cells_per_meter_ = std::min(std::max(1.0 / cell_size, 1.0 / (spacings_per_cell * spacing)),
			max_cells_on_side / std::max(size.x, size.y));
	cells_ = glm::ivec2(glm::ceil(size * cells_per_meter_)) + 1;
	const auto count = static_cast<std::size_t>(cells_.x) * static_cast<std::size_t>(cells_.y);
	begin_.assign(count + 1, 0);
	const auto index = [this](glm::dvec2 position) {
		const glm::ivec2 cell = cell_of(position);
		return static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(cells_.x) + static_cast<std::size_t>(cell.x);
	};
	for (const glm::dvec2 point : points) {
		++begin_[index(point)];
	}
	std::uint32_t end = 0;
	for (std::uint32_t &begin : begin_) {
		end += begin;
		begin = end;
	}
	// Filled from the end of each cell, so that finally every entry is the begin of its cell.
	points_.resize(points.size());
	for (const glm::dvec2 point : points) {
		points_[--begin_[index(point)]] = point;
	}
}

/// The smaller of `nearest` and the squared distances to the points of some cells of a row.
double PointGrid::nearest_in_row(glm::dvec2 position, int y, int first, int last, double nearest) const {
	const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_.x);
	const std::uint32_t begin = begin_[row + static_cast<std::size_t>(first)];
	const std::uint32_t end = begin_[row + static_cast<std::size_t>(last) + 1];
	for (std::uint32_t i = begin; i < end; ++i) {
		const glm::dvec2 apart = points_[i] - position;
		nearest = std::min(nearest, apart.x * apart.x + apart.y * apart.y);
	}
	return nearest;
}

/// Returns the smaller of `nearest` and the squared distances to the points of the cells from `first` to `last`. Stops
/// once no further ring of cells can be nearer.
double PointGrid::nearest_outwards(glm::dvec2 position, glm::ivec2 first, glm::ivec2 last, double nearest) const {
	const glm::ivec2 own = cell_of(position);
	const glm::ivec2 most = glm::max(own - first, last - own);
	for (int ring = 0; ring <= std::max(most.x, most.y); ++ring) {
		// Points in this ring may be one cell nearer than its number. One more cell covers rounding.
		const double beyond = static_cast<double>(ring - 2) / cells_per_meter_;
		if (ring > 2 && beyond * beyond >= nearest) {
			// No further ring holds a nearer point.
			break;
		}
		const glm::ivec2 low = glm::max(own - ring, first);
		const glm::ivec2 high = glm::min(own + ring, last);
		for (int y = low.y; y <= high.y; ++y) {
			if (y == own.y - ring || y == own.y + ring) {
				nearest = nearest_in_row(position, y, low.x, high.x, nearest);
				continue;
			}
			if (own.x - ring >= first.x) {
				nearest = nearest_in_row(position, y, own.x - ring, own.x - ring, nearest);
			}
			if (own.x + ring <= last.x) {
				nearest = nearest_in_row(position, y, own.x + ring, own.x + ring, nearest);
			}
		}
	}
	return nearest;
}

double PointGrid::nearest_squared(glm::dvec2 position, double distance) const {
	double nearest = distance * distance;
	if (points_.empty()) {
		// No cell holds a point.
		return nearest;
	}
	// One more cell on each side than the distance requires costs little and covers rounding.
	const glm::ivec2 first = glm::max(cell_of(position - distance) - 1, glm::ivec2(0));
	const glm::ivec2 last = glm::min(cell_of(position + distance) + 1, cells_ - 1);
	if (last.x - first.x >= few_cells || last.y - first.y >= few_cells) {
		// Among many cells, those that are farther away than a point need not be searched.
		return nearest_outwards(position, first, last, nearest);
	}
	for (int y = first.y; y <= last.y; ++y) {
		nearest = nearest_in_row(position, y, first.x, last.x, nearest);
	}
	return nearest;
}

} // namespace thicket
