#include "core/rows/row_course.hpp"

#include "core/base/check.hpp"
#include "core/base/trigonometry.hpp"
#include "core/rows/row_numbers.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace thicket {

namespace {

Status check_points(const RowLine &line) {
	for (const glm::dvec2 point : line.points) {
		for (const double coordinate : {point.x, point.y}) {
			const Status status = check_range("rows.paths", coordinate,
					between(-max_row_coordinate, max_row_coordinate, "meters from the origin"), "Move the path");
			if (!status.ok()) {
				return status;
			}
		}
	}
	return {};
}

} // namespace

Status RowCourse::set(const RowSettings &settings, SharedRowLine line) {
	if (const Status status = check_points(*line); !status.ok()) {
		return status;
	}
	RowCourse next;
	next.line_ = std::move(line);
	for (const glm::dvec2 point : next.line_->points) {
		if (next.points_.empty() || next.points_.back() != point) {
			const glm::dvec2 along = next.points_.empty() ? glm::dvec2(0.0) : point - next.points_.back();
			const double before = next.lengths_.empty() ? 0.0 : next.lengths_.back();
			next.points_.push_back(point);
			next.lengths_.push_back(before + std::sqrt(along.x * along.x + along.y * along.y));
		}
	}
	Status status;
	if (next.points_.size() < 2) {
		next.points_.clear();
	} else {
		next.outline_.set(next.points_, settings.fills_areas);
		next.bounds_ = {next.points_.front(), next.points_.front()};
		for (const glm::dvec2 point : next.points_) {
			next.bounds_ = united(next.bounds_, {point, point});
		}
		status = settings.fills_areas ? next.set_direction(settings) : next.set_count(settings);
	}
	if (status.ok()) {
		*this = std::move(next);
	}
	return status;
}

/// Computes the number of points along the line, and indexes its segments.
Status RowCourse::set_count(const RowSettings &settings) {
	std::vector<std::uint32_t> numbers(segments());
	std::iota(numbers.begin(), numbers.end(), 0U);
	std::vector<Rect> boxes;
	for (const std::uint32_t segment : numbers) {
		boxes.push_back(box_of(segment));
	}
	tree_.set(std::move(numbers), boxes);
	// The last point of a closed row keeps at least half a step from the first one.
	const double length = lengths_.back() + (is_closed() ? -0.5 * settings.step : row_end_tolerance);
	const double count = std::max(std::floor(length / settings.step) + 1.0, 1.0);
	count_ = limited(count, 0, max_row_points);
	return check_range(
			"rows.step", count, at_most(max_row_points, "points in each row"), "Increase step, or divide the path");
}

/// Computes the direction of the rows of an area.
Status RowCourse::set_direction(const RowSettings &settings) {
	const Rotation turn = rotation_by(settings.row_angle_degrees / 360.0);
	direction_ = line_->axis * turn.cosine + right_of(line_->axis) * turn.sine;
	const glm::dvec2 right = right_of(direction_);
	double farthest_step = 0.0;
	double farthest_row = 0.0;
	for (const glm::dvec2 point : points_) {
		const glm::dvec2 from_anchor = point - line_->anchor;
		farthest_step = std::max(farthest_step, std::abs(from_anchor.x * direction_.x + from_anchor.y * direction_.y));
		farthest_row = std::max(farthest_row, std::abs(from_anchor.x * right.x + from_anchor.y * right.y));
	}
	return first_failure(check_range("rows.step", std::floor(farthest_step / settings.step),
								 at_most(middle_step - 1, "points from the path's origin to the end of a row"),
								 "Increase step, divide the area, or move the origin of the path into it"),
			check_range("rows.row_distance", std::floor(farthest_row / settings.row_distance),
					at_most(middle_row - 1, "rows from the path's origin to the edge of the area"),
					"Increase row_distance, divide the area, or move the origin of the path into it"));
}

std::size_t RowCourse::segment_at(double along) const {
	const auto after = std::ranges::upper_bound(lengths_, along);
	return std::min(static_cast<std::size_t>(after - lengths_.begin()), points_.size() - 1) - 1;
}

RowCourse::Spot RowCourse::spot_at(std::size_t segment, double along) const {
	const glm::dvec2 from = points_[segment];
	const glm::dvec2 way = points_[segment + 1] - from;
	const double length = std::sqrt(way.x * way.x + way.y * way.y);
	const double on_segment = along - lengths_[segment];
	return {from + way * std::min(on_segment / length, 1.0), way / length};
}

RowSegment RowCourse::ends_of(std::size_t segment) const {
	const bool open = !is_closed();
	return {points_[segment], points_[segment + 1], open && segment == 0, open && segment + 1 == segments()};
}

Rect RowCourse::box_of(std::size_t segment) const {
	return {glm::min(points_[segment], points_[segment + 1]), glm::max(points_[segment], points_[segment + 1])};
}

bool RowCourse::are_consecutive(std::size_t a, std::size_t b) const {
	const std::size_t gap = std::max(a, b) - std::min(a, b);
	return gap == 1 || (is_closed() && gap + 1 == segments());
}

} // namespace thicket
