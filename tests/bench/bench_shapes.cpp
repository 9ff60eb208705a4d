// Measures the cost per point of a shape's density and of a triangle mesh's ground, at the points
// of a layer in tile order. Also measures the cost of building their search structures. Prints rows
// of a Markdown table.
//   bench_shapes [rounds = 9] [seconds a measurement = 0.25]

#include "tests/bench/common/command_line.hpp"
#include "tests/bench/common/contest.hpp"

#include "core/rules/shapes.hpp"
#include "core/terrain/triangle_terrain.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

namespace thicket::bench {
namespace {

constexpr Rect tile{{-100.0, -100.0}, {100.0, 100.0}};

/// Returns the outline of a coast with bays of all sizes, which crosses the tile.
std::vector<glm::dvec2> coast() {
	std::vector<glm::dvec2> points;
	for (std::size_t i = 0; i < max_outline_points; ++i) {
		const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / max_outline_points;
		const double radius =
				80.0 + 20.0 * std::sin(7.0 * angle) + 4.0 * std::sin(61.0 * angle) + 0.5 * std::sin(4001.0 * angle);
		points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
	}
	return points;
}

struct Contender {
	const char *name;
	Shape shape;
};

std::vector<Contender> contenders() {
	Shape solid;
	solid.half_size = {80.0, 60.0, 90.0};
	solid.axes = glm::dmat3({0.8, -0.6, 0.0}, {0.6, 0.8, 0.0}, {0.0, 0.0, 1.0});
	solid.falloff = 10.0;
	Shape line;
	line.outline = coast();
	line.half_size.x = 4.0;
	const auto with_kind = [](Shape shape, ShapeKind kind, double falloff, bool ignore_height) {
		shape.kind = kind;
		shape.falloff = falloff;
		shape.ignore_height = ignore_height;
		return shape;
	};
	return {
			{"box", with_kind(solid, ShapeKind::box, 10.0, false)},
			{"sphere", with_kind(solid, ShapeKind::sphere, 10.0, false)},
			{"cylinder", with_kind(solid, ShapeKind::cylinder, 10.0, false)},
			{"leaning box without height", with_kind(solid, ShapeKind::box, 10.0, true)},
			{"leaning cylinder without height", with_kind(solid, ShapeKind::cylinder, 10.0, true)},
			{"polygon of 65,536 corners, sharp", with_kind(line, ShapeKind::polygon, 0.0, false)},
			{"polygon of 65,536 corners, falloff of 10 m", with_kind(line, ShapeKind::polygon, 10.0, false)},
			{"path of 65,536 points, 8 m wide", with_kind(line, ShapeKind::path, 2.0, false)},
	};
}

/// Returns the corners of 100,352 triangles: two per square meter over a square of 224 m.
std::vector<glm::dvec3> hills() {
	constexpr int side = 224;
	const auto post = [](int column, int row) {
		const double x = column - side / 2;
		const double z = row - side / 2;
		return glm::dvec3(x, 10.0 * std::sin(0.05 * x) * std::cos(0.03 * z), z);
	};
	std::vector<glm::dvec3> corners;
	for (int row = 0; row < side; ++row) {
		for (int column = 0; column < side; ++column) {
			const std::array<glm::dvec3, 4> corner{
					post(column, row), post(column + 1, row), post(column + 1, row + 1), post(column, row + 1)};
			corners.insert(corners.end(), {corner[0], corner[1], corner[2], corner[0], corner[2], corner[3]});
		}
	}
	return corners;
}

void run_shapes(const Effort &effort) {
	const std::vector<glm::dvec2> at = points_of(tile);
	const std::vector<Contender> all = contenders();
	std::vector<ShapeSet> sets(all.size());
	std::vector<std::uint32_t> near_shapes;
	volatile double sum = 0.0;
	Contest contest(at.size());
	Series set;
	for (int round = 0; round < effort.rounds; ++round) {
		for (std::size_t i = 0; i < all.size(); ++i) {
			require(sets[i].set({all[i].shape}));
			contest.measure(i, all[i].name, effort.seconds, [&] {
				static_cast<void>(sets[i].find_nearby(tile, near_shapes));
				double tile_sum = 0.0;
				for (const glm::dvec2 position : at) {
					tile_sum += sets[i].density(near_shapes, {position.x, 1.0, position.y});
				}
				sum = tile_sum;
			});
		}
		set.add(1e3 / rate(effort.seconds, [&] { return require(sets[6].set({all[6].shape})), 1; }));
	}
	contest.print();
	print_row("polygon of 65,536 corners: taken over after an edit", set, 1.0, " ms");
}

void run_triangles(const Effort &effort) {
	const std::vector<glm::dvec2> at = points_of(tile);
	const std::vector<glm::dvec3> corners = hills();
	TriangleTerrain terrain;
	std::vector<Ground> ground(at.size());
	Series set, ask;
	for (int round = 0; round < effort.rounds; ++round) {
		set.add(1e3 / rate(effort.seconds, [&] { return require(terrain.set(corners)), 1; }));
		ask.add(1e9 / rate(effort.seconds, [&] { return require(terrain.sample(at, ground)), at.size(); }));
	}
	print_row("100,352 triangles: built", set, 1.0, " ms");
	print_row("100,352 triangles: ground at a point", ask, 1.0, " ns", 1);
}

} // namespace
} // namespace thicket::bench

int main(int argument_count, char **arguments) {
	const thicket::bench::Effort effort = thicket::bench::effort_of(argument_count, arguments);
	thicket::bench::run_shapes(effort);
	thicket::bench::run_triangles(effort);
}
