// The part of RowSet that finds the points in a rectangle.

#include "core/base/progress.hpp"
#include "core/rows/row_numbers.hpp"
#include "core/rows/row_set.hpp"
#include "core/rules/instance_random.hpp"

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

/// Number of points between two checks of the cancel flag.
constexpr std::size_t points_per_check = 2048;

/// Narrows the range of distances in which a ray may be inside a rectangle. The edges belong to the
/// rectangle, and rounding may widen it.
void clip(const Rect &rect, glm::dvec2 from, glm::dvec2 direction, double &r_first, double &r_last) {
	for (int axis = 0; axis < 2; ++axis) {
		if (direction[axis] == 0.0) {
			if (from[axis] < rect.min[axis] || from[axis] > rect.max[axis]) {
				r_last = r_first - 1.0;
			}
			continue;
		}
		const double a = (rect.min[axis] - from[axis]) / direction[axis];
		const double b = (rect.max[axis] - from[axis]) / direction[axis];
		r_first = std::max(r_first, std::min(a, b));
		r_last = std::min(r_last, std::max(a, b));
	}
}

} // namespace

/// Collects the points in a rectangle.
class RowSet::Collector {
public:
	Collector(const RowSet &rows, const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points,
			const std::atomic<bool> *cancel) :
			rows_(rows), set_(set), rect_(rect), points_(r_points), cancel_(cancel),
			near_{rect.min - rows.reach() - row_end_tolerance, rect.max + rows.reach() + row_end_tolerance} {}

	const Rect &near() const { return near_; }
	const Status &status() const { return status_; }

	/// Adds the points of a line or an area.
	void add_line(std::uint32_t line) {
		if (rows_.settings_.fills_areas) {
			add_area(line);
		} else {
			rows_.courses_[line]->visit_segments(near_, [&](std::uint32_t segment) { add_segment(line, segment); });
		}
	}

private:
	/// Adds the points of all rows on a segment.
	void add_segment(std::uint32_t line, std::uint32_t segment) {
		const RowCourse &course = *rows_.courses_[line];
		const double step = rows_.settings_.step;
		double first = course.length_at(segment);
		double last = course.length_at(segment + 1);
		const Spot start = course.spot_at(segment, 0.0);
		const glm::dvec2 from = course.point(segment) - start.direction * first;
		clip(near_, from, start.direction, first, last);
		// Rounding may exclude a step at either end, so one more is checked.
		const std::int64_t begin = limited(std::floor(first / step) - 1.0, 0, course.count());
		const std::int64_t end = limited(std::floor(last / step) + 2.0, 0, course.count());
		for (std::int64_t at = begin; at < end && status_.ok(); ++at) {
			if (course.segment_at(static_cast<double>(at) * step) != segment) {
				continue;
			}
			for (std::size_t row = 0; row < rows_.settings_.offsets.size(); ++row) {
				const Place place{line, static_cast<std::int64_t>(row), at};
				const std::uint64_t id = rows_.id_of(set_, place);
				add(id, rows_.position_of(set_, place, segment, id));
			}
		}
	}

	/// Adds the points of an area.
	void add_area(std::uint32_t line) {
		const RowCourse &course = *rows_.courses_[line];
		if (!meet(near_, course.bounds())) {
			return;
		}
		const Rect near = intersection(near_, course.bounds());
		const glm::dvec2 right = right_of(course.direction());
		const glm::dvec2 anchor = course.line()->anchor;
		const double distance = rows_.settings_.row_distance;
		const double step = rows_.settings_.step;
		double first_row = max_area_rows;
		double last_row = -first_row;
		for (const glm::dvec2 corner :
				{near.min, near.max, glm::dvec2(near.min.x, near.max.y), glm::dvec2(near.max.x, near.min.y)}) {
			const glm::dvec2 from_anchor = corner - anchor;
			const double row = (from_anchor.x * right.x + from_anchor.y * right.y) / distance;
			first_row = std::min(first_row, std::floor(row));
			last_row = std::max(last_row, std::ceil(row));
		}
		const std::int64_t end = limited(last_row, -middle_row, middle_row - 1);
		for (std::int64_t row = limited(first_row, -middle_row, middle_row - 1); row <= end && status_.ok(); ++row) {
			const glm::dvec2 from = anchor + right * (static_cast<double>(row) * distance);
			double first = -static_cast<double>(middle_step) * step;
			double last = -first;
			clip(near, from, course.direction(), first, last);
			// Rounding may exclude a step at either end, so one more is checked.
			const std::int64_t last_step = limited(std::floor(last / step) + 1.0, -middle_step, middle_step - 1);
			for (std::int64_t at = limited(std::floor(first / step) - 1.0, -middle_step, middle_step - 1);
					at <= last_step && status_.ok(); ++at) {
				const Place place{line, row, at};
				const std::uint64_t id = rows_.id_of(set_, place);
				add(id, rows_.position_in_area(set_, place, id));
			}
		}
	}

	void add(std::uint64_t id, const std::optional<glm::dvec2> &position) {
		if (++visited_ % points_per_check == 0 && is_cancelled(cancel_)) {
			status_ = {ErrorCode::cancelled, "rect", 0.0};
		} else if (position && rect_.contains(*position)) {
			points_.push_back({*position, id, instance_random(set_.seed, id, Draw::row)[0], 0});
			if (static_cast<double>(points_.size()) > max_points_per_call) {
				status_ = Status::too_many_points("rect", static_cast<double>(points_.size()), max_points_per_call);
			}
		}
	}

	const RowSet &rows_;
	const PointSet &set_;
	const Rect &rect_;
	std::vector<SamplePoint> &points_;
	const std::atomic<bool> *cancel_;
	Rect near_; ///< Contains the lines and places from which points may be displaced into the rectangle.
	std::size_t visited_ = 0;
	Status status_;
};

Status RowSet::sample(const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points,
		const std::atomic<bool> *cancel) const {
	if (!rect.finite()) {
		return {ErrorCode::not_finite, "rect", 0.0};
	}
	Collector collector(*this, set, rect, r_points, cancel);
	tree_.visit(collector.near(), [&](std::uint32_t line) { collector.add_line(line); });
	return collector.status();
}

} // namespace thicket
