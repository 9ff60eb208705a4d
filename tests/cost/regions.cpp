#include "tests/cost/growth.hpp"

#include "core/rules/polyline.hpp"
#include "core/rules/shapes.hpp"

#include <array>

namespace thicket::cost {

namespace {

void question(const ShapeSet &set) {
	for (const glm::dvec2 &position : fixed_positions()) {
		std::vector<std::uint32_t> near_shapes;
		need(set.find_nearby({position - 1.0, position + 1.0}, near_shapes));
		static_cast<void>(set.density(near_shapes, {position.x, 0.0, position.y}));
	}
}

std::uint64_t outline(const Recipe &recipe, std::size_t count, ShapeKind kind) {
	Shape shape;
	shape.kind = kind;
	shape.half_size.x = 2.0;
	shape.falloff = 1.0;
	shape.outline = recipe.points(count);
	return steps_of([&] {
		ShapeSet set;
		need(set.set({shape}));
		question(set);
	});
}

std::uint64_t polygon(const Recipe &recipe, std::size_t count) { return outline(recipe, count, ShapeKind::polygon); }

std::uint64_t path(const Recipe &recipe, std::size_t count) { return outline(recipe, count, ShapeKind::path); }

std::uint64_t many_shapes(const Recipe &recipe, std::size_t count) {
	std::vector<Shape> shapes;
	for (const glm::dvec2 &center : recipe.points(count)) {
		Shape &shape = shapes.emplace_back();
		shape.kind = ShapeKind::sphere;
		shape.center = {center.x, 0.0, center.y};
		shape.half_size.x = 5.0;
	}
	return steps_of([&] {
		ShapeSet set;
		need(set.set(shapes));
		question(set);
	});
}

std::uint64_t simplify(const Recipe &recipe, std::size_t count) {
	const Points line = recipe.points(count);
	return steps_of([&] { static_cast<void>(simplified(line, recipe.step())); });
}

constexpr std::array cases = {
		Case{"region: polygon", polygon},
		Case{"region: path", path},
		Case{"region: many shapes", many_shapes},
		Case{"region: simplify a line", simplify},
};

} // namespace

std::span<const Case> cases_of_regions() { return cases; }

} // namespace thicket::cost
