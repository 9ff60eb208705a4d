#pragma once

#include "core/rules/shapes.hpp"

#include <doctest/doctest.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

/// Test shapes, and slow reference implementations that share no code with the core.
namespace thicket::shape_cases {

inline Shape box(glm::dvec3 center, glm::dvec3 half_size, bool exclude = false) {
	Shape shape;
	shape.exclude = exclude;
	shape.center = center;
	shape.half_size = half_size;
	return shape;
}

/// Returns an upright cylinder around the origin.
inline Shape cylinder(double radius, double half_height) {
	Shape shape;
	shape.kind = ShapeKind::cylinder;
	shape.half_size = {radius, half_height, 0.0};
	return shape;
}

inline ShapeSet set_of(std::vector<Shape> shapes) {
	ShapeSet set;
	REQUIRE(set.set(std::move(shapes)).ok());
	return set;
}

inline Rect rect_around(glm::dvec2 center, double half) { return {center - half, center + half}; }

/// Returns the set's density at a position, computed from the shapes that `ShapeSet::near` finds
/// there.
inline double density_of(const ShapeSet &set, glm::dvec3 position) {
	std::vector<std::uint32_t> near_shapes;
	const glm::dvec2 flat(position.x, position.z);
	static_cast<void>(set.find_nearby({flat, flat}, near_shapes));
	return set.density(near_shapes, position);
}

/// Returns a random rotation: three orthonormal columns.
inline glm::dmat3 random_axes(std::mt19937 &random) {
	std::normal_distribution<double> normal;
	const auto direction = [&] {
		return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
	};
	const glm::dvec3 x = direction();
	const glm::dvec3 y = glm::normalize(glm::cross(x, direction()));
	return {x, y, glm::cross(x, y)};
}

/// Returns a randomly rotated volume with half sizes of 1 to 9 m. Its center is within 30 m of the
/// origin on each axis.
inline Shape random_volume(ShapeKind kind, std::mt19937 &random) {
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	const auto size = [&] {
		return 5.0 + 4.0 * unit(random);
	};
	Shape shape;
	shape.kind = kind;
	shape.center = {30.0 * unit(random), 3.0 * unit(random), 30.0 * unit(random)};
	shape.axes = random_axes(random);
	shape.half_size = {size(), size(), size()};
	return shape;
}

/// Returns random shapes of all kinds around the origin. About a third exclude plants. Some have no
/// falloff, and some ignore the height.
inline std::vector<Shape> random_shapes(std::size_t count, std::mt19937 &random) {
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	std::vector<Shape> shapes;
	for (std::size_t i = 0; i < count; ++i) {
		Shape shape = random_volume(static_cast<ShapeKind>(random() % 5), random);
		shape.exclude = random() % 3 == 0;
		shape.ignore_height = random() % 2 == 0;
		shape.falloff = random() % 3 == 0 ? 0.0 : 3.0 + 2.0 * unit(random);
		if (shape.kind == ShapeKind::polygon || shape.kind == ShapeKind::path) {
			const std::size_t points = 3 + random() % 20;
			for (std::size_t k = 0; k < points; ++k) {
				shape.outline.emplace_back(shape.center.x + 15.0 * unit(random), shape.center.z + 15.0 * unit(random));
			}
		}
		shapes.push_back(std::move(shape));
	}
	return shapes;
}

/// Returns the depth inside a box, sphere or cylinder in meters, negative outside, computed by the
/// textbook definitions.
inline double plain_depth(const Shape &shape, glm::dvec3 position) {
	const glm::dvec3 local = glm::transpose(shape.axes) * (position - shape.center);
	if (shape.kind == ShapeKind::box) {
		const glm::dvec3 gap = shape.half_size - glm::abs(local);
		return std::min({gap.x, gap.y, gap.z});
	}
	if (shape.kind == ShapeKind::sphere) {
		return shape.half_size.x - glm::length(local);
	}
	return std::min(shape.half_size.x - std::hypot(local.x, local.z), shape.half_size.y - std::abs(local.y));
}

/// Returns the extent of a shape from its center along a direction (its support function).
inline double support(const Shape &shape, glm::dvec3 direction) {
	const glm::dvec3 local = glm::transpose(shape.axes) * direction;
	if (shape.kind == ShapeKind::box) {
		return glm::dot(glm::abs(local), shape.half_size);
	}
	if (shape.kind == ShapeKind::sphere) {
		return shape.half_size.x;
	}
	return shape.half_size.x * std::hypot(local.x, local.z) + shape.half_size.y * std::abs(local.y);
}

/// Returns the distance in meters to the nearest tangent of the shape's shadow, its vertical
/// projection. The function samples tangents coarsely, then refines every local minimum by ternary
/// search.
inline double searched_shadow_depth(const Shape &shape, glm::dvec3 position) {
	constexpr int tangents = 720;
	constexpr double step = 2.0 * std::numbers::pi / tangents;
	const auto gap = [&](double angle) {
		const glm::dvec3 direction(std::cos(angle), 0.0, std::sin(angle));
		return support(shape, direction) - glm::dot(direction, position - shape.center);
	};
	double depth = gap(0.0);
	for (int i = 0; i < tangents; ++i) {
		if (gap(i * step) > std::min(gap((i - 1) * step), gap((i + 1) * step))) {
			continue;
		}
		double low = (i - 1) * step;
		double high = (i + 1) * step;
		while (high - low > 1e-9) {
			const double third = (high - low) / 3.0;
			if (gap(low + third) < gap(high - third)) {
				high -= third;
			} else {
				low += third;
			}
		}
		depth = std::min(depth, gap(low));
	}
	return depth;
}

} // namespace thicket::shape_cases
