#include "core/rows/row_set.hpp"

#include "core/base/bvh_order.hpp"
#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/base/instance_id.hpp"
#include "core/base/progress.hpp"
#include "core/rules/instance_random.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace thicket {

namespace {

/// Number of points between two checks of the cancel flag.
constexpr std::size_t points_per_check = 2048;

/// A row ends with a point if the end of its line is at most this many meters before it, because the
/// length of the line is rounded.
constexpr double end_tolerance = 1e-6;

/// On the inner side of a bend, a row may come this much nearer to its line than its offset. Points that
/// are even nearer are left out, because they stand in front of other points.
constexpr double nearest_part = 0.9;

/// Assumed distance between lines, in meters, for estimates.
constexpr double usual_line_distance = 5.0;

// The 48 bits of a place in an ID, from the highest: the upper bits of the line, the row, the lower bits
// of the line, and the step. Nearby points of an area thus have nearby values in both halves.
constexpr int step_bits = 16;
constexpr int row_bits = 14;
constexpr int low_line_bits = 8;
constexpr int line_bits = 18;
constexpr std::int64_t middle_row = max_area_rows / 2;
constexpr std::int64_t middle_step = max_row_points / 2;
static_assert(step_bits + row_bits + line_bits == id_layer_shift);
static_assert(max_row_points == 1 << step_bits && max_area_rows == 1 << row_bits);

constexpr std::uint64_t bits(std::uint64_t value, int first, int count) {
	return value >> first & ((std::uint64_t{1} << count) - 1);
}

glm::dvec2 right_of(glm::dvec2 direction) { return {-direction.y, direction.x}; }

Rect box_of(glm::dvec2 a, glm::dvec2 b) { return {glm::min(a, b), glm::max(a, b)}; }

Rect united(const Rect &a, const Rect &b) { return {glm::min(a.min, b.min), glm::max(a.max, b.max)}; }

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

/// Returns a number as an integer within limits.
std::int64_t limited(double value, std::int64_t min, std::int64_t max) {
	return static_cast<std::int64_t>(std::clamp(value, static_cast<double>(min), static_cast<double>(max)));
}

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

Status validate(const RowSettings &settings) {
	Status status = first_failure(check_range("step", settings.step, min_row_step, max_row_step),
			check_range("row_distance", settings.row_distance, min_row_step, max_row_step),
			check_range("row_angle_degrees", settings.row_angle_degrees, -360.0, 360.0),
			check_range("jitter_along", settings.jitter_along, 0.0, max_row_jitter),
			check_range("jitter_across", settings.jitter_across, 0.0, max_row_jitter),
			check_range("crossing_gap", settings.crossing_gap, 0.0, max_crossing_gap));
	if (status.ok() && settings.offsets.size() > max_row_offsets) {
		status = Status::wrong_size("offsets", settings.offsets.size(), at_most(max_row_offsets, "entries"));
	}
	for (std::size_t i = 0; status.ok() && i < settings.offsets.size(); ++i) {
		status = check_range("offsets", settings.offsets[i], -max_row_offset, max_row_offset);
	}
	return status;
}

double equivalent_radius(const RowSettings &settings) {
	const double across = settings.fills_areas ? settings.row_distance : std::max(settings.step, usual_line_distance);
	// The density of a set is inversely proportional to the square of its radius.
	return std::clamp(std::sqrt(point_density({.radius = 1.0}) * settings.step * across), min_radius, max_radius);
}

double RowSet::reach() const {
	const double displacement = settings_.jitter_along + settings_.jitter_across;
	double offset = 0.0;
	for (const double each : settings_.offsets) {
		offset = std::max(offset, std::abs(each));
	}
	return settings_.fills_areas ? displacement : displacement + offset;
}

Status RowSet::set(const RowSettings &settings, std::vector<RowLine> lines) {
	Status status = validate(settings);
	if (status.ok() && lines.size() > max_row_lines) {
		status = Status::wrong_size("rows.paths", lines.size(), at_most(max_row_lines, "paths"), "Use fewer paths");
	}
	if (!status.ok()) {
		return status;
	}
	return guarded("rows.paths", static_cast<double>(lines.size()), [&] {
		RowSet next;
		next.settings_ = settings;
		for (const RowLine &line : lines) {
			if (const Status added = next.add_course(line, next.courses_); !added.ok()) {
				return added;
			}
		}
		next.lines_ = std::move(lines);
		next.assign_keys();
		next.index_segments();
		*this = std::move(next);
		return Status();
	});
}

/// Computes the data of a line.
Status RowSet::add_course(const RowLine &line, std::vector<Course> &r_courses) const {
	if (const Status status = check_points(line); !status.ok()) {
		return status;
	}
	Course &course = r_courses.emplace_back();
	for (const glm::dvec2 point : line.points) {
		if (course.points.empty() || course.points.back() != point) {
			const glm::dvec2 along = course.points.empty() ? glm::dvec2(0.0) : point - course.points.back();
			const double before = course.lengths.empty() ? 0.0 : course.lengths.back();
			course.points.push_back(point);
			course.lengths.push_back(before + std::sqrt(along.x * along.x + along.y * along.y));
		}
	}
	if (course.points.size() < 2) {
		course = {};
		return {};
	}
	course.outline.set(course.points, settings_.fills_areas);
	course.bounds = box_of(course.points.front(), course.points.back());
	for (const glm::dvec2 point : course.points) {
		course.bounds = united(course.bounds, {point, point});
	}
	if (!settings_.fills_areas) {
		// The last point of a closed row keeps at least half a step from the first one.
		const bool closed = course.points.front() == course.points.back();
		const double length = course.lengths.back() + (closed ? -0.5 * settings_.step : end_tolerance);
		const double count = std::max(std::floor(length / settings_.step) + 1.0, 1.0);
		course.count = limited(count, 0, max_row_points);
		return check_range(
				"rows.step", count, at_most(max_row_points, "points in each row"), "Increase step, or divide the path");
	}
	const Rotation turn = rotation_by(settings_.row_angle_degrees / 360.0);
	course.direction = line.axis * turn.cosine + right_of(line.axis) * turn.sine;
	double farthest_step = 0.0;
	double farthest_row = 0.0;
	for (const glm::dvec2 point : course.points) {
		const glm::dvec2 from_anchor = point - line.anchor;
		const glm::dvec2 right = right_of(course.direction);
		farthest_step = std::max(
				farthest_step, std::abs(from_anchor.x * course.direction.x + from_anchor.y * course.direction.y));
		farthest_row = std::max(farthest_row, std::abs(from_anchor.x * right.x + from_anchor.y * right.y));
	}
	return first_failure(check_range("rows.step", std::floor(farthest_step / settings_.step),
								 at_most(middle_step - 1, "points from the path's origin to the end of a row"),
								 "Increase step, divide the area, or move the origin of the path into it"),
			check_range("rows.row_distance", std::floor(farthest_row / settings_.row_distance),
					at_most(middle_row - 1, "rows from the path's origin to the edge of the area"),
					"Increase row_distance, divide the area, or move the origin of the path into it"));
}

/// Assigns each line its number in IDs: the upper bits of its identity, or the next free number.
void RowSet::assign_keys() {
	constexpr std::uint32_t key_count = 1U << line_bits;
	std::vector<std::uint32_t> order(lines_.size());
	std::iota(order.begin(), order.end(), 0U);
	std::ranges::stable_sort(order, {}, [this](std::uint32_t line) { return lines_[line].identity; });
	std::vector<bool> taken(key_count);
	keys_.resize(lines_.size());
	for (const std::uint32_t line : order) {
		auto key = static_cast<std::uint32_t>(lines_[line].identity >> (64 - line_bits));
		while (taken[key]) {
			key = (key + 1) % key_count;
		}
		taken[key] = true;
		keys_[line] = key;
	}
	by_key_ = std::move(order);
	std::ranges::sort(by_key_, {}, [this](std::uint32_t line) { return keys_[line]; });
}

/// Builds the tree of all segments and finds the crossings. Areas need neither.
void RowSet::index_segments() {
	std::vector<Segment> listed;
	std::vector<BvhKey> order;
	for (std::uint32_t line = 0; line < courses_.size() && !settings_.fills_areas; ++line) {
		const std::vector<glm::dvec2> &points = courses_[line].points;
		for (std::uint32_t first = 0; first + 1 < points.size(); ++first) {
			order.push_back({0.5 * (points[first] + points[first + 1]), static_cast<std::uint32_t>(listed.size())});
			listed.push_back({line, first});
		}
	}
	tree_ = Bvh(listed.size());
	put_in_order(tree_, order);
	for (const BvhKey &key : order) {
		segments_.push_back(listed[key.item]);
	}
	boxes_.resize(tree_.nodes());
	tree_.each([this](Bvh::Node node) {
		Rect &box = boxes_[tree_.index_of(node)];
		if (node.level > 0) {
			box = boxes_[tree_.index_of(tree_.first(node))];
			if (tree_.has_second(node)) {
				box = united(box, boxes_[tree_.index_of(tree_.second(node))]);
			}
			return;
		}
		for (std::size_t i = tree_.begin(node); i < tree_.end(node); ++i) {
			const RowSegment ends = ends_of(segments_[i]);
			const Rect one = box_of(ends.from, ends.to);
			box = i == tree_.begin(node) ? one : united(box, one);
		}
	});
	if (settings_.crossing_gap > 0.0) {
		find_crossings();
	}
}

RowSegment RowSet::ends_of(const Segment &segment) const {
	const std::vector<glm::dvec2> &points = courses_[segment.line].points;
	const bool open = points.front() != points.back();
	return {points[segment.first], points[segment.first + 1], open && segment.first == 0,
			open && segment.first + 2 == points.size()};
}

/// Returns true if two segments share a point because one follows the other in their line.
bool RowSet::are_consecutive(const Segment &a, const Segment &b) const {
	const std::vector<glm::dvec2> &points = courses_[a.line].points;
	const std::uint32_t gap = std::max(a.first, b.first) - std::min(a.first, b.first);
	const bool closed = points.front() == points.back();
	return a.line == b.line && (gap == 1 || (closed && gap + 2 == points.size()));
}

/// Calls `visit` with the index of each segment that may touch a rectangle.
template <class Visit>
void RowSet::visit_segments(const Rect &rect, const Visit &visit) const {
	BvhStack<Bvh::Node> stack;
	if (!tree_.empty()) {
		stack.push(tree_.root());
	}
	while (!stack.empty()) {
		const Bvh::Node node = stack.pop();
		if (!meet(boxes_[tree_.index_of(node)], rect)) {
			continue;
		}
		if (node.level > 0) {
			stack.push(tree_.first(node));
			if (tree_.has_second(node)) {
				stack.push(tree_.second(node));
			}
			continue;
		}
		for (std::size_t i = tree_.begin(node); i < tree_.end(node); ++i) {
			visit(i);
		}
	}
}

void RowSet::find_crossings() {
	std::vector<glm::dvec2> crossings;
	for (std::size_t i = 0; i < segments_.size(); ++i) {
		const Segment &own = segments_[i];
		const RowSegment ends = ends_of(own);
		visit_segments(box_of(ends.from, ends.to), [&](std::size_t other) {
			if (other > i && !are_consecutive(own, segments_[other])) {
				if (const auto crossing = crossing_of(ends, ends_of(segments_[other]))) {
					crossings.push_back(*crossing);
				}
			}
		});
	}
	crossings_.set(std::move(crossings));
}

std::uint64_t RowSet::id_of(const PointSet &set, const Place &place) const {
	const std::uint64_t key = keys_[place.line];
	const std::int64_t row = place.row + (settings_.fills_areas ? middle_row : 0);
	const std::int64_t step = place.step + (settings_.fills_areas ? middle_step : 0);
	return std::uint64_t{set.layer} << id_layer_shift |
			(key >> low_line_bits) << (row_bits + low_line_bits + step_bits) |
			static_cast<std::uint64_t>(row) << (low_line_bits + step_bits) | bits(key, 0, low_line_bits) << step_bits |
			static_cast<std::uint64_t>(step);
}

/// Returns the place in an ID, if it may be that of a point.
std::optional<RowSet::Place> RowSet::place_of(std::uint64_t id) const {
	const std::uint64_t key = bits(id, row_bits + low_line_bits + step_bits, line_bits - low_line_bits)
					<< low_line_bits |
			bits(id, step_bits, low_line_bits);
	const auto found = std::ranges::lower_bound(by_key_, key, {}, [this](std::uint32_t line) { return keys_[line]; });
	if (found == by_key_.end() || keys_[*found] != key || courses_[*found].points.empty()) {
		return std::nullopt;
	}
	Place place{*found, static_cast<std::int64_t>(bits(id, low_line_bits + step_bits, row_bits)),
			static_cast<std::int64_t>(bits(id, 0, step_bits))};
	if (settings_.fills_areas) {
		place.row -= middle_row;
		place.step -= middle_step;
		return place;
	}
	const bool exists =
			static_cast<std::size_t>(place.row) < settings_.offsets.size() && place.step < courses_[place.line].count;
	return exists ? std::optional(place) : std::nullopt;
}

/// Returns the index of the first point of the segment that contains a step.
std::size_t RowSet::segment_at(const Course &course, std::int64_t step) const {
	const double along = static_cast<double>(step) * settings_.step;
	const auto after = std::ranges::upper_bound(course.lengths, along);
	const auto index = static_cast<std::size_t>(after - course.lengths.begin());
	return std::min(index, course.points.size() - 1) - 1;
}

RowSet::Spot RowSet::spot_at(const Course &course, std::size_t segment, std::int64_t step) const {
	const glm::dvec2 from = course.points[segment];
	const glm::dvec2 way = course.points[segment + 1] - from;
	const double length = std::sqrt(way.x * way.x + way.y * way.y);
	const double along = static_cast<double>(step) * settings_.step - course.lengths[segment];
	return {from + way * std::min(along / length, 1.0), way / length};
}

/// Returns the position of a point after its random displacement.
glm::dvec2 RowSet::displaced(const PointSet &set, std::uint64_t id, const Spot &spot) const {
	if (settings_.jitter_along == 0.0 && settings_.jitter_across == 0.0) {
		return spot.position;
	}
	const auto random = instance_random(set.seed, id, Draw::row);
	const double along = settings_.jitter_along * (2.0 * unit_interval(random[1]) - 1.0);
	const double across = settings_.jitter_across * (2.0 * unit_interval(random[2]) - 1.0);
	return spot.position + spot.direction * along + right_of(spot.direction) * across;
}

/// Returns the position of a place along a line, unless the rules of rows leave it out. `segment` is the
/// result of segment_at.
std::optional<glm::dvec2> RowSet::position_of(
		const PointSet &set, const Place &place, std::size_t segment, std::uint64_t id) const {
	const Course &course = courses_[place.line];
	const double offset = settings_.offsets[static_cast<std::size_t>(place.row)];
	Spot spot = spot_at(course, segment, place.step);
	spot.position += right_of(spot.direction) * offset;
	const double least = nearest_part * std::abs(offset);
	if (offset != 0.0 && course.outline.distance(spot.position, least) < least) {
		return std::nullopt;
	}
	const glm::dvec2 position = displaced(set, id, spot);
	if (settings_.crossing_gap > 0.0 && crossings_.is_near(position, settings_.crossing_gap)) {
		return std::nullopt;
	}
	return position;
}

/// Returns the position of a place in an area, if the area contains it.
std::optional<glm::dvec2> RowSet::position_in_area(const PointSet &set, const Place &place, std::uint64_t id) const {
	const Course &course = courses_[place.line];
	const glm::dvec2 right = right_of(course.direction);
	const Spot spot{lines_[place.line].anchor + course.direction * (static_cast<double>(place.step) * settings_.step) +
					right * (static_cast<double>(place.row) * settings_.row_distance),
			course.direction};
	return course.outline.contains(spot.position) ? std::optional(displaced(set, id, spot)) : std::nullopt;
}

std::optional<glm::dvec2> RowSet::position(const PointSet &set, std::uint64_t id) const {
	const std::optional<Place> place = place_of(id);
	if (!place) {
		return std::nullopt;
	}
	return settings_.fills_areas ? position_in_area(set, *place, id)
								 : position_of(set, *place, segment_at(courses_[place->line], place->step), id);
}

Rotation RowSet::heading(std::uint64_t id) const {
	const std::optional<Place> place = place_of(id);
	if (!place) {
		return {};
	}
	const Course &course = courses_[place->line];
	const glm::dvec2 direction = settings_.fills_areas
			? course.direction
			: spot_at(course, segment_at(course, place->step), place->step).direction;
	return {-direction.y, -direction.x};
}

/// Collects the points in a rectangle.
class RowSet::Collector {
public:
	Collector(const RowSet &rows, const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points,
			const std::atomic<bool> *cancel) :
			rows_(rows), set_(set), rect_(rect), points_(r_points), cancel_(cancel),
			near_{rect.min - rows.reach() - end_tolerance, rect.max + rows.reach() + end_tolerance} {}

	const Rect &near() const { return near_; }
	const Status &status() const { return status_; }

	/// Adds the points of all rows on a segment.
	void add_segment(const Segment &segment) {
		const Course &course = rows_.courses_[segment.line];
		const double step = rows_.settings_.step;
		double first = course.lengths[segment.first];
		double last = course.lengths[segment.first + 1];
		const Spot start = rows_.spot_at(course, segment.first, 0);
		const glm::dvec2 from = course.points[segment.first] - start.direction * first;
		clip(near_, from, start.direction, first, last);
		// Rounding may exclude a step at either end, so one more is checked.
		const std::int64_t begin = limited(std::floor(first / step) - 1.0, 0, course.count);
		const std::int64_t end = limited(std::floor(last / step) + 2.0, 0, course.count);
		for (std::int64_t at = begin; at < end && status_.ok(); ++at) {
			if (rows_.segment_at(course, at) != segment.first) {
				continue;
			}
			for (std::size_t row = 0; row < rows_.settings_.offsets.size(); ++row) {
				const Place place{segment.line, static_cast<std::int64_t>(row), at};
				const std::uint64_t id = rows_.id_of(set_, place);
				add(id, rows_.position_of(set_, place, segment.first, id));
			}
		}
	}

	/// Adds the points of an area.
	void add_area(std::uint32_t line) {
		const Course &course = rows_.courses_[line];
		const Rect near = intersection(near_, course.bounds);
		if (course.points.empty() || !meet(near_, course.bounds)) {
			return;
		}
		const glm::dvec2 right = right_of(course.direction);
		const glm::dvec2 anchor = rows_.lines_[line].anchor;
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
			clip(near, from, course.direction, first, last);
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

private:
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
	if (settings_.fills_areas) {
		for (std::uint32_t line = 0; line < courses_.size() && collector.status().ok(); ++line) {
			collector.add_area(line);
		}
	} else {
		visit_segments(collector.near(), [&](std::size_t i) { collector.add_segment(segments_[i]); });
	}
	return collector.status();
}

} // namespace thicket
