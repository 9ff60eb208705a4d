#include "core/placement/point_grid.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

/// More cells than this help nobody: they would be empty.
constexpr double max_cells_on_side = 2048.0;

} // namespace

glm::ivec2 PointGrid::cell_of(glm::dvec2 position) const {
	const glm::dvec2 cell = glm::floor((position - area_.min) * cells_per_meter_);
	return glm::ivec2(glm::clamp(cell, glm::dvec2(0.0), glm::dvec2(cells_ - 1)));
}

void PointGrid::set(std::span<const glm::dvec2> points, const Rect &area, double cell_size) {
	area_ = area;
	const glm::dvec2 size = area.size();
	cells_per_meter_ = std::min(1.0 / cell_size, max_cells_on_side / std::max(size.x, size.y));
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
	// Filled from the end of each cell, so that in the end every entry says where its cell begins.
	points_.resize(points.size());
	for (const glm::dvec2 point : points) {
		points_[--begin_[index(point)]] = point;
	}
}

double PointGrid::nearest_squared(glm::dvec2 position, double distance) const {
	double nearest = distance * distance;
	if (points_.empty()) {
		return nearest;
	}
	// A cell more than the distance needs on each side costs little and leaves no question about rounding.
	const glm::ivec2 first = glm::max(cell_of(position - distance) - 1, glm::ivec2(0));
	const glm::ivec2 last = glm::min(cell_of(position + distance) + 1, cells_ - 1);
	for (int y = first.y; y <= last.y; ++y) {
		const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_.x);
		const std::uint32_t begin = begin_[row + static_cast<std::size_t>(first.x)];
		const std::uint32_t end = begin_[row + static_cast<std::size_t>(last.x) + 1];
		for (std::uint32_t i = begin; i < end; ++i) {
			const glm::dvec2 apart = points_[i] - position;
			nearest = std::min(nearest, apart.x * apart.x + apart.y * apart.y);
		}
	}
	return nearest;
}

} // namespace thicket
