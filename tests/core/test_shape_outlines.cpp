#include "core/rules/outline.hpp"
#include "core/rules/shapes.hpp"
#include "rounding.hpp"
#include "shape_cases.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

using namespace thicket;
using namespace thicket::shape_cases;
using test::rounds;

namespace {

using Points = std::vector<glm::dvec2>;

Shape polygon(Points outline, double falloff = 0.0) {
	return {.kind = ShapeKind::polygon, .falloff = falloff, .outline = std::move(outline)};
}

Shape path(Points outline, double half_width, double falloff = 0.0) {
	return {.kind = ShapeKind::path,
			.falloff = falloff,
			.half_size = {half_width, 0.0, 0.0},
			.outline = std::move(outline)};
}

double density_at(const ShapeSet &set, double x, double z) { return density_of(set, {x, 123.0, z}); }

Outline outline_of(const Points &points, bool closed) {
	Outline outline;
	outline.set(points, closed);
	return outline;
}

double distance_to_edge(glm::dvec2 a, glm::dvec2 b, glm::dvec2 position) {
	const double length = glm::distance(a, b);
	if (length == 0.0) {
		return glm::distance(a, position);
	}
	const glm::dvec2 direction = (b - a) / length;
	const double t = glm::dot(position - a, direction);
	return t <= 0.0       ? glm::distance(a, position)
			: t >= length ? glm::distance(b, position)
						  : std::abs(direction.x * (position.y - a.y) - direction.y * (position.x - a.x));
}

double plain_distance(const Points &points, bool closed, glm::dvec2 position) {
	double nearest = glm::distance(points.front(), position);
	for (std::size_t i = 0; i + (closed ? 0 : 1) < points.size(); ++i) {
		nearest = std::min(nearest, distance_to_edge(points[i], points[(i + 1) % points.size()], position));
	}
	return nearest;
}

/// Applies the even-odd rule with a ray along +y. The core uses +x.
bool plain_contains(const Points &points, glm::dvec2 position) {
	bool within = false;
	for (std::size_t i = 0; i < points.size(); ++i) {
		const glm::dvec2 a = points[i];
		const glm::dvec2 b = points[(i + 1) % points.size()];
		if ((a.x > position.x) != (b.x > position.x)) {
			within ^= a.y + (b.y - a.y) * (position.x - a.x) / (b.x - a.x) > position.y;
		}
	}
	return within;
}

/// Returns a coastline: a circle with a radius of 500 m and bays.
Points coast(std::size_t count) {
	Points points;
	for (std::size_t i = 0; i < count; ++i) {
		const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
		const double radius = 500.0 + 60.0 * std::sin(7.0 * angle) + 9.0 * std::sin(61.0 * angle);
		points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
	}
	return points;
}

} // namespace

TEST_CASE("outlines: a polygon's border is outside, and the depth is the distance to the border") {
	const Points square{{-4.0, -2.0}, {4.0, -2.0}, {4.0, 2.0}, {-4.0, 2.0}};
	const ShapeSet sharp = set_of({polygon(square)});
	const ShapeSet soft = set_of({polygon(square, 2.0)});
	CHECK(density_at(sharp, 3.999, 1.999) == 1.0);
	CHECK(density_at(sharp, -3.999, -1.999) == 1.0);
	for (const glm::dvec2 border : {glm::dvec2(4.0, 0.0), glm::dvec2(-4.0, 0.0), glm::dvec2(0.0, 2.0),
				 glm::dvec2(0.0, -2.0), glm::dvec2(4.0, 2.0), glm::dvec2(-4.0, -2.0), glm::dvec2(-4.0, 2.0)}) {
		CHECK(density_at(sharp, border.x, border.y) == 0.0);
		CHECK(density_at(soft, border.x, border.y) == 0.0);
	}
	CHECK(density_at(soft, 0.0, 0.0) == 1.0);
	CHECK(density_at(soft, 3.0, 0.0) == 0.5);
	CHECK(density_at(soft, -3.5, 1.0) == 0.25);
	CHECK(density_at(soft, 1.0, -1.5) == 0.25);
}

TEST_CASE("outlines: a border of many short edges is outside everywhere") {
	constexpr int side = 12;
	Points square;
	const std::array<glm::dvec2, 4> directions{
			glm::dvec2(1, 0), glm::dvec2(0, 1), glm::dvec2(-1, 0), glm::dvec2(0, -1)};
	glm::dvec2 at(0.0);
	for (const glm::dvec2 step : directions) {
		for (int i = 0; i < side; ++i) {
			square.push_back(at);
			at += step;
		}
	}
	for (std::size_t start = 0; start < square.size(); ++start) {
		std::rotate(square.begin(), square.begin() + 1, square.end());
		const Outline outline = outline_of(square, true);
		for (double position = 0.0; position <= side; position += 0.5) {
			CHECK(!outline.contains({0.0, position}));
			CHECK(!outline.contains({side, position}));
			CHECK(!outline.contains({position, 0.0}));
			CHECK(!outline.contains({position, side}));
			const bool within = position > 0.0 && position < side;
			CHECK(outline.contains({1e-9, position}) == within);
			CHECK(outline.contains({side - 1e-9, position}) == within);
			CHECK(outline.contains({position, 1e-9}) == within);
			CHECK(outline.contains({position, side - 1e-9}) == within);
		}
	}
}

TEST_CASE("outlines: rays through corners count correctly, at all half-integer positions of integer polygons") {
	const std::vector<Points> polygons{
			{{0, 0}, {6, 0}, {6, 6}, {4, 6}, {4, 2}, {2, 2}, {2, 6}, {0, 6}}, // U shape.
			{{0, 3}, {3, 0}, {6, 3}, {3, 6}},                                 // A diamond.
			{{0, 0}, {6, 6}, {6, 0}, {0, 6}},                                 // A bow tie.
			{{0, 0}, {2, 4}, {4, 0}, {6, 4}, {6, 6}, {0, 6}},                 // Two peaks of equal height.
			{{0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {2, 2}, {2, 4}, {4, 4}, {4, 2}, {2, 2}}, // A hole with a slit.
			{{0, 0}, {3, 0}, {3, 3}, {6, 3}, {6, 6}, {3, 6}, {3, 3}, {0, 3}}, // The border touches itself.
			{{0, 0}, {6, 0}, {6, 0}, {6, 6}, {6, 6}, {6, 6}, {0, 6}, {0, 0}}, // Repeated corners.
			{{3, 0}, {5, 6}, {0, 2}, {6, 2}, {1, 6}},                         // A star, hollow inside.
			{{0, 0}, {6, 0}, {3, 0}},                                         // No area.
			{{2, 2}, {2, 2}, {2, 2}},                                         // A point.
	};
	for (std::size_t index = 0; index < polygons.size(); ++index) {
		const ShapeSet set = set_of({polygon(polygons[index])});
		for (double x = -1.0; x <= 7.0; x += 0.5) {
			for (double z = -1.0; z <= 7.0; z += 0.5) {
				CAPTURE(index);
				CAPTURE(x);
				CAPTURE(z);
				// The oracle's position is shifted slightly, so that its ray hits no corner.
				const bool on_border = plain_distance(polygons[index], true, {x, z}) < 1e-12;
				const bool within = !on_border && plain_contains(polygons[index], {x + 1e-9, z + 1.7e-9});
				CHECK(density_at(set, x, z) == (within ? 1.0 : 0.0));
			}
		}
	}
}

TEST_CASE("outlines: next to the common edge of two polygons, every position is in exactly one of them") {
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	for (int round = 0; round < 200; ++round) {
		const glm::dvec2 a(10.0 * unit(random), 0.0);
		const glm::dvec2 b(10.0 * unit(random), 10.0);
		const Outline left_side = outline_of({a, b, {-1.0, 10.0}, {-1.0, 0.0}}, true);
		const Outline right = outline_of({b, a, {11.0, 0.0}, {11.0, 10.0}}, true);
		for (int i = 0; i < 50; ++i) {
			const double y = 10.0 * unit(random);
			const double x = a.x + (b.x - a.x) * y / 10.0 + (unit(random) - 0.5) * 1e-14;
			CHECK(!(left_side.contains({x, y}) && right.contains({x, y})));
			CHECK((left_side.contains({x, y}) || right.contains({x, y}) || left_side.distance({x, y}, 1.0) < 1e-14));
		}
	}
}

TEST_CASE("outlines: a path has round ends and round bends, and its border is outside") {
	const Points bend{{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}};
	const ShapeSet sharp = set_of({path(bend, 2.0)});
	const ShapeSet soft = set_of({path(bend, 2.0, 1.0)});
	CHECK(density_at(sharp, 5.0, 1.999) == 1.0);
	CHECK(density_at(sharp, 5.0, 2.0) == 0.0);
	CHECK(density_at(sharp, -1.999, 0.0) == 1.0);
	CHECK(density_at(sharp, -2.0, 0.0) == 0.0);
	CHECK(density_at(sharp, -1.5, 1.5) == 0.0);  // The corner of a flat end.
	CHECK(density_at(sharp, 11.5, -1.5) == 0.0); // The corner of a sharp bend.
	CHECK(density_at(sharp, 11.4, -1.4) == 1.0);
	CHECK(density_at(sharp, 10.0, 11.999) == 1.0);
	CHECK(density_at(sharp, 5.0, 5.0) == 0.0); // The path is not closed.
	CHECK(density_at(soft, 5.0, 0.5) == 1.0);
	CHECK(density_at(soft, 5.0, 1.5) == 0.5);
	CHECK(density_at(soft, -1.75, 0.0) == 0.25);
	CHECK(density_at(soft, 11.75, 10.0) == 0.25);
	CHECK(density_at(soft, 5.0, 2.5) == 0.0);
}

TEST_CASE("outlines: repeated points of a path have no effect; a path with a single point is a disc") {
	const ShapeSet plain = set_of({path({{0.0, 0.0}, {10.0, 5.0}, {12.0, -3.0}}, 2.0, 2.0)});
	const ShapeSet repeated = set_of({path(
			{{0.0, 0.0}, {0.0, 0.0}, {10.0, 5.0}, {10.0, 5.0}, {10.0, 5.0}, {12.0, -3.0}, {12.0, -3.0}}, 2.0, 2.0)});
	for (double x = -3.0; x < 15.0; x += 0.3) {
		for (double z = -6.0; z < 8.0; z += 0.3) {
			CHECK(std::abs(density_at(plain, x, z) - density_at(repeated, x, z)) < 1e-12);
		}
	}
	const ShapeSet disc = set_of({path({{3.0, 4.0}, {3.0, 4.0}}, 2.0, 2.0)});
	CHECK(density_at(disc, 3.0, 4.0) == 1.0);
	CHECK(density_at(disc, 4.0, 4.0) == 0.5);
	CHECK(density_at(disc, 3.0, 2.0) == 0.0);
}

TEST_CASE("outlines: random lines of any length match a scan of all edges") {
	std::mt19937 random(2);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	for (const double shift : {0.0, 1e7}) {
		for (const std::size_t count :
				std::vector<std::size_t>{1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 31, 33, 64, 65, 100, 129, 1000}) {
			Points points;
			glm::dvec2 at(shift, -shift);
			for (std::size_t i = 0; i < count; ++i) {
				at += glm::dvec2(unit(random), unit(random));
				points.push_back(i % 7 == 3 ? points.back() : at);
			}
			for (const bool closed : {false, true}) {
				const Outline outline = outline_of(points, closed);
				for (int i = 0; i < 100; ++i) {
					const double spread = i % 2 == 0 ? 3.0 : 40.0;
					const glm::dvec2 position =
							points[random() % count] + spread * glm::dvec2(unit(random), unit(random));
					const double distance = plain_distance(points, closed, position);
					CAPTURE(count);
					CHECK(std::abs(outline.distance(position, 1e9) - distance) < (shift > 0.0 ? 1e-8 : 1e-12));
					CHECK(outline.distance(position, distance * 0.75) == distance * 0.75);
					if (closed && distance > 1e-8) {
						CHECK(outline.contains(position) == plain_contains(points, position));
					}
				}
			}
		}
	}
}

TEST_CASE("outlines: 65,536 points, inside and around every bay") {
	const Points points = coast(max_outline_points);
	const ShapeSet set = set_of({polygon(points, 50.0)});
	const ShapeSet shore = set_of({path(points, 12.0, 12.0)});
	std::mt19937 random(3);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	for (int i = 0; i < 300; ++i) {
		const glm::dvec2 on = points[random() % points.size()];
		const glm::dvec2 position = i % 2 == 0 ? on + 15.0 * glm::dvec2(unit(random), unit(random))
											   : 600.0 * glm::dvec2(unit(random), unit(random));
		const double distance = plain_distance(points, true, position);
		const double depth = plain_contains(points, position) ? distance : 0.0;
		CHECK(density_at(set, position.x, position.y) == doctest::Approx(std::min(depth / 50.0, 1.0)).epsilon(1e-9));
		CHECK(density_at(shore, position.x, position.y) ==
				doctest::Approx(std::max(1.0 - distance / 12.0, 0.0)).epsilon(1e-6));
	}
}

TEST_CASE("outlines: only edges that may be the nearest are measured") {
	// A few near edges whose squared lengths are powers of two, and many far edges, whose distances
	// are rounded.
	Points points{{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {0.0, 4.0}, {0.0, 8.0}};
	for (int i = 0; i < 100; ++i) {
		points.emplace_back(100.0 + 3 * i, i % 2 == 0 ? 100.0 : 107.0);
	}
	const Outline outline = outline_of(points, false);
	double distance = 0.0;
	CHECK_FALSE(rounds([&] { distance = outline.distance({2.0, 1.0}, 64.0); }));
	CHECK(distance == 1.0);
	CHECK(rounds([&] { distance = outline.distance({102.0, 101.0}, 64.0); }));
}
