#include "core/rules/shapes.hpp"
#include "refusal.hpp"
#include "rounding.hpp"
#include "shape_cases.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::shape_cases;
using test::rounds;

TEST_CASE("shapes: a box reaches exactly as far as its half sizes, and its border is outside") {
	const ShapeSet set = set_of({box({10.0, 5.0, -20.0}, {4.0, 2.0, 1.0})});
	CHECK(density_of(set, {10.0, 5.0, -20.0}) == 1.0);
	for (const glm::dvec3 inside : {glm::dvec3(13.999, 5.0, -20.0), glm::dvec3(6.001, 5.0, -20.0),
				 glm::dvec3(10.0, 6.999, -20.0), glm::dvec3(10.0, 3.001, -20.0), glm::dvec3(10.0, 5.0, -19.001),
				 glm::dvec3(13.999, 6.999, -20.999)}) {
		CHECK(density_of(set, inside) == 1.0);
	}
	for (const glm::dvec3 outside : {glm::dvec3(14.0, 5.0, -20.0), glm::dvec3(6.0, 5.0, -20.0),
				 glm::dvec3(10.0, 7.0, -20.0), glm::dvec3(10.0, 3.0, -20.0), glm::dvec3(10.0, 5.0, -19.0),
				 glm::dvec3(10.0, 5.0, -21.0), glm::dvec3(14.0, 7.0, -19.0), glm::dvec3(1e7, 5.0, -20.0)}) {
		CHECK(density_of(set, outside) == 0.0);
	}
}

TEST_CASE("shapes: influence grows linearly with depth, from 0 at the border to 1 at the falloff") {
	Shape soft = box({0.0, 0.0, 0.0}, {10.0, 1000.0, 20.0});
	soft.falloff = 4.0;
	const ShapeSet set = set_of({soft});
	for (double depth = -1.0; depth <= 10.0; depth += 0.125) {
		const double expected = std::clamp(depth / 4.0, 0.0, 1.0);
		CHECK(density_of(set, {10.0 - depth, 0.0, 0.0}) == expected);
		CHECK(density_of(set, {depth - 10.0, 0.0, 3.0}) == expected);
		CHECK(density_of(set, {0.0, 0.0, 20.0 - depth}) == expected);
		CHECK(density_of(set, {0.0, 1000.0 - depth, 0.0}) == expected);
	}
	// No position is deep enough for full influence.
	soft.falloff = 40.0;
	CHECK(density_of(set_of({soft}), {0.0, 0.0, 0.0}) == 0.25);
}

TEST_CASE("shapes: a box rotated by 45 degrees is a diamond, and a leaning one is cut at its slope") {
	const double half = std::sqrt(0.5);
	Shape turned = box({0.0, 0.0, 0.0}, {half, 1.0, half});
	turned.axes = glm::dmat3({half, 0.0, half}, {0.0, 1.0, 0.0}, {-half, 0.0, half});
	const ShapeSet diamond = set_of({turned});
	for (double x = -1.1; x <= 1.1; x += 0.1) {
		for (double z = -1.1; z <= 1.1; z += 0.1) {
			if (std::abs(std::abs(x) + std::abs(z) - 1.0) > 1e-9) {
				CHECK(density_of(diamond, {x, 0.0, z}) == (std::abs(x) + std::abs(z) < 1.0 ? 1.0 : 0.0));
			}
		}
	}
	// A slab whose up axis leans 30 degrees toward +x. At a height of 1, its center is offset by
	// tan 30 degrees.
	Shape leaning = box({0.0, 0.0, 0.0}, {0.1, 10.0, 10.0});
	const double sine = 0.5;
	const double cosine = std::sqrt(0.75);
	leaning.axes = glm::dmat3({cosine, -sine, 0.0}, {sine, cosine, 0.0}, {0.0, 0.0, 1.0});
	const ShapeSet slab = set_of({leaning});
	const double middle = sine / cosine;
	const double width = 0.1 / cosine;
	CHECK(density_of(slab, {middle + width - 1e-6, 1.0, 0.0}) == 1.0);
	CHECK(density_of(slab, {middle + width + 1e-6, 1.0, 0.0}) == 0.0);
	CHECK(density_of(slab, {middle - width + 1e-6, 1.0, 0.0}) == 1.0);
	CHECK(density_of(slab, {middle - width - 1e-6, 1.0, 0.0}) == 0.0);
}

TEST_CASE("shapes: depths of rotated boxes, spheres and cylinders match a search, and their shadows") {
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	for (int round = 0; round < 60; ++round) {
		for (const ShapeKind kind : {ShapeKind::box, ShapeKind::sphere, ShapeKind::cylinder}) {
			Shape shape = random_volume(kind, random);
			shape.falloff = 100.0; // Larger than any depth, so that the influence reveals the depth.
			for (const bool ignore_height : {false, true}) {
				shape.ignore_height = ignore_height;
				const ShapeSet set = set_of({shape});
				for (int i = 0; i < 20; ++i) {
					const glm::dvec3 position =
							shape.center + 12.0 * glm::dvec3(unit(random), unit(random), unit(random));
					const double depth =
							ignore_height ? searched_shadow_depth(shape, position) : plain_depth(shape, position);
					CAPTURE(static_cast<int>(kind));
					CAPTURE(depth);
					CHECK(std::abs(density_of(set, position) * 100.0 - std::max(depth, 0.0)) < 1e-4);
				}
			}
		}
	}
}

TEST_CASE("shapes: a box without height is as deep as it is wide and applies at any height") {
	Shape flat_box = box({0.0, 50.0, 0.0}, {30.0, 0.01, 20.0});
	flat_box.falloff = 10.0;
	flat_box.ignore_height = true;
	const ShapeSet set = set_of({flat_box});
	for (const double height : {-1e6, 0.0, 50.0, 1e6}) {
		CHECK(density_of(set, {0.0, height, 0.0}) == 1.0);
		CHECK(density_of(set, {25.0, height, 0.0}) == 0.5);
		CHECK(density_of(set, {0.0, height, -15.0}) == 0.5);
		CHECK(density_of(set, {30.0, height, 0.0}) == 0.0);
	}
	flat_box.ignore_height = false;
	CHECK(density_of(set_of({flat_box}), {0.0, 0.0, 0.0}) == 0.0);
}

TEST_CASE("shapes: a cylinder on its side casts a rectangle, an upright one a circle") {
	Shape lying = cylinder(2.0, 10.0);
	lying.ignore_height = true;
	lying.falloff = 100.0;
	lying.axes = glm::dmat3({0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0});
	const ShapeSet log = set_of({lying});
	CHECK(density_of(log, {0.0, 9.0, 0.0}) * 100.0 == doctest::Approx(2.0));
	CHECK(density_of(log, {9.5, 9.0, 0.0}) * 100.0 == doctest::Approx(0.5));
	CHECK(density_of(log, {9.5, 9.0, 1.75}) * 100.0 == doctest::Approx(0.25));
	CHECK(density_of(log, {10.001, 0.0, 0.0}) == 0.0);
	CHECK(density_of(log, {0.0, 0.0, 2.001}) == 0.0);
	lying.axes = glm::dmat3(1.0);
	const ShapeSet upright = set_of({lying});
	CHECK(density_of(upright, {1.2, 77.0, 1.6}) == 0.0);
	CHECK(density_of(upright, {0.6, 77.0, 0.8}) == 0.01);
}

TEST_CASE("shapes: the depth of a leaning cylinder's shadow matches a search, at every angle") {
	for (int degrees = 1; degrees < 90; degrees += 8) {
		const double angle = degrees * std::numbers::pi / 180.0;
		Shape leaning = cylinder(6.0, 3.0);
		leaning.ignore_height = true;
		leaning.falloff = 100.0;
		leaning.axes = glm::dmat3(
				{std::cos(angle), -std::sin(angle), 0.0}, {std::sin(angle), std::cos(angle), 0.0}, {0.0, 0.0, 1.0});
		const ShapeSet set = set_of({leaning});
		for (double x = 0.25; x < 9.0; x += 0.5) {
			for (double z = 0.2; z < 6.0; z += 0.8) {
				const double depth = std::max(searched_shadow_depth(leaning, {x, 0.0, z}), 0.0);
				CHECK(std::abs(density_of(set, {-x, 0.0, z}) * 100.0 - depth) < 1e-6);
			}
		}
	}
}

TEST_CASE("shapes: axes with single-precision errors move no border") {
	Shape large = box({0.0, 0.0, 0.0}, {1e6, 1e6, 1e6});
	large.axes = glm::dmat3({1.0 + 4e-7, 0.0, 0.0}, {4e-7, 1.0 - 4e-7, 0.0}, {0.0, 0.0, 1.0 - 4e-7});
	for (const bool ignore_height : {false, true}) {
		large.ignore_height = ignore_height;
		const ShapeSet set = set_of({large});
		CHECK(density_of(set, {0.0, 0.0, 1e6 - 1e-3}) == 1.0);
		CHECK(density_of(set, {0.0, 0.0, 1e6 + 1e-3}) == 0.0);
		CHECK(bounds(large).contains({0.0, 1e6}));
	}
}

TEST_CASE("shapes: bounds contain the border with a minimal margin") {
	const Shape shape = box({10.0, 0.0, -200.0}, {4.0, 1.0, 8.0});
	const Shape ring = [] {
		Shape path;
		path.kind = ShapeKind::path;
		path.half_size.x = 2.0;
		path.outline = {{8.0, -206.0}, {12.0, -194.0}};
		return path;
	}();
	for (const Shape &each_shape : {shape, ring}) {
		const Rect shape_bounds = bounds(each_shape);
		CHECK(shape_bounds.contains({14.0, -192.0}));
		CHECK(shape_bounds.contains({6.0, -208.0}));
		for (const glm::dvec2 outside : {glm::dvec2(14.0 + 1e-9, -200.0), glm::dvec2(6.0 - 1e-9, -200.0),
					 glm::dvec2(10.0, -192.0 + 1e-9), glm::dvec2(10.0, -208.0 - 1e-9)}) {
			CHECK(!shape_bounds.contains(outside));
		}
	}
	CHECK(bounds(box({-3.0, 0.0, -4.0}, {3.0, 1.0, 4.0})).contains({0.0, 0.0})); // A border at 0 has a margin as well.
}

TEST_CASE("shapes: the density is the strongest inclusion times the remainder of the strongest exclusion") {
	Shape wide = box({0.0, 0.0, 0.0}, {100.0, 100.0, 100.0});
	wide.falloff = 100.0;
	Shape narrow = box({0.0, 0.0, 0.0}, {10.0, 100.0, 10.0});
	narrow.falloff = 20.0;
	Shape hole = box({0.0, 0.0, 0.0}, {8.0, 100.0, 8.0});
	hole.falloff = 8.0;
	hole.exclude = true;
	Shape smaller_hole = hole;
	smaller_hole.half_size.x = 4.0;

	CHECK(density_of(set_of({}), {3.0, 0.0, 0.0}) == 1.0);
	// The influences 1 and 0.5 are neither added nor multiplied.
	CHECK(density_of(set_of({wide, narrow}), {0.0, 0.0, 0.0}) == 1.0);
	CHECK(density_of(set_of({narrow, wide}), {50.0, 0.0, 0.0}) == 0.5);
	CHECK(density_of(set_of({hole}), {20.0, 0.0, 0.0}) == 1.0); // Without an including shape, everything is included.
	CHECK(density_of(set_of({hole}), {6.0, 0.0, 0.0}) == 0.75);
	CHECK(density_of(set_of({hole, smaller_hole}), {2.0, 0.0, 0.0}) == 0.25); // The shapes exclude 0.75 and 0.25.
	CHECK(density_of(set_of({smaller_hole, hole}), {2.0, 0.0, 0.0}) == 0.25);
	CHECK(density_of(set_of({hole, narrow}), {6.0, 0.0, 0.0}) == 0.75 * 0.2);
	CHECK(density_of(set_of({wide, hole}), {0.0, 0.0, 0.0}) == 0.0);
}

TEST_CASE("shapes: nothing is included far from the only including shape; a far excluding shape has no effect") {
	Shape far_shape = box({1e6, 0.0, 0.0}, {10.0, 10.0, 10.0});
	const Rect near_area{{-50.0, -50.0}, {50.0, 50.0}};
	std::vector<std::uint32_t> near_shapes{7};
	const ShapeSet including = set_of({far_shape});
	CHECK(including.includes());
	REQUIRE(including.find_nearby(near_area, near_shapes).ok());
	CHECK(near_shapes.empty());
	CHECK(including.density(near_shapes, {0.0, 0.0, 0.0}) == 0.0);

	far_shape.exclude = true;
	const ShapeSet excluding = set_of({far_shape});
	CHECK(!excluding.includes());
	REQUIRE(excluding.find_nearby(near_area, near_shapes).ok());
	CHECK(near_shapes.empty());
	CHECK(excluding.density(near_shapes, {0.0, 0.0, 0.0}) == 1.0);
	CHECK(set_of({}).empty());
}

TEST_CASE("shapes: near returns the shapes that touch an area, in order, and bounds contain all changes") {
	std::mt19937 random(5);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	for (int round = 0; round < 20; ++round) {
		const std::vector<Shape> shapes = random_shapes(12, random);
		const ShapeSet set = set_of(shapes);
		const Rect area = rect_around({40.0 * unit(random), 40.0 * unit(random)}, 2.0 + 10.0 * std::abs(unit(random)));
		std::vector<std::uint32_t> near_shapes;
		REQUIRE(set.find_nearby(area, near_shapes).ok());
		CHECK(std::ranges::is_sorted(near_shapes));
		for (std::uint32_t i = 0; i < shapes.size(); ++i) {
			const Rect shape_bounds = bounds(shapes[i]);
			const bool touches = area.min.x <= shape_bounds.max.x && shape_bounds.min.x <= area.max.x &&
					area.min.y <= shape_bounds.max.y && shape_bounds.min.y <= area.max.y;
			CHECK((std::ranges::count(near_shapes, i) == (touches ? 1 : 0)));
			Shape alone = shapes[i];
			alone.exclude = false;
			alone.falloff = 0.0;
			const ShapeSet lonely = set_of({alone});
			for (int k = 0; k < 50; ++k) {
				const glm::dvec3 position(60.0 * unit(random), 10.0 * unit(random), 60.0 * unit(random));
				CHECK((density_of(lonely, position) == 0.0 || shape_bounds.contains({position.x, position.z})));
			}
		}
		// The area that is passed to `near` does not affect the density.
		for (int k = 0; k < 50; ++k) {
			const glm::dvec3 position(area.center().x + unit(random) * 0.5 * area.size().x, 10.0 * unit(random),
					area.center().y + unit(random) * 0.5 * area.size().y);
			CHECK(set.density(near_shapes, position) == density_of(set, position));
		}
	}
}

TEST_CASE("shapes: moving, adding or removing a shape has no effect outside its old and its new bounds") {
	std::mt19937 random(6);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	int changed_count = 0;
	for (int round = 0; round < 40; ++round) {
		std::vector<Shape> shapes = random_shapes(8, random);
		// Adding the first including shape, or removing the last, would change the rest of the
		// world.
		shapes[0].exclude = false;
		const ShapeSet before = set_of(shapes);
		const std::size_t moved_index = 1 + random() % 7;
		const Rect old_bounds = bounds(shapes[moved_index]);
		Shape &shape = shapes[moved_index];
		const glm::dvec2 by(20.0 * unit(random), 20.0 * unit(random));
		shape.center += glm::dvec3(by.x, 0.0, by.y);
		for (glm::dvec2 &point : shape.outline) {
			point += by;
		}
		const Rect new_bounds = bounds(shape);
		const ShapeSet after = set_of(shapes);
		shapes.erase(shapes.begin() + static_cast<std::ptrdiff_t>(moved_index));
		const ShapeSet without_shape = set_of(shapes);
		for (int k = 0; k < 500; ++k) {
			const glm::dvec3 position(60.0 * unit(random), 5.0 * unit(random), 60.0 * unit(random));
			const glm::dvec2 flat(position.x, position.z);
			const bool in_old = old_bounds.contains(flat);
			const bool in_new = new_bounds.contains(flat);
			CHECK((in_old || in_new || density_of(before, position) == density_of(after, position)));
			CHECK((in_old || density_of(before, position) == density_of(without_shape, position)));
			CHECK((in_new || density_of(after, position) == density_of(without_shape, position)));
			changed_count += density_of(before, position) != density_of(after, position) ? 1 : 0;
		}
	}
	CHECK(changed_count > 300);
}

TEST_CASE("shapes: far from the origin, a shape is the same within the precision of the coordinates") {
	std::mt19937 random(7);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	const glm::dvec2 far(1e7, -1e7);
	for (const Shape &shape : random_shapes(60, random)) {
		Shape moved_shape = shape;
		moved_shape.center += glm::dvec3(far.x, 0.0, far.y);
		for (glm::dvec2 &point : moved_shape.outline) {
			point += far;
		}
		const ShapeSet near_set = set_of({shape});
		const ShapeSet far_set = set_of({moved_shape});
		const double grain = 1e-8; // Several roundings of a double at 1e7 m.
		for (int k = 0; k < 100; ++k) {
			const glm::dvec3 position(60.0 * unit(random), 5.0 * unit(random), 60.0 * unit(random));
			const double density = density_of(near_set, position);
			const double far_density = density_of(far_set, position + glm::dvec3(far.x, 0.0, far.y));
			CHECK((std::abs(density - far_density) * std::max(shape.falloff, grain) <= grain));
		}
	}
}

TEST_CASE("shapes: a position that is not finite has a density of 0") {
	const ShapeSet set = set_of({box({0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}, true)});
	for (const glm::dvec3 invalid_position : {glm::dvec3(nan_value, 0.0, 0.0), glm::dvec3(0.0, nan_value, 0.0),
				 glm::dvec3(0.0, 0.0, infinite_value), glm::dvec3(0.0, -infinite_value, 0.0)}) {
		CHECK(set.density({}, invalid_position) == 0.0);
	}
	CHECK(set.density({}, {9.0, 0.0, 0.0}) == 1.0);
}

TEST_CASE("shapes: errors name the invalid property, and the set stays unchanged") {
	ShapeSet set = set_of({box({0.0, 0.0, 0.0}, {1.0, 1.0, 1.0})});
	const ShapeSet before = set;
	const Shape good_box = box({0.0, 0.0, 0.0}, {2.0, 2.0, 2.0});
	const Shape good_path{.kind = ShapeKind::path, .half_size = {2.0, 0.0, 0.0}, .outline = {{0.0, 0.0}, {1.0, 0.0}}};
	const Shape good_polygon{.kind = ShapeKind::polygon, .outline = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}};
	const Shape good_cylinder = cylinder(1.0, 1.0);
	const auto refuse = [&](Shape bad, auto change, ErrorCode code, const char *property, double value) {
		change(bad);
		check_refused(validate(bad), code, property, value);
		check_refused(set.set({good_box, bad}), code, property, value);
		CHECK(set == before);
		CHECK(density_of(set, {1.5, 0.0, 0.0}) == 0.0);
	};
	refuse(good_box, [](Shape &s) { s.falloff = -0.5; }, ErrorCode::out_of_range, "falloff", -0.5);
	refuse(good_box, [](Shape &s) { s.falloff = nan_value; }, ErrorCode::not_finite, "falloff", nan_value);
	refuse(good_box, [](Shape &s) { s.falloff = 2e9; }, ErrorCode::out_of_range, "falloff", 2e9);
	refuse(good_box, [](Shape &s) { s.center.y = infinite_value; }, ErrorCode::not_finite, "center", infinite_value);
	refuse(good_box, [](Shape &s) { s.center.z = -2e9; }, ErrorCode::out_of_range, "center", -2e9);
	refuse(good_box, [](Shape &s) { s.half_size.z = 0.0; }, ErrorCode::not_positive, "half_size", 0.0);
	refuse(good_box, [](Shape &s) { s.half_size.x = -1.0; }, ErrorCode::not_positive, "half_size", -1.0);
	refuse(good_box, [](Shape &s) { s.half_size.y = 2e9; }, ErrorCode::out_of_range, "half_size", 2e9);
	refuse(good_box, [](Shape &s) { s.axes[1].y = 1.5; }, ErrorCode::out_of_range, "axes", 2.25);
	refuse(good_box, [](Shape &s) { s.axes[0] = {0.0, 1.0, 0.0}; }, ErrorCode::out_of_range, "axes", 1.0);
	refuse(good_box, [](Shape &s) { s.axes[2].x = nan_value; }, ErrorCode::not_finite, "axes", nan_value);
	refuse(good_cylinder, [](Shape &s) { s.half_size.x = 0.0; }, ErrorCode::not_positive, "radius", 0.0);
	refuse(good_cylinder, [](Shape &s) { s.half_size.y = -3.0; }, ErrorCode::not_positive, "half_height", -3.0);
	refuse(
			good_cylinder, [](Shape &s) { s.kind = ShapeKind::sphere, s.half_size.x = -1.0; }, ErrorCode::not_positive,
			"radius", -1.0);
	refuse(good_path, [](Shape &s) { s.half_size.x = 0.0; }, ErrorCode::not_positive, "half_width", 0.0);
	refuse(good_path, [](Shape &s) { s.outline.pop_back(); }, ErrorCode::wrong_size, "outline", 1.0);
	refuse(good_polygon, [](Shape &s) { s.outline.pop_back(); }, ErrorCode::wrong_size, "outline", 2.0);
	refuse(good_polygon, [](Shape &s) { s.outline.resize(65537); }, ErrorCode::wrong_size, "outline", 65537.0);
	refuse(good_polygon, [](Shape &s) { s.outline[1].y = nan_value; }, ErrorCode::not_finite, "outline", nan_value);
	refuse(good_polygon, [](Shape &s) { s.outline[2].x = -2e9; }, ErrorCode::out_of_range, "outline", -2e9);
	refuse(good_box, [](Shape &s) { s.kind = static_cast<ShapeKind>(9); }, ErrorCode::out_of_range, "kind", 9.0);

	// Properties that a kind does not use are not checked. Axes in single precision are accurate
	// enough.
	Shape sphere = good_box;
	sphere.kind = ShapeKind::sphere;
	sphere.axes = glm::dmat3(0.0);
	sphere.half_size = {1.0, -1.0, nan_value};
	sphere.outline = {{nan_value, 0.0}};
	CHECK(validate(sphere).ok());
	Shape rounded = good_box;
	rounded.axes = glm::dmat3(glm::mat3({0.6f, 0.0f, 0.8f}, {0.0f, 1.0f, 0.0f}, {-0.8f, 0.0f, 0.6f}));
	CHECK(validate(rounded).ok());
}

TEST_CASE("shapes: shapes that miss the position or cannot change the result are not computed") {
	// Computing the box involves only integers. Computing a sphere rounds.
	const Shape box{.kind = ShapeKind::box, .half_size = {4.0, 4.0, 4.0}, .outline = {}};
	const auto sphere = [](double x, bool exclude) {
		return Shape{.kind = ShapeKind::sphere,
				.exclude = exclude,
				.falloff = 2.3,
				.center = {x, 0.1, 0.2},
				.half_size = {7.7, 0.0, 0.0},
				.outline = {}};
	};
	const std::vector<std::uint32_t> near_shapes{0, 1};
	const auto computes_sphere = [&](std::vector<Shape> shapes) {
		ShapeSet set;
		REQUIRE(set.set(std::move(shapes)).ok());
		ShapeEffect effect;
		const bool computed = rounds([&] { effect = set.effect(near_shapes, {1.0, 1.0, 1.0}); });
		CHECK(effect.included == 1.0);
		return computed;
	};
	CHECK(computes_sphere({box, sphere(0.3, true)}));
	CHECK_FALSE(computes_sphere({box, sphere(30.3, true)})); // The sphere is too far away.
	CHECK_FALSE(computes_sphere({box, sphere(0.3, false)})); // The box already includes this position.
	CHECK(computes_sphere({sphere(0.3, false), box}));
}
