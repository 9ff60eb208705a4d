// Shapes that act at any height on a planet: they extend along the direction away from its center.

#include "core/rules/planet_map.hpp"
#include "core/rules/shape_edits.hpp"
#include "refusal.hpp"
#include "shape_cases.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::shape_cases;

namespace {

const Planet planet{{30.0, -20.0, 10.0}, 100.0};

/// Moves a shape that ignores height to a direction from the planet's center, with its y axis up.
Shape placed(Shape shape, const glm::dvec3 &up, double altitude = 0.0) {
	shape.planet = planet;
	shape.ignore_height = true;
	shape.center = planet.center + (planet.radius + altitude) * up;
	shape.axes = PlanetMap(planet, shape.center).axes();
	return shape;
}

/// Returns a polygon or a path from positions in space.
Shape drawn(ShapeKind kind, const std::vector<glm::dvec3> &points) {
	Shape shape;
	shape.kind = kind;
	shape.planet = planet;
	for (const glm::dvec3 &point : points) {
		shape.center += point / static_cast<double>(points.size());
	}
	const PlanetMap map(planet, shape.center);
	for (const glm::dvec3 &point : points) {
		shape.outline.push_back(map.at(point));
	}
	return shape;
}

/// Returns a direction at an angle from the first of the axes, toward the second one.
glm::dvec3 rotated(const glm::dvec3 &from, const glm::dvec3 &target, double angle) {
	return std::cos(angle) * from + std::sin(angle) * target;
}

glm::dvec3 random_direction(std::mt19937 &random) { return random_axes(random)[0]; }

} // namespace

TEST_CASE("planet shapes: a map keeps lengths in its middle, and angles everywhere") {
	std::mt19937 random(3);
	for (int i = 0; i < 100; ++i) {
		const glm::dmat3 axes = random_axes(random);
		const PlanetMap map(planet, planet.center + 130.0 * axes[0]);
		CHECK(glm::length(map.at(planet.center + 7.0 * axes[0])) < 1e-9);
		const glm::dvec3 shifted = rotated(axes[0], axes[1], 0.02 * i);
		const glm::dvec2 position = map.at(planet.center + 250.0 * shifted);
		CHECK(glm::distance(map.direction(position), shifted) < 1e-12);
		CHECK(map.contains(position) == (0.02 * i < 150.0 * std::numbers::pi / 180.0));
		if (!map.contains(position)) {
			continue;
		}
		for (const glm::dvec3 &aside :
				{rotated(axes[0], axes[1], 0.02 * i + 1e-6), glm::normalize(shifted + 1e-6 * axes[2])}) {
			const double length = glm::distance(map.at(planet.center + aside), position);
			CHECK(length / (1e-6 * planet.radius) == doctest::Approx(map.scale(position)).epsilon(1e-4));
		}
	}
	CHECK(PlanetMap(planet, planet.center + glm::dvec3(0, 9, 0)).axes() == glm::dmat3(1.0));
	CHECK_FALSE(PlanetMap().exists());
}

TEST_CASE("planet shapes: places in the plane of a shadow have the up directions of their positions") {
	std::mt19937 random(5);
	for (int i = 0; i < 100; ++i) {
		const glm::dmat3 axes = random_axes(random);
		const PlanetMap map(planet, planet.center + 130.0 * axes[0]);
		const glm::dvec3 up = rotated(axes[0], axes[1], 0.015 * i);
		const glm::dvec3 at = map.at_middle(planet.center + 70.0 * up);
		CHECK(glm::distance(map.direction_at_middle({at.x, at.z}), up) < 1e-7);
		const glm::dvec3 rim = map.direction_at_middle({3.0 * at.x + 1e3, at.z});
		CHECK(glm::length(rim) == doctest::Approx(1.0));
		CHECK(std::abs(glm::dot(rim, axes[0])) < 1e-7);
	}
}

TEST_CASE("planet shapes: a cylinder covers the same area wherever it is placed, at every altitude") {
	std::mt19937 random(4);
	for (int i = 0; i < 200; ++i) {
		glm::dmat3 axes = random_axes(random);
		if (i < 3) { // The equator and the poles.
			const glm::dvec3 up = i == 0 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, i == 1 ? 1 : -1, 0);
			axes = glm::dmat3(up, glm::dvec3(0, 0, 1), glm::cross(up, glm::dvec3(0, 0, 1)));
		}
		Shape shape = placed(cylinder(12.0, 1.0), axes[0], 20.0);
		shape.falloff = i % 2 == 0 ? 0.0 : 4.0;
		const ShapeSet set = set_of({shape});
		for (const double altitude : {-90.0, -20.0, 0.0, 20.0, 80.0}) {
			for (const double distance : {0.0, 5.0, 9.5, 11.9, 12.1, 20.0, 119.0}) {
				const glm::dvec3 up = rotated(axes[0], axes[1 + i % 2], std::asin(distance / 120.0));
				const double expected =
						shape.falloff > 0.0 ? std::clamp((12.0 - distance) / 4.0, 0.0, 1.0) : distance < 12.0;
				CHECK(density_of(set, planet.center + (100.0 + altitude) * up) == doctest::Approx(expected));
				CHECK(density_of(set, planet.center - (100.0 + altitude) * up) == 0.0);
			}
		}
	}
}

TEST_CASE("planet shapes: polygons and paths that are rotated about the center cover the rotated ground") {
	std::mt19937 random(5);
	std::uniform_real_distribution<double> angle(0.0, 1.2);
	for (const ShapeKind kind : {ShapeKind::polygon, ShapeKind::path}) {
		std::vector<glm::dvec3> corners;
		for (const auto &[x, z] : {std::pair(-30.0, -20.0), {35.0, -25.0}, {20.0, 30.0}, {0.0, 5.0}, {-25.0, 28.0}}) {
			corners.emplace_back(x, 100.0, z);
		}
		const auto set_for = [&](const glm::dmat3 &axes) {
			std::vector<glm::dvec3> points;
			for (const glm::dvec3 &corner : corners) {
				points.push_back(planet.center + axes * corner);
			}
			Shape shape = drawn(kind, points);
			shape.half_size.x = kind == ShapeKind::path ? 6.0 : 0.0;
			shape.falloff = 3.0;
			return set_of({shape});
		};
		const ShapeSet top = set_for(glm::dmat3(1.0));
		int inside_count = 0;
		for (int i = 0; i < 100; ++i) {
			const glm::dmat3 axes = random_axes(random);
			const ShapeSet rotated_set = set_for(axes);
			for (int k = 0; k < 40; ++k) {
				const glm::dvec3 position =
						(100.0 + k) * glm::normalize(rotated({0, 1, 0}, random_direction(random), angle(random)));
				const double expected = density_of(top, planet.center + position);
				CHECK(density_of(rotated_set, planet.center + axes * position) ==
						doctest::Approx(expected).epsilon(1e-6));
				inside_count += expected > 0.0 ? 1 : 0;
			}
		}
		CHECK(inside_count > 100);
	}
}

TEST_CASE("planet shapes: a path around a planet has the same width everywhere") {
	std::mt19937 random(6);
	for (int i = 0; i < 50; ++i) {
		const glm::dmat3 axes = random_axes(random);
		std::vector<glm::dvec3> points;
		for (double angle = -2.3; angle < 2.3; angle += 0.002) {
			points.push_back(planet.center + planet.radius * rotated(axes[0], axes[1], angle));
		}
		Shape shape = drawn(ShapeKind::path, points);
		shape.half_size.x = 2.0;
		const ShapeSet set = set_of({shape});
		for (double angle = -2.2; angle <= 2.2; angle += 0.1) {
			const glm::dvec3 on_way = rotated(axes[0], axes[1], angle);
			for (const double side : {-2.05, -1.95, 0.0, 1.95, 2.05}) {
				const glm::dvec3 position = planet.center + 130.0 * rotated(on_way, axes[2], side / planet.radius);
				CHECK(density_of(set, position) == (std::abs(side) < 2.0 ? 1.0 : 0.0));
			}
		}
		CHECK(density_of(set, planet.center - 100.0 * axes[0]) == 0.0);
	}
}

TEST_CASE("planet shapes: the bounds and the edited areas contain everything that a shape affects") {
	std::mt19937 random(7);
	std::uniform_real_distribution<double> any(-1.0, 1.0);
	for (int i = 0; i < 400; ++i) {
		const glm::dvec3 up = random_direction(random);
		Shape shape;
		if (i % 4 < 2) {
			const double spread = i % 8 < 4 ? 0.2 : 1.5;
			std::vector<glm::dvec3> points;
			for (int k = 0; k < 5; ++k) {
				points.push_back(
						planet.center + planet.radius * glm::normalize(up + spread * random_direction(random)));
			}
			shape = drawn(i % 4 == 0 ? ShapeKind::polygon : ShapeKind::path, points);
			shape.half_size.x = i % 4 == 0 ? 0.0 : 3.0;
		} else {
			shape = placed(i % 4 == 2 ? cylinder(15.0, 5.0) : box({}, {20.0, 3.0, 40.0}), up);
			shape.axes = random_axes(random);
		}
		if (!validate(shape).ok()) {
			continue; // The outline surrounds the planet.
		}
		const ShapeSet set = set_of({shape});
		std::vector<Rect> areas;
		REQUIRE(find_shape_edits(nullptr, &set, areas) == shape.exclude);
		shape.exclude = true;
		const ShapeSet excluding = set_of({shape});
		REQUIRE(find_shape_edits(nullptr, &excluding, areas));
		// Without the planet, the shape in the frame of the map has exact bounds.
		const PlanetMap map(planet, shape.center);
		const bool flat = i % 4 < 2;
		Shape on_map = flat ? shape : rotated_upright(shape, map);
		on_map.planet = {};
		on_map.exclude = false;
		for (int k = 0; k < 200; ++k) {
			const glm::dvec3 direction = glm::normalize(up + 1.5 * any(random) * random_direction(random));
			const glm::dvec3 position = planet.center + (100.0 + 99.0 * any(random)) * direction;
			const glm::dvec2 at = map.at(position);
			on_map.half_size.x = flat ? map.scale(at) * shape.half_size.x : on_map.half_size.x;
			const glm::dvec3 expected = flat ? glm::dvec3(at.x, 0.0, at.y) : map.at_middle(position);
			const bool affected =
					density_of(set_of({on_map}), expected) > 0.0 && (flat ? map.contains(at) : expected.y > 0.0);
			CHECK((density_of(set, position) > 0.0) == affected);
			if (affected) {
				CHECK(std::ranges::any_of(
						areas, [&](const Rect &area) { return area.contains({position.x, position.z}); }));
			}
		}
	}
}

TEST_CASE("planet shapes: shapes without an up direction, and outlines around the planet, are rejected") {
	Shape shape = placed(cylinder(5.0, 5.0), {1, 0, 0});
	CHECK(validate(shape).ok());
	shape.center = planet.center;
	CHECK(validate(shape).code == ErrorCode::not_positive);
	shape.planet.radius = 1e10;
	CHECK(std::string_view(validate(shape).property) == "planet_radius");
	Shape path = drawn(ShapeKind::path, {planet.center + glm::dvec3(100, 0, 0), planet.center + glm::dvec3(0, 100, 0)});
	path.half_size.x = 2.0;
	CHECK(validate(path).ok());
	path.half_size.x = 51.0;
	CHECK(std::string_view(validate(path).property) == "half_width");
	path.half_size.x = 2.0;
	path.outline[0] = {750.0, 0.0};
	CHECK(validate(path).code == ErrorCode::out_of_range);
	CHECK(std::string_view(validate(path).property).starts_with("distance of the outline"));
}
