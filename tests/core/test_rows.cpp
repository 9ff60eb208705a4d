// Tests the points of rows along lines and over areas.

#include "core/base/instance_id.hpp"
#include "core/rows/row_edits.hpp"
#include "core/rows/row_set.hpp"
#include "refusal.hpp"
#include "tilings.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <utility>
#include <vector>

using namespace thicket;

namespace {

constexpr PointSet set_of_rows{.seed = 77, .radius = 2.0, .levels = 1, .layer = 5, .in_rows = true};
constexpr Rect everywhere{{-1e6, -1e6}, {1e6, 1e6}};

/// Returns an identity whose upper bits, which IDs contain, differ between small numbers.
constexpr std::uint64_t identity_of(std::uint64_t index) { return index * 0x9e3779b97f4a7c15; }

/// A winding line of 400 m.
RowLine winding_line(std::uint64_t index, glm::dvec2 from = {0.0, 0.0}) {
	RowLine line{.identity = identity_of(index), .points = {}, .anchor = from};
	for (int i = 0; i <= 800; ++i) {
		const double x = 0.5 * i;
		line.points.push_back(from + glm::dvec2(x, 30.0 * std::sin(x / 40.0)));
	}
	return line;
}

RowLine line_through(std::uint64_t index, std::vector<glm::dvec2> points) {
	return {.identity = identity_of(index), .points = std::move(points)};
}

/// Returns a line along all edges of a square.
RowLine square_line(std::uint64_t index, glm::dvec2 min, double side) {
	return line_through(
			index, {min, min + glm::dvec2(side, 0.0), min + glm::dvec2(side), min + glm::dvec2(0.0, side), min});
}

RowSet rows_of(const RowSettings &settings, std::vector<RowLine> lines) {
	RowSet rows;
	const Status status = rows.set(settings, std::move(lines));
	REQUIRE_MESSAGE(status.ok(), describe(status));
	return rows;
}

std::vector<SamplePoint> sorted(std::vector<SamplePoint> points) {
	std::ranges::sort(points, {}, &SamplePoint::id);
	return points;
}

std::vector<SamplePoint> points_of(const RowSet &rows, const Rect &rect = everywhere) {
	std::vector<SamplePoint> points;
	REQUIRE(rows.sample(set_of_rows, rect, points).ok());
	return sorted(points);
}

std::map<std::uint64_t, glm::dvec2> by_id(const std::vector<SamplePoint> &points) {
	std::map<std::uint64_t, glm::dvec2> result;
	for (const SamplePoint &point : points) {
		result[point.id] = point.position;
	}
	REQUIRE(result.size() == points.size());
	return result;
}

/// Returns settings that use random displacements.
RowSettings jittered() {
	RowSettings settings;
	settings.step = 1.7;
	settings.offsets = {-4.0, 0.0, 3.5};
	settings.jitter_along = 0.6;
	settings.jitter_across = 0.9;
	settings.crossing_gap = 5.0;
	return settings;
}

} // namespace

TEST_CASE("rows: points lie at even steps along a line, up to its end") {
	const RowSet rows = rows_of({.step = 2.5}, {line_through(1, {{0, 0}, {3, 4}, {3, 14}, {-2, 14}})}); // 20 m
	const std::vector<SamplePoint> points = points_of(rows);
	const std::vector<glm::dvec2> expected{
			{0, 0}, {1.5, 2}, {3, 4}, {3, 6.5}, {3, 9}, {3, 11.5}, {3, 14}, {0.5, 14}, {-2, 14}};
	REQUIRE(points.size() == expected.size());
	for (std::size_t i = 0; i < expected.size(); ++i) {
		CHECK(glm::distance(points[i].position, expected[i]) < 1e-6);
	}
}

TEST_CASE("rows: the steps along a curve are as long as the line between them") {
	const RowLine line = winding_line(1);
	const RowSet rows = rows_of({.step = 3.0}, {line});
	std::vector<double> lengths{0.0};
	for (std::size_t i = 1; i < line.points.size(); ++i) {
		lengths.push_back(lengths.back() + glm::distance(line.points[i - 1], line.points[i]));
	}
	const std::vector<SamplePoint> points = points_of(rows);
	REQUIRE(points.size() == static_cast<std::size_t>(lengths.back() / 3.0) + 1);
	for (std::size_t step = 0; step < points.size(); ++step) {
		const double row_distance = 3.0 * static_cast<double>(step);
		const auto at = static_cast<std::size_t>(std::ranges::upper_bound(lengths, row_distance) - lengths.begin()) - 1;
		const double fraction = (row_distance - lengths[at]) / (lengths[at + 1] - lengths[at]);
		CHECK(glm::distance(points[step].position, glm::mix(line.points[at], line.points[at + 1], fraction)) < 1e-6);
	}
}

TEST_CASE("rows: a closed line has no two points closer than half a step at its start") {
	for (const double step : {2.0, 3.0, 7.0, 23.0}) {
		const std::vector<SamplePoint> points = points_of(rows_of({.step = step}, {square_line(1, {5, 5}, 10.0)}));
		CHECK(points.size() == static_cast<std::size_t>(std::floor(40.0 / step + 0.5)));
		if (points.size() > 2) {
			CHECK(glm::distance(points.front().position, points.back().position) >= 0.5 * step);
		}
	}
}

TEST_CASE("rows: positive offsets are on the right, and rows beside a bend keep their distance") {
	const RowSet straight = rows_of({.step = 1.0, .offsets = {2.0, -3.0}}, {line_through(1, {{0, 0}, {0, -10}})});
	for (const SamplePoint &point : points_of(straight)) {
		// The line runs toward negative z, so its right side is positive x.
		CHECK((point.position.x == 2.0 || point.position.x == -3.0));
	}
	CHECK(points_of(straight).size() == 22);
	const RowLine corner = line_through(1, {{0, 0}, {30, 0}, {30, 30}});
	const RowSet rows = rows_of({.step = 0.5, .offsets = {6.0, -6.0}}, {corner});
	for (const SamplePoint &point : points_of(rows)) {
		const glm::dvec2 p = point.position;
		const double to_first = glm::distance(p, {std::clamp(p.x, 0.0, 30.0), 0.0});
		const double to_second = glm::distance(p, {30.0, std::clamp(p.y, 0.0, 30.0)});
		CHECK(std::min(to_first, to_second) >= 0.9 * 6.0 - 1e-9);
	}
}

TEST_CASE("rows: parallel rows fill an area and stop at its outline") {
	RowSettings settings{.step = 0.5, .fills_areas = true, .row_distance = 1.5, .row_angle_degrees = 90.0};
	RowLine field = line_through(1, {{0, 0}, {20, 0}, {20, 30}, {10, 30}, {10, 10}, {0, 10}});
	field.anchor = {0.25, 0.25};
	const std::vector<SamplePoint> points = points_of(rows_of(settings, {field}));
	std::size_t expected = 0;
	for (int row = 0; row < 14; ++row) {
		for (int step = 0; step < 60; ++step) {
			const glm::dvec2 at{0.25 + 1.5 * row, 0.25 + 0.5 * step};
			const bool is_inside = at.x < 20.0 && at.y < 30.0 && (at.y < 10.0 || at.x > 10.0);
			expected += is_inside ? 1 : 0;
		}
	}
	CHECK(points.size() == expected);
	for (const SamplePoint &point : points) {
		const double row = (point.position.x - 0.25) / 1.5;
		const double step = (point.position.y - 0.25) / 0.5;
		CHECK(std::abs(row - std::round(row)) < 1e-9);
		CHECK(std::abs(step - std::round(step)) < 1e-9);
	}
}

TEST_CASE("rows: points keep a distance from crossings, and from no other place") {
	const std::vector<RowLine> roads{line_through(1, {{-50, 0}, {50, 0}}), line_through(2, {{0, -50}, {0, 50}}),
			line_through(3, {{50, 0}, {90, 0}}), line_through(4, {{30, 0}, {30, 40}})};
	RowSettings settings{.step = 1.0, .offsets = {0.0, 3.0}};
	const std::vector<SamplePoint> all = points_of(rows_of(settings, roads));
	settings.crossing_gap = 6.0;
	const std::vector<SamplePoint> points = points_of(rows_of(settings, roads));
	std::size_t expected = 0;
	for (const SamplePoint &point : all) {
		// The third road continues the first one, which is no crossing. The fourth one begins on it.
		const bool is_near =
				glm::distance(point.position, {0, 0}) < 6.0 || glm::distance(point.position, {30, 0}) < 6.0;
		expected += is_near ? 0 : 1;
		CHECK(std::ranges::count(points, point.id, &SamplePoint::id) == (is_near ? 0 : 1));
	}
	CHECK(points.size() == expected);
	CHECK(points.size() < all.size());
}

TEST_CASE("rows: a line that ends less than the gap before another line crosses it") {
	const RowLine street = line_through(1, {{-50, 0}, {50, 0}});
	const auto crosses = [&](const RowLine &road) {
		const std::vector<SamplePoint> points = points_of(rows_of({.step = 1.0, .crossing_gap = 6.0}, {street, road}));
		const auto is_in_gap = [](const SamplePoint &point) {
			return glm::distance(point.position, {30, 0}) < 6.0;
		};
		return std::ranges::none_of(points, is_in_gap);
	};
	CHECK(crosses(line_through(2, {{30, 5.9}, {30, 40}})));
	CHECK(crosses(line_through(2, {{30, -40}, {30, -5.9}})));
	CHECK_FALSE(crosses(line_through(2, {{30, 6.1}, {30, 40}})));
	CHECK_FALSE(crosses(line_through(2, {{30, 5}, {40, 5}}))); // Beside the street, not toward it.
	// Two lines that would meet end to end beyond their ends do not cross.
	const std::vector<RowLine> corner{street, line_through(2, {{53, 3}, {53, 40}})};
	CHECK(points_of(rows_of({.step = 1.0, .crossing_gap = 6.0}, corner)).size() ==
			points_of(rows_of({.step = 1.0}, corner)).size());
}

TEST_CASE("rows: any division into tiles finds the same points") {
	RowSettings field{.step = 0.8, .jitter_along = 0.3, .jitter_across = 0.4, .fills_areas = true};
	field.row_distance = 1.1;
	field.row_angle_degrees = 33.0;
	RowLine corn = square_line(9, {20, -60}, 90.0);
	corn.anchor = {-11.0, 3.0};
	const std::vector<RowSet> sets{
			rows_of(jittered(), {winding_line(1), winding_line(2, {10, 20}), square_line(3, {100, -60}, 100.0)}),
			rows_of(field, {corn, winding_line(5)})};
	const Rect region{{-20.0, -90.0}, {420.0, 90.0}};
	for (const RowSet &rows : sets) {
		const std::vector<SamplePoint> all_points = points_of(rows, region);
		REQUIRE(all_points.size() > 500);
		for (const tilings::Tiling &tiling : {tilings::Tiling{"squares", {64, 64}}, {"strips", {7.3, 500}},
					 {"small tiles", {3.1, 4.7}, {0.3, 0.9}, 1, 5}}) {
			std::vector<SamplePoint> joined_points;
			for (const Rect &tile : tilings::tiles_of(tiling, region)) {
				std::vector<SamplePoint> points;
				REQUIRE(rows.sample(set_of_rows, tile, points).ok());
				for (const SamplePoint &point : points) {
					REQUIRE(tile.contains(point.position));
					if (region.contains(point.position)) {
						joined_points.push_back(point);
					}
				}
			}
			CHECK_MESSAGE(sorted(joined_points) == all_points, tiling.name);
		}
	}
}

TEST_CASE("rows: an ID leads to the position of its point, and to no other") {
	RowSettings field{.step = 0.7, .jitter_across = 0.2, .fills_areas = true, .row_distance = 1.3};
	const std::vector<RowSet> sets{rows_of(jittered(), {winding_line(1), winding_line(2, {10, 20})}),
			rows_of(field, {square_line(1, {-30, -30}, 50.0), square_line(~0ull, {40, 0}, 20.0)})};
	for (const RowSet &rows : sets) {
		const std::vector<SamplePoint> points = points_of(rows);
		for (const SamplePoint &point : points) {
			CHECK(unpack(point.id).layer == set_of_rows.layer);
			REQUIRE(rows.position(set_of_rows, point.id) == point.position);
		}
		CHECK_FALSE(rows.position(set_of_rows, points.back().id + 40000));
		CHECK_FALSE(rows.position(set_of_rows, pack({set_of_rows.layer, {1000, 1000}})));
	}
}

TEST_CASE("rows: an edit of a line keeps other lines, and the points before the edited place") {
	const RowSettings settings = jittered();
	const auto all = [&](const RowLine &edited) {
		RowSettings without_gaps = settings;
		without_gaps.crossing_gap = 0.0;
		return by_id(points_of(rows_of(without_gaps, {winding_line(1), edited, winding_line(3, {0, 200})})));
	};
	const RowLine line = winding_line(2, {0, 100});
	RowLine edited = line;
	for (std::size_t i = 400; i < edited.points.size(); ++i) {
		edited.points[i].y += 0.25 * static_cast<double>(i - 400);
	}
	const auto before = all(line);
	const auto after = all(edited);
	std::size_t same_count = 0;
	std::size_t moved_count = 0;
	for (const auto &[id, position] : before) {
		const auto match = after.find(id);
		if (position.x < 195.0 || position.y < 50.0 || position.y > 150.0) {
			REQUIRE(match != after.end());
			CHECK(match->second == position);
			++same_count;
		} else if (match != after.end() && match->second != position) {
			++moved_count;
		}
	}
	CHECK(same_count > 1000);
	CHECK(moved_count > 200); // The points after the edited place keep their IDs.
	// A line that is added or removed changes no ID of the others, wherever it is in the list.
	RowSettings without_gaps = settings;
	without_gaps.crossing_gap = 0.0;
	for (const auto &[id, position] :
			by_id(points_of(rows_of(without_gaps, {winding_line(3, {0, 200}), winding_line(1)})))) {
		CHECK(before.at(id) == position);
	}
}

TEST_CASE("rows: a set that takes unchanged lines from a former set equals a new one, bit for bit") {
	std::mt19937 random(5);
	std::uniform_real_distribution<double> anywhere(-200.0, 200.0);
	std::vector<SharedRowLine> lines;
	const auto random_line = [&](std::uint64_t identity) {
		std::vector<glm::dvec2> points;
		for (int i = 0; i < 6; ++i) {
			points.emplace_back(anywhere(random), anywhere(random));
		}
		return std::make_shared<const RowLine>(RowLine{.identity = identity, .points = points});
	};
	for (std::uint64_t index = 1; index <= 30; ++index) {
		lines.push_back(random_line(identity_of(index)));
	}
	lines.push_back(lines.front()); // Two equal lines.
	for (const bool fills_areas : {false, true}) {
		const RowSettings settings{.step = 2.0,
				.offsets = {-1.0, 2.0},
				.jitter_along = 0.2,
				.fills_areas = fills_areas,
				.crossing_gap = 5.0};
		RowSet previous;
		REQUIRE(previous.set_shared(settings, lines).ok());
		std::vector<SharedRowLine> edited = lines;
		for (int edit = 0; edit < 12; ++edit) {
			const auto at = static_cast<std::size_t>(random() % edited.size());
			if (edit % 4 == 0) {
				edited.erase(edited.begin() + static_cast<std::ptrdiff_t>(at));
			} else if (edit % 4 == 1) {
				std::swap(edited[at], edited.front());
			} else {
				edited[at] = random_line(edit % 4 == 2 ? edited[at]->identity : random());
			}
			RowSet next;
			REQUIRE(next.set_shared(settings, edited, &previous).ok());
			RowSet complete;
			REQUIRE(complete.set_shared(settings, edited).ok());
			std::vector<SamplePoint> points;
			std::vector<SamplePoint> expected;
			REQUIRE(next.sample(set_of_rows, everywhere, points).ok());
			REQUIRE(complete.sample(set_of_rows, everywhere, expected).ok());
			REQUIRE(expected.size() > 1000);
			CHECK(sorted(points) == sorted(expected));
			for (std::size_t line = 0; line < edited.size(); ++line) {
				CHECK(next.key(line) == complete.key(line));
			}
			previous = std::move(next);
		}
		RowSettings wider = settings;
		wider.step = 3.0;
		RowSet other;
		RowSet complete;
		REQUIRE(other.set_shared(wider, edited, &previous).ok());
		REQUIRE(complete.set_shared(wider, edited).ok());
		std::vector<SamplePoint> points;
		std::vector<SamplePoint> expected;
		REQUIRE(other.sample(set_of_rows, everywhere, points).ok());
		REQUIRE(complete.sample(set_of_rows, everywhere, expected).ok());
		CHECK(sorted(points) == sorted(expected));
	}
}

TEST_CASE("rows: lines with the same bits of their identity have different IDs") {
	std::vector<RowLine> lines;
	for (const std::uint64_t identity : {6ull, 5ull, ~0ull, ~0ull - 1}) {
		const double y = 20.0 * static_cast<double>(lines.size());
		lines.push_back({.identity = identity, .points = {{0, y}, {100, y}}});
	}
	const RowSet rows = rows_of({.step = 1.0}, lines);
	CHECK(by_id(points_of(rows)).size() == 404);
	const auto alone = by_id(points_of(rows_of({.step = 1.0}, {lines[1]})));
	for (const auto &[id, position] : alone) {
		CHECK(rows.position(set_of_rows, id) == position);
	}
}

TEST_CASE("rows: instances face along their line") {
	const RowSet rows = rows_of({.step = 1.0}, {line_through(1, {{0, 0}, {0, -10}, {10, -10}})});
	for (const SamplePoint &point : points_of(rows)) {
		const Rotation heading = rows.heading(point.id);
		// The negative z axis after a yaw is (-sine, -cosine).
		const bool along_z = point.position.y > -10.0;
		CHECK(-heading.sine == doctest::Approx(along_z ? 0.0 : 1.0));
		CHECK(-heading.cosine == doctest::Approx(along_z ? -1.0 : 0.0));
	}
}

TEST_CASE("rows: ranks are spread evenly and differ between seeds") {
	const RowSet rows = rows_of({.step = 0.1}, {winding_line(1)});
	std::vector<SamplePoint> points = points_of(rows);
	const auto low = std::ranges::count_if(points, [](const SamplePoint &point) { return point.rank < 1u << 30; });
	CHECK(static_cast<double>(low) / static_cast<double>(points.size()) == doctest::Approx(0.25).epsilon(0.1));
	PointSet other = set_of_rows;
	other.seed = 78;
	std::vector<SamplePoint> repeated;
	REQUIRE(rows.sample(other, everywhere, repeated).ok());
	CHECK(sorted(repeated).front().rank != points.front().rank);
}

TEST_CASE("rows: empty and degenerate lines have no points") {
	const RowSet rows = rows_of(jittered(),
			{RowLine{}, line_through(1, {{3, 3}}), line_through(2, {{4, 4}, {4, 4}, {4, 4}}),
					line_through(3, {{0, 0}, {0, 0}, {10, 0}, {10, 0}})});
	CHECK(points_of(rows).size() == 18);
	CHECK(points_of(RowSet()).empty());
	RowSettings field{.fills_areas = true};
	CHECK(points_of(rows_of(field, {RowLine{}, line_through(1, {{3, 3}, {9, 9}})})).empty());
	CHECK(points_of(rows_of({.offsets = {}}, {winding_line(1)})).empty());
}

TEST_CASE("rows: invalid values are rejected by name, and the set keeps its content") {
	RowSet rows = rows_of({}, {winding_line(1)});
	const auto count = points_of(rows).size();
	const auto rejected = [&](const RowSettings &settings, std::vector<RowLine> lines = {}) {
		const Status status = rows.set(settings, std::move(lines));
		CHECK_FALSE(status.ok());
		CHECK(points_of(rows).size() == count);
		return std::string(status.property);
	};
	constexpr double infinity = std::numeric_limits<double>::infinity();
	CHECK(rejected({.step = 0.0}) == "step");
	CHECK(rejected({.step = std::nan("")}) == "step");
	CHECK(rejected({.offsets = {0.0, 2e3}}) == "offsets");
	CHECK(rejected({.offsets = std::vector<double>(65)}) == "offsets");
	CHECK(rejected({.jitter_along = -1.0}) == "jitter_along");
	CHECK(rejected({.jitter_across = infinity}) == "jitter_across");
	CHECK(rejected({.row_distance = 0.01}) == "row_distance");
	CHECK(rejected({.row_angle_degrees = 400.0}) == "row_angle_degrees");
	CHECK(rejected({.crossing_gap = -1.0}) == "crossing_gap");
	CHECK(rejected({}, {line_through(1, {{0, 0}, {infinity, 0}})}) == "rows.paths");
	CHECK(rejected({}, {line_through(1, {{0, 0}, {0, 1e8}})}) == "rows.paths");
	CHECK(rejected({.step = 0.05}, {line_through(1, {{0, 0}, {5000, 0}})}) == "rows.step");
	CHECK(rejected({.step = 0.05, .fills_areas = true}, {square_line(1, {0, 0}, 3000.0)}) == "rows.step");
	CHECK(rejected({.step = 5.0, .fills_areas = true, .row_distance = 0.1}, {square_line(1, {0, 0}, 3000.0)}) ==
			"rows.row_distance");
	std::vector<SamplePoint> points;
	CHECK(rows.sample(set_of_rows, {{0, 0}, {infinity, 1}}, points).code == ErrorCode::not_finite);
}

TEST_CASE("rows: a set cancel flag ends the call") {
	const RowSet rows =
			rows_of({.step = 0.1, .fills_areas = true, .row_distance = 0.1}, {square_line(1, {0, 0}, 500.0)});
	const std::atomic<bool> cancel = true;
	std::vector<SamplePoint> points;
	CHECK(rows.sample(set_of_rows, everywhere, points, &cancel).code == ErrorCode::cancelled);
	CHECK(points.size() < 5000);
}

TEST_CASE("edits of rows: every changed point lies in a changed area, and distant areas stay unchanged") {
	RowSettings field{.step = 1.1, .jitter_along = 0.3, .fills_areas = true, .row_distance = 1.4};
	const RowLine line = winding_line(2, {0, 100});
	RowLine bent = line;
	for (std::size_t i = 500; i < 560; ++i) {
		bent.points[i].y += 4.0;
	}
	RowLine longer = line;
	longer.points.emplace_back(410.0, 90.0);
	const RowLine straight = line_through(2, {{0, 120}, {150, 120}, {200, 120}});
	const RowLine square = square_line(4, {0, 0}, 60.0);
	RowLine dented = square;
	dented.points.insert(dented.points.begin() + 2, {50.0, 30.0});
	struct Case {
		RowSettings settings;
		RowLine before;
		RowLine after;
		bool is_local;
	};
	for (const Case &each : {Case{jittered(), line, bent, true}, Case{jittered(), line, longer, true},
				 Case{jittered(), longer, line, true},
				 Case{jittered(), RowLine{.identity = identity_of(2)}, line, false},
				 Case{{}, straight, line_through(2, {{0, 110}, {200, 110}}), false},
				 Case{{}, straight, line_through(2, {{0, 120}, {150, 120}, {210, 120}}), true},
				 Case{field, square, dented, true}, Case{field, dented, square, true},
				 Case{field, square, square_line(4, {3, 0}, 60.0), false}}) {
		const std::vector<RowLine> other_lines{winding_line(1), winding_line(3, {200, 100})};
		const auto rows_with = [&](const RowLine &changed_line) {
			return std::vector<RowLine>{other_lines[0], changed_line, other_lines[1]};
		};
		const RowSet before = rows_of(each.settings, rows_with(each.before));
		const RowSet after = rows_of(each.settings, rows_with(each.after));
		std::vector<Rect> areas;
		REQUIRE(find_row_edits(&before, &after, areas));
		const auto previous = by_id(points_of(before));
		const auto current = by_id(points_of(after));
		const auto check = [&areas](const auto &from, const auto &to) {
			for (const auto &[id, position] : from) {
				const auto match = to.find(id);
				if (match == to.end() || match->second != position) {
					CHECK(std::ranges::any_of(areas, [p = position](const Rect &area) { return area.contains(p); }));
				}
			}
		};
		check(previous, current);
		check(current, previous);
		const glm::dvec2 distant = each.settings.fills_areas ? glm::dvec2(5.0, 30.0) : glm::dvec2(50.0, 120.0);
		const auto contains_far = [distant](const Rect &area) {
			return area.contains(distant);
		};
		CHECK(std::ranges::any_of(areas, contains_far) != each.is_local);
	}
}

TEST_CASE("edits of rows: other settings change everything, and equal sets nothing") {
	const RowSet rows = rows_of({}, {winding_line(1)});
	const RowSet same_rows = rows_of({}, {winding_line(1)});
	const RowSet other = rows_of({.step = 2.5}, {winding_line(1)});
	std::vector<Rect> areas;
	CHECK(find_row_edits(&rows, &same_rows, areas));
	CHECK(areas.empty());
	CHECK_FALSE(find_row_edits(&rows, &other, areas));
	CHECK_FALSE(find_row_edits(&rows, nullptr, areas));
	CHECK(find_row_edits(nullptr, nullptr, areas));
	CHECK(areas.empty());
}
