#include "core/rows/row_edits.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

namespace thicket {

namespace {

/// Maximum number of areas for one line, and for all lines. Beyond the latter, everything is regenerated.
constexpr std::size_t most_areas_of_line = 32;
constexpr std::size_t most_areas = 1024;

/// Expands all areas, in meters, because the area of a straight line would be empty.
constexpr double least_margin = 0.01;

using Points = std::span<const glm::dvec2>;

Rect bounds_of(Points points) {
	Rect bounds{points.front(), points.front()};
	for (const glm::dvec2 point : points) {
		bounds = {glm::min(bounds.min, point), glm::max(bounds.max, point)};
	}
	return bounds;
}

/// Appends the areas along a polyline, each expanded by `distance`.
void add_along(Points points, double distance, std::vector<Rect> &r_areas) {
	const std::size_t length = std::max<std::size_t>((points.size() + most_areas_of_line - 1) / most_areas_of_line, 1);
	for (std::size_t first = 0; first < points.size(); first += length) {
		// Consecutive parts share a point, so that no segment is missing.
		const Rect bounds = bounds_of(points.subspan(first, std::min(length + 1, points.size() - first)));
		r_areas.push_back(expanded(bounds, distance));
	}
}

/// Returns the number of points at the start of two lines that are equal.
std::size_t common_start(Points a, Points b) {
	return static_cast<std::size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
}

/// Returns the points of a line from the last one before the first difference.
Points changed_end(Points points, std::size_t common) {
	return points.subspan(common > 0 && common <= points.size() ? common - 1 : 0);
}

/// Returns the number of points at the end of two lines that are equal, beyond those at their start.
std::size_t common_end(Points a, Points b, std::size_t start) {
	std::size_t count = 0;
	const std::size_t most = std::min(a.size(), b.size()) - start;
	while (count < most && a[a.size() - 1 - count] == b[b.size() - 1 - count]) {
		++count;
	}
	return count;
}

/// Returns the points of an outline with the first one repeated at the end.
std::vector<glm::dvec2> closed_outline(const RowLine &line) {
	std::vector<glm::dvec2> points = line.points;
	if (!points.empty() && points.front() != points.back()) {
		points.push_back(line.points.front());
	}
	return points;
}

/// Appends the area around the changed parts of two outlines. It contains every position that is inside
/// only one of them.
void add_between(const RowLine &before, const RowLine &after, double distance, std::vector<Rect> &r_areas) {
	const std::vector<glm::dvec2> was = closed_outline(before);
	const std::vector<glm::dvec2> is = closed_outline(after);
	const bool same_grid = before.anchor == after.anchor && before.axis == after.axis;
	const std::size_t start = same_grid ? common_start(was, is) : 0;
	const std::size_t end = same_grid ? common_end(was, is, start) : 0;
	std::vector<glm::dvec2> changed;
	for (const std::vector<glm::dvec2> &points : {was, is}) {
		// Edges that end at a changed point have changed as well.
		const std::size_t first = start > 0 ? start - 1 : 0;
		const std::size_t last = std::min(points.size(), points.size() - end + 1);
		for (std::size_t i = first; i < last; ++i) {
			changed.push_back(points[i]);
		}
	}
	if (!changed.empty()) {
		const Rect bounds = bounds_of(changed);
		r_areas.push_back(expanded(bounds, distance));
	}
}

} // namespace

bool find_row_edits(const RowSet *before, const RowSet *after, std::vector<Rect> &r_areas) {
	if (before == after) {
		return true;
	}
	if (before == nullptr || after == nullptr || before->settings() != after->settings()) {
		return false;
	}
	static const RowLine none;
	struct Pair {
		const RowLine *was = &none;
		const RowLine *is = &none;
		std::uint32_t key_before = 0;
		std::uint32_t key_after = 0;
	};
	// Most lines are the same object in both sets, and need no comparison.
	const auto is_same = [before, after](std::size_t i) {
		return i < before->line_count() && i < after->line_count() && before->line(i) == after->line(i) &&
				before->key(i) == after->key(i);
	};
	std::map<std::uint64_t, Pair> pairs;
	for (std::size_t i = 0; i < before->line_count(); ++i) {
		if (is_same(i)) {
			continue;
		}
		Pair &pair = pairs[before->line(i)->identity];
		pair.was = before->line(i).get();
		pair.key_before = before->key(i);
	}
	for (std::size_t i = 0; i < after->line_count(); ++i) {
		if (is_same(i)) {
			continue;
		}
		Pair &pair = pairs[after->line(i)->identity];
		pair.is = after->line(i).get();
		pair.key_after = after->key(i);
	}
	const RowSettings &settings = after->settings();
	// A changed line affects the points of its rows, and points near its crossings, which may lie beyond its ends.
	const double distance = least_margin + 2.0 * (after->reach() + settings.crossing_gap);
	for (const auto &[identity, pair] : pairs) {
		if (pair.was != &none && pair.is != &none && pair.key_before != pair.key_after) {
			return false; // All points of the line have new IDs.
		}
		if (pair.was == pair.is || *pair.was == *pair.is) {
			continue;
		}
		if (settings.fills_areas) {
			add_between(*pair.was, *pair.is, distance, r_areas);
		} else {
			const std::size_t common = common_start(pair.was->points, pair.is->points);
			add_along(changed_end(pair.was->points, common), distance, r_areas);
			add_along(changed_end(pair.is->points, common), distance, r_areas);
		}
	}
	return r_areas.size() <= most_areas;
}

} // namespace thicket
