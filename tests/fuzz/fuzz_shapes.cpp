// Evaluates random shapes and triangles, valid and invalid, at random positions and at their own
// corners.

#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz_main.hpp"

#include "core/rules/shapes.hpp"
#include "core/terrain/triangle_terrain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

using namespace thicket;
using namespace thicket::fuzz;

namespace {

/// Returns a random number or, in half of the cases, a small integer, so that lines intersect and
/// overlap.
double coordinate(Bytes &r_bytes) {
	return r_bytes.chance(2) ? static_cast<double>(r_bytes.below(9)) - 4.0 : r_bytes.number(-5.0, 5.0);
}

glm::dvec3 read_vector(Bytes &r_bytes) {
	const double x = coordinate(r_bytes);
	const double y = coordinate(r_bytes);
	return {x, y, coordinate(r_bytes)};
}

/// Returns axes that are orthonormal, nearly orthonormal, or random.
glm::dmat3 read_axes(Bytes &r_bytes) {
	glm::dmat3 axes(1.0);
	switch (r_bytes.below(4)) {
		case 0: axes = glm::dmat3({0.8, -0.6, 0.0}, {0.6, 0.8, 0.0}, {0.0, 0.0, 1.0}); break;
		case 1: axes = glm::dmat3({0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}); break;
		case 2: axes[1].x = r_bytes.number(-1e-6, 1e-6); break;
		default: break;
	}
	if (r_bytes.chance(16)) {
		axes[r_bytes.below(3) % 3] = read_vector(r_bytes);
	}
	return axes;
}

Shape read_shape(Bytes &r_bytes) {
	Shape shape;
	shape.kind = static_cast<ShapeKind>(r_bytes.below(r_bytes.chance(32) ? 7 : 5));
	shape.exclude = r_bytes.chance(3);
	shape.ignore_height = r_bytes.chance(2);
	shape.falloff = r_bytes.chance(3) ? 0.0 : r_bytes.number(0.0, 4.0);
	shape.center = read_vector(r_bytes);
	shape.axes = read_axes(r_bytes);
	shape.half_size = {r_bytes.number(0.1, 5.0), r_bytes.number(0.1, 5.0), r_bytes.number(0.1, 5.0)};
	for (std::uint32_t points = r_bytes.below(24); points > 0; --points) {
		const double x = coordinate(r_bytes);
		shape.outline.emplace_back(x, coordinate(r_bytes));
	}
	return shape;
}

double density_of(const ShapeSet &set, glm::dvec3 position) {
	std::vector<std::uint32_t> near_shapes;
	const glm::dvec2 flat(position.x, position.z);
	static_cast<void>(set.find_nearby({flat, flat}, near_shapes));
	return set.density(near_shapes, position);
}

void check_shapes(Bytes &r_bytes) {
	std::vector<Shape> shapes;
	for (std::uint32_t count = r_bytes.below(5); count > 0; --count) {
		Shape shape = read_shape(r_bytes);
		const bool sound = validate(shape).ok();
		require(ShapeSet().set({shape}).ok() == sound, "a set accepts exactly the valid shapes");
		if (sound) {
			const Rect shape_bounds = bounds(shape);
			require(shape_bounds.finite() && shape_bounds.min.x <= shape_bounds.max.x &&
							shape_bounds.min.y <= shape_bounds.max.y,
					"bounds are a rectangle");
			shapes.push_back(shape);
		}
	}
	ShapeSet set;
	require(set.set(shapes).ok(), "valid shapes are accepted");
	const Rect all{{-1e12, -1e12}, {1e12, 1e12}};
	std::vector<std::uint32_t> every;
	static_cast<void>(set.find_nearby(all, every));
	require(every.size() == shapes.size(), "all shapes are near everywhere");
	for (int i = 0; i < 20; ++i) {
		glm::dvec3 position = read_vector(r_bytes);
		if (!shapes.empty() && r_bytes.chance(3)) {
			const Shape &shape = shapes[r_bytes.below(static_cast<std::uint32_t>(shapes.size()))];
			position = shape.outline.empty() ? shape.center
											 : glm::dvec3(shape.outline[0].x, position.y, shape.outline[0].y);
		}
		const double density = density_of(set, position);
		require(density >= 0.0 && density <= 1.0, "a density is between 0 and 1");
		require(density == set.density(every, position), "shapes that are not near have no effect");
		for (Shape shape : shapes) {
			shape.exclude = false;
			ShapeSet alone;
			require(alone.set({shape}).ok(), "a valid shape is accepted alone");
			require(alone.density({}, position) == 0.0, "an including shape that is not near includes nothing");
			require(density_of(alone, position) == 0.0 || bounds(shape).contains({position.x, position.z}),
					"outside of its bounds a shape has no influence");
		}
	}
}

bool sound_ground(const Ground &ground, double lowest, double highest) {
	const glm::dvec3 normal(ground.normal);
	const double length = std::sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
	return std::isnan(ground.height) ||
			(ground.height >= static_cast<float>(lowest) && ground.height <= static_cast<float>(highest) &&
					std::abs(length - 1.0) < 1e-6 && normal.y >= 0.0);
}

void check_triangles(Bytes &r_bytes) {
	std::vector<glm::dvec3> corners;
	double lowest = std::numeric_limits<double>::infinity();
	double highest = -lowest;
	for (std::uint32_t count = 3 * r_bytes.below(30); count > 0; --count) {
		corners.push_back(read_vector(r_bytes));
		lowest = std::min(lowest, corners.back().y);
		highest = std::max(highest, corners.back().y);
	}
	TriangleTerrain terrain;
	if (!terrain.set(corners).ok()) {
		return;
	}
	for (int i = 0; i < 20; ++i) {
		const glm::dvec3 position = read_vector(r_bytes);
		require(sound_ground(terrain.at({position.x, position.z}), lowest, highest), "ground lies between the corners");
	}
	for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
		TriangleTerrain alone;
		require(alone.set(std::span(corners).subspan(i, 3)).ok(), "a triangle of a valid mesh is valid");
		if (alone.area().empty()) {
			continue;
		}
		for (std::size_t corner = i; corner < i + 3; ++corner) {
			const glm::dvec2 position(corners[corner].x, corners[corner].z);
			const float height = terrain.at(position).height;
			require(height >= alone.at(position).height, "a corner has ground, and adding triangles never lowers it");
		}
	}
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
	Bytes bytes(data, size);
	if (bytes.chance(2)) {
		check_shapes(bytes);
	} else {
		check_triangles(bytes);
	}
	return 0;
}
