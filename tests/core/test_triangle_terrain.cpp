#include "core/terrain/triangle_terrain.hpp"
#include "refusal.hpp"
#include "rounding.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <span>
#include <atomic>
#include <vector>

using namespace thicket;
using test::rounds;

namespace {

using Corners = std::vector<glm::dvec3>;

TriangleTerrain terrain_of(const Corners &corners) {
	TriangleTerrain terrain;
	REQUIRE(terrain.set(corners).ok());
	return terrain;
}

bool hole(const TriangleTerrain &terrain, glm::dvec2 position) { return std::isnan(terrain.at(position).height); }

/// Returns a level square of two triangles at `height`, with edges of twice `half`.
Corners square(double height, double half, glm::dvec2 center = glm::dvec2(0.0)) {
	const auto corner = [&](double x, double z) {
		return glm::dvec3(center.x + x, height, center.y + z);
	};
	return {corner(-half, -half), corner(half, -half), corner(half, half), corner(-half, -half), corner(half, half),
			corner(-half, half)};
}

Corners operator+(Corners a, const Corners &b) {
	a.insert(a.end(), b.begin(), b.end());
	return a;
}

/// A surface without gaps: a rotated grid of height samples with random heights, and cells with random
/// diagonals and windings. The displacement of the samples is so small that all cells remain convex.
struct Hills {
	glm::ivec2 cells{0};
	std::vector<glm::dvec3> posts;
	Corners corners;

	glm::dvec3 post(int x, int z) const { return posts[static_cast<std::size_t>(z * (cells.x + 1) + x)]; }
};

Hills random_surface(glm::ivec2 cells, double size, glm::dvec2 origin, std::mt19937 &random) {
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	const double turn = 3.0 * unit(random);
	const double cosine = std::cos(turn);
	const double sine = std::sin(turn);
	Hills surface;
	surface.cells = cells;
	for (int z = 0; z <= cells.y; ++z) {
		for (int x = 0; x <= cells.x; ++x) {
			const glm::dvec2 pushed(x + 0.24 * unit(random), z + 0.24 * unit(random));
			const glm::dvec2 at = origin +
					size * glm::dvec2(cosine * pushed.x - sine * pushed.y, sine * pushed.x + cosine * pushed.y);
			surface.posts.emplace_back(at.x, 5.0 * size * unit(random), at.y);
		}
	}
	const auto add = [&](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
		if (random() % 2 == 0) {
			std::swap(b, c);
		}
		surface.corners.insert(surface.corners.end(), {a, b, c});
	};
	for (int z = 0; z < cells.y; ++z) {
		for (int x = 0; x < cells.x; ++x) {
			const std::array<glm::dvec3, 4> corner{
					surface.post(x, z), surface.post(x + 1, z), surface.post(x + 1, z + 1), surface.post(x, z + 1)};
			const std::size_t first = random() % 2;
			add(corner[first], corner[first + 1], corner[first + 2]);
			add(corner[first], corner[first + 2], corner[(first + 3) % 4]);
		}
	}
	return surface;
}

/// Returns the height of a triangle's plane at a position.
double plane_height(std::span<const glm::dvec3, 3> corner, glm::dvec2 position) {
	const glm::dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
	const glm::dvec2 offset = position - glm::dvec2(corner[0].x, corner[0].z);
	return corner[0].y - (normal.x * offset.x + normal.z * offset.y) / normal.y;
}

std::span<const glm::dvec3, 3> triangle_at(const Corners &corners, std::size_t index) {
	return std::span(corners).subspan(index * 3).first<3>();
}

} // namespace

TEST_CASE("triangles: only a triangle, its edges and its corners have ground") {
	// The triangle rises by 1 m per meter along x, so its slope is 45 degrees.
	const Corners triangle{{0.0, 10.0, 0.0}, {4.0, 14.0, 0.0}, {0.0, 10.0, 4.0}};
	const double half = std::sqrt(0.5);
	for (const std::array<std::size_t, 3> order : {std::array<std::size_t, 3>{0, 1, 2}, {2, 1, 0}, {1, 2, 0}}) {
		const TriangleTerrain terrain = terrain_of({triangle[order[0]], triangle[order[1]], triangle[order[2]]});
		for (const glm::dvec2 position : {glm::dvec2(0.0, 0.0), glm::dvec2(4.0, 0.0), glm::dvec2(0.0, 4.0),
					 glm::dvec2(2.0, 0.0), glm::dvec2(0.0, 3.0), glm::dvec2(1.0, 3.0), glm::dvec2(1.0, 1.0)}) {
			const Ground ground = terrain.at(position);
			CHECK(ground.height == static_cast<float>(10.0 + position.x));
			CHECK(glm::distance(ground.normal, glm::vec3(-half, half, 0.0)) < 1e-7f);
			CHECK(ground.weight == 1.0f);
		}
		for (const glm::dvec2 position : {glm::dvec2(-1e-12, 1.0), glm::dvec2(1.0, -1e-12),
					 glm::dvec2(2.0 + 1e-12, 2.0), glm::dvec2(4.0 + 1e-12, 0.0), glm::dvec2(3.0, 3.0),
					 glm::dvec2(nan_value, 1.0), glm::dvec2(1.0, nan_value), glm::dvec2(infinite_value, 1.0),
					 glm::dvec2(1.0, -infinite_value)}) {
			CHECK(hole(terrain, position));
		}
		CHECK(terrain.area().min == glm::dvec2(0.0));
		CHECK(terrain.area().max == glm::dvec2(4.0));
	}
}

TEST_CASE("triangles: without triangles, or with only upright triangles, there is no ground") {
	CHECK(hole(TriangleTerrain(), {0.0, 0.0}));
	const TriangleTerrain no_triangles = terrain_of({});
	CHECK(hole(no_triangles, {0.0, 0.0}));
	CHECK(no_triangles.area().empty());
	// A wall, a line and a point. The wall's corners have no exact binary representation.
	const TriangleTerrain walls = terrain_of({{0.1, 0.0, 0.7}, {0.1, 9.0, 0.7}, {0.3, 3.0, 2.1}, {0.0, 0.0, 0.0},
			{1.0, 1.0, 1.0}, {2.0, 2.0, 2.0}, {5.0, 5.0, 5.0}, {5.0, 5.0, 5.0}, {5.0, 5.0, 5.0}});
	CHECK(hole(walls, {0.1, 0.7}));
	CHECK(hole(walls, {1.0, 1.0}));
	CHECK(hole(walls, {5.0, 5.0}));
	CHECK(walls.area().empty());
	// A wall on a floor does not change the ground, despite its height.
	const TriangleTerrain room =
			terrain_of(square(1.0, 8.0) + Corners{{2.0, 0.0, -3.0}, {2.0, 9.0, 0.0}, {2.0, 0.0, 3.0}});
	CHECK(room.at({2.0, 0.0}).height == 1.0f);
	CHECK(room.at({2.0, 0.0}).normal == glm::vec3(0.0f, 1.0f, 0.0f));
}

TEST_CASE("triangles: the topmost triangle is the ground, also for bridges and undersides of rocks") {
	const Corners valley = square(-3.0, 20.0);
	const Corners bridge = square(5.0, 4.0, {2.0, -1.0});
	Corners underside = square(2.0, 5.0, {-10.0, 0.0});
	std::ranges::reverse(underside); // This square faces down.
	for (const Corners &all : {valley + bridge + underside, underside + bridge + valley}) {
		const TriangleTerrain terrain = terrain_of(all);
		CHECK(terrain.at({2.0, -1.0}).height == 5.0f);
		CHECK(terrain.at({6.0, 3.0}).height == 5.0f); // The bridge's corner.
		CHECK(terrain.at({6.001, 3.0}).height == -3.0f);
		CHECK(terrain.at({-10.0, 0.0}).height == 2.0f);
		CHECK(terrain.at({-10.0, 0.0}).normal == glm::vec3(0.0f, 1.0f, 0.0f));
		CHECK(terrain.at({0.0, 15.0}).height == -3.0f);
	}
}

TEST_CASE("triangles: the first of equally high triangles determines the normal") {
	const Corners level{{0.0, 1.0, 0.0}, {4.0, 1.0, 0.0}, {2.0, 1.0, 4.0}};
	const Corners rising{{0.0, 1.0, 0.0}, {4.0, 1.0, 0.0}, {2.0, 5.0, -4.0}};
	for (const double x : {0.0, 1.0, 2.0, 4.0}) {
		CHECK(terrain_of(level + rising).at({x, 0.0}).normal == glm::vec3(0.0f, 1.0f, 0.0f));
		CHECK(terrain_of(rising + level).at({x, 0.0}).normal.y < 0.8f);
	}
	// A level triangle has exactly one height, so rounding never puts it below a triangle that
	// slopes down from its edge.
	const Corners floor{{0.0, 0.1, 0.0}, {3.7, 0.1, 0.0}, {2.0, 0.1, 4.1}};
	const Corners slope{{0.0, 0.1, 0.0}, {3.7, 0.1, 0.0}, {1.3, -5.0, -2.9}};
	const TriangleTerrain edge = terrain_of(floor + slope);
	for (double x = 0.0; x < 3.7; x += 0.01) {
		CHECK(edge.at({x, 0.0}).normal == glm::vec3(0.0f, 1.0f, 0.0f));
	}
}

TEST_CASE("triangles: a mesh has no cracks, and only its own holes") {
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	for (const double size : {1e-3, 1.0, 300.0}) {
		for (const glm::dvec2 origin : {glm::dvec2(0.0), glm::dvec2(-1234.5, 9876.5), glm::dvec2(9e6, -9e6)}) {
			const Hills surface = random_surface({9, 6}, size, origin, random);
			const TriangleTerrain terrain = terrain_of(surface.corners);
			// Allows for rounding on slopes of 5 and more.
			const double grain = glm::length(origin) * 1e-15 + size * 1e-7;
			for (const glm::dvec3 post : surface.posts) {
				CHECK(std::abs(terrain.at({post.x, post.z}).height - post.y) <= 50.0 * grain);
			}
			for (int z = 1; z < surface.cells.y; ++z) {
				for (int x = 1; x < surface.cells.x; ++x) {
					// Positions along the inner edges, from sample to sample.
					const glm::dvec3 from = surface.post(x, z);
					for (const glm::dvec3 neighbor : {surface.post(x - 1, z), surface.post(x, z - 1)}) {
						for (int i = 0; i < 40; ++i) {
							const glm::dvec3 at = glm::mix(from, neighbor, unit(random));
							const float height = terrain.at({at.x, at.z}).height;
							CHECK(!std::isnan(height));
							CHECK(std::abs(height - at.y) <= 500.0 * grain);
						}
					}
				}
			}
			for (std::size_t i = 0; i < surface.corners.size() / 3; ++i) {
				const auto corner = triangle_at(surface.corners, i);
				const double u = 0.05 + 0.4 * unit(random);
				const double v = 0.05 + 0.4 * unit(random);
				const glm::dvec3 at = corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]);
				CHECK(std::abs(terrain.at({at.x, at.z}).height - at.y) <= 500.0 * grain);
				// Removing a triangle leaves a hole.
				Corners holed = surface.corners;
				holed.erase(holed.begin() + static_cast<std::ptrdiff_t>(3 * i),
						holed.begin() + static_cast<std::ptrdiff_t>(3 * i + 3));
				CHECK(hole(terrain_of(holed), {at.x, at.z}));
			}
		}
	}
}

TEST_CASE("triangles: slivers that meet in a fan have no crack, and no height beyond their corners'") {
	// 2,000 triangles that share one corner, near which they are narrower than the precision of
	// double.
	constexpr int blades = 2000;
	const glm::dvec3 tip(1e5 / 3.0, 7.0, -1e5 / 7.0);
	std::mt19937 random(2);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	Corners fan;
	std::vector<glm::dvec3> rim;
	for (int i = 0; i <= blades; ++i) {
		const double angle = 1e-5 * i / blades;
		rim.push_back(tip + 50.0 * glm::dvec3(std::cos(angle), 0.1, std::sin(angle)));
	}
	for (std::size_t i = 0; i < blades; ++i) {
		fan.insert(fan.end(), {tip, rim[i], rim[i + 1]});
	}
	const TriangleTerrain terrain = terrain_of(fan);
	for (int i = 0; i < 20000; ++i) {
		const glm::dvec3 on_rim = rim[1 + random() % (blades - 1)];
		const double fraction = unit(random);
		const glm::dvec3 at = glm::mix(tip, on_rim, fraction * fraction * fraction * 0.999999);
		const glm::dvec2 position(at.x, at.z);
		if (position.y <= tip.z || position == glm::dvec2(tip.x, tip.z)) {
			continue; // The position is so near the tip that rounding moved it out of the fan.
		}
		const float height = terrain.at(position).height;
		// A position may miss the fan only where the fan is at most one or two rounding steps of
		// the coordinates wide.
		CHECK((!std::isnan(height) || fraction * fraction * fraction * 50.0 * 1e-5 < 2e-11));
		CHECK((std::isnan(height) || std::abs(height - at.y) < 1e-4));
		const glm::dvec3 normal(terrain.at(position).normal);
		CHECK((std::isnan(height) || glm::distance(normal, glm::normalize(glm::dvec3(-0.1, 1.0, 0.0))) < 1e-3));
	}
}

TEST_CASE("triangles: random triangles of all sizes match a scan of all triangles, in any order") {
	std::mt19937 random(3);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	for (const std::size_t count : std::vector<std::size_t>{1, 2, 4, 5, 8, 9, 17, 33, 100, 500}) {
		Corners corners;
		for (std::size_t i = 0; i < count; ++i) {
			const double size = i % 10 == 0 ? 100.0 : 8.0;
			const glm::dvec3 center(100.0 * unit(random), 20.0 * unit(random), 60.0 * unit(random));
			for (int k = 0; k < 3; ++k) {
				corners.push_back(center + size * glm::dvec3(unit(random), 0.2 * unit(random), unit(random)));
			}
		}
		const TriangleTerrain terrain = terrain_of(corners);
		Corners backwards = corners;
		std::ranges::reverse(backwards);
		const TriangleTerrain reversed = terrain_of(backwards);
		for (int i = 0; i < 300; ++i) {
			const glm::dvec2 position(120.0 * unit(random), 80.0 * unit(random));
			double expected = -1e300;
			for (std::size_t k = 0; k < count; ++k) {
				const auto corner = triangle_at(corners, k);
				int sides = 0;
				for (std::size_t edge = 0; edge < 3; ++edge) {
					const glm::dvec3 edge_vector = corner[(edge + 1) % 3] - corner[edge];
					const glm::dvec2 offset = position - glm::dvec2(corner[edge].x, corner[edge].z);
					sides += edge_vector.x * offset.y - edge_vector.z * offset.x > 0.0 ? 1 : -1;
				}
				if (std::abs(sides) == 3) {
					expected = std::max(expected, plane_height(corner, position));
				}
			}
			const Ground ground = terrain.at(position);
			CHECK(std::isnan(ground.height) == (expected == -1e300));
			CHECK((std::isnan(ground.height) || std::abs(ground.height - expected) < 1e-4));
			const Ground reversed_ground = reversed.at(position);
			CHECK(std::memcmp(&ground.height, &reversed_ground.height, sizeof(float)) == 0);
			CHECK(glm::distance(ground.normal, reversed_ground.normal) < 1e-6f);
		}
	}
}

TEST_CASE("triangles: normals are accurate, from gentle to nearly upright triangles") {
	for (const double degrees : {0.0, 1.0, 30.0, 45.0, 60.0, 89.0, 89.999}) {
		const double angle = degrees * 3.14159265358979323846 / 180.0;
		const glm::dvec3 along(std::cos(angle), std::sin(angle), 0.0);
		const TriangleTerrain terrain =
				terrain_of({glm::dvec3(0.0), 3.0 * along, 3.0 * along + glm::dvec3(0.0, 0.0, 3.0)});
		const Ground ground = terrain.at({2.0 * along.x, 1.0});
		CHECK(glm::distance(glm::dvec3(ground.normal), glm::dvec3(-along.y, along.x, 0.0)) < 1e-6);
		CHECK(std::abs(ground.height - 2.0 * along.y) < 1e-5);
	}
}

TEST_CASE("triangles: a hundred thousand side by side, and all of them above one position") {
	std::mt19937 random(4);
	const Hills surface = random_surface({250, 200}, 2.0, {-250.0, 100.0}, random);
	const TriangleTerrain terrain = terrain_of(surface.corners);
	for (const glm::dvec3 post : surface.posts) {
		CHECK(std::abs(terrain.at({post.x, post.z}).height - post.y) < 1e-4);
	}
	Corners tower;
	for (int i = 0; i < 50000; ++i) {
		tower = std::move(tower) + square((i * 7919) % 50000, 4.0);
	}
	CHECK(terrain_of(tower).at({1.0, 2.0}).height == 49999.0f);
}

TEST_CASE("triangles: errors name the invalid property and leave the terrain unchanged") {
	TriangleTerrain terrain = terrain_of(square(3.0, 1.0));
	const auto refuse = [&](const Corners &bad, ErrorCode code, const char *property, double value) {
		check_refused(terrain.set(bad), code, property, value);
		CHECK(terrain.at({0.5, 0.5}).height == 3.0f);
	};
	const Corners good = square(1.0, 1.0);
	refuse({good.begin(), good.begin() + 5}, ErrorCode::wrong_size, "corners", 5.0);
	for (const int axis : {0, 1, 2}) {
		const auto with = [&](double value) {
			Corners bad = good;
			bad[4][axis] = value;
			return bad;
		};
		refuse(with(nan_value), ErrorCode::not_finite, "corners", nan_value);
		refuse(with(-infinite_value), ErrorCode::not_finite, "corners", -infinite_value);
		refuse(with(1.1e7), ErrorCode::out_of_range, "corners", 1.1e7);
		refuse(with(-1.1e7), ErrorCode::out_of_range, "corners", -1.1e7);
	}
	std::vector<Ground> ground(2);
	check_refused(terrain.sample(std::vector<glm::dvec2>(3), ground), ErrorCode::wrong_size, "ground", 2.0);
}

TEST_CASE("triangles: the error names the first invalid corner") {
	std::vector<glm::dvec3> corners(9, glm::dvec3(1.0));
	CHECK(TriangleTerrain::find_refused_corner(corners) == 9);
	corners[7].x = -2.0 * TriangleTerrain::max_extent;
	CHECK(TriangleTerrain::find_refused_corner(corners) == 7);
	corners[4].y = infinite_value;
	CHECK(TriangleTerrain::find_refused_corner(corners) == 4);
	corners[3].z = nan_value;
	CHECK(TriangleTerrain::find_refused_corner(corners) == 3);
}

TEST_CASE("triangles: a canceled build has no effect") {
	const std::vector<glm::dvec3> single{{0.0, 1.0, 0.0}, {4.0, 1.0, 0.0}, {0.0, 1.0, 4.0}};
	TriangleTerrain terrain;
	REQUIRE(terrain.set(single).ok());
	std::vector<glm::dvec3> many_corners;
	for (int i = 0; i < 3000; ++i) {
		many_corners.emplace_back(0.1 * i, 5.0, i % 3);
	}
	std::atomic<bool> cancel = true;
	CHECK(terrain.set(many_corners, &cancel).code == ErrorCode::cancelled);
	CHECK(terrain.at({1.0, 1.0}).height == 1.0F);
	cancel = false;
	CHECK(terrain.set(many_corners, &cancel).ok());
	CHECK(terrain.at({1.0, 1.0}).height == 5.0F);
}

TEST_CASE("triangles: triangles next to or below the position are not computed") {
	// Computing these triangles involves only integers. Four triangles form a leaf of the tree.
	Corners even_corners;
	for (const double height : {8.0, 9.0, 10.0, 11.0}) {
		even_corners = even_corners + Corners{{0.0, height, 0.0}, {4.0, height, 0.0}, {0.0, height, 4.0}};
	}
	// Computing these triangles rounds intermediate results.
	const auto uneven = [](glm::dvec2 center, double height) {
		Corners corners;
		for (int i = 0; i < 4; ++i) {
			const double distance = 20.1 + 0.3 * i;
			corners = corners +
					Corners{{center.x - distance, height, center.y - distance},
							{center.x + distance, height + 0.1, center.y - distance},
							{center.x + 0.1, height, center.y + distance}};
		}
		return corners;
	};
	const glm::dvec2 position{1.0, 1.0};
	const auto computes_uneven = [&](const Corners &corners) {
		const TriangleTerrain terrain = terrain_of(even_corners + corners);
		Ground ground;
		const bool has_ground = rounds([&] { ground = terrain.at(position); });
		CHECK(ground.height >= 11.0f);
		return has_ground;
	};
	// The uneven triangles come before the even ones in the tree in the first round, and after them
	// in the second.
	for (const double side : {-1.0, 1.0}) {
		CHECK_FALSE(computes_uneven(uneven({70.3 * side, 0.0}, 50.7)));
		CHECK_FALSE(computes_uneven(uneven({9.3 * side, 3.7 * side}, 0.7)));
		// These uneven triangles are above the even ones.
		CHECK(computes_uneven(uneven({9.3 * side, 3.7 * side}, 50.7)));
	}
}
