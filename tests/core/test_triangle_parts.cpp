#include "core/terrain/triangle_parts.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

using namespace thicket;

namespace {

using Corners = std::vector<glm::dvec3>;

TriangleParts::Part part_of(const Corners &corners) {
	auto triangles = std::make_shared<TriangleTerrain>();
	REQUIRE(triangles->set(corners).ok());
	return triangles;
}

TriangleParts terrain_of(const std::vector<TriangleParts::Part> &parts) {
	TriangleParts terrain;
	REQUIRE(terrain.set(parts).ok());
	return terrain;
}

bool same(const Ground &a, const Ground &b) {
	return std::memcmp(&a.height, &b.height, sizeof(float)) == 0 && a.normal == b.normal && a.weight == b.weight;
}

} // namespace

TEST_CASE("triangle parts: many meshes equal one mesh of all their triangles, in any order") {
	std::mt19937 random(11);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	for (const std::size_t count : std::vector<std::size_t>{1, 2, 4, 5, 9, 33, 300}) {
		Corners all;
		std::vector<TriangleParts::Part> parts;
		for (std::size_t i = 0; i < count; ++i) {
			Corners corners;
			const double size = i % 10 == 0 ? 60.0 : 6.0;
			const glm::dvec3 center(100.0 * unit(random), 20.0 * unit(random), 60.0 * unit(random));
			for (int k = 0; k < 3 * (1 + static_cast<int>(i % 4)); ++k) {
				corners.push_back(center + size * glm::dvec3(unit(random), 0.3 * unit(random), unit(random)));
			}
			parts.push_back(part_of(corners));
			all.insert(all.end(), corners.begin(), corners.end());
		}
		TriangleTerrain single;
		REQUIRE(single.set(all).ok());
		const TriangleParts terrain = terrain_of(parts);
		std::ranges::shuffle(parts, random);
		const TriangleParts shuffled = terrain_of(parts);
		std::size_t hit_count = 0;
		for (int i = 0; i < 2000; ++i) {
			const glm::dvec2 position(120.0 * unit(random), 80.0 * unit(random));
			const Ground ground = terrain.at(position);
			hit_count += std::isnan(ground.height) ? 0 : 1;
			CHECK((same(ground, single.at(position)) ||
					(std::isnan(ground.height) && std::isnan(single.at(position).height))));
			CHECK((same(ground, shuffled.at(position)) || std::isnan(ground.height)));
		}
		CHECK(hit_count > 0);
	}
}

TEST_CASE("triangle parts: the most level of equally high parts determines the normal, in any order") {
	const auto level = part_of({{0.0, 1.0, 0.0}, {4.0, 1.0, 0.0}, {2.0, 1.0, 4.0}});
	const auto rising = part_of({{0.0, 1.0, 0.0}, {4.0, 1.0, 0.0}, {2.0, 5.0, -4.0}});
	// Two equally steep triangles that form a ridge along z.
	const auto west = part_of({{-10.0, 0.0, -5.0}, {-10.0, 0.0, 5.0}, {-8.0, 2.0, 0.0}});
	const auto east = part_of({{-6.0, 0.0, -5.0}, {-6.0, 0.0, 5.0}, {-8.0, 2.0, 0.0}});
	for (const auto &parts : {std::vector{level, rising, west, east}, std::vector{east, west, rising, level}}) {
		const TriangleParts terrain = terrain_of(parts);
		CHECK(terrain.at({2.0, 0.0}).normal == glm::vec3(0.0f, 1.0f, 0.0f));
		CHECK(terrain.at({2.0, 0.0}).height == 1.0f);
		CHECK(terrain.at({-8.0, 0.0}).height == 2.0f);
		CHECK(terrain.at({-8.0, 0.0}).normal.x > 0.7f);
	}
}

TEST_CASE("triangle parts: missing, empty and upright parts are not ground, and spans of wrong sizes are rejected") {
	CHECK(std::isnan(TriangleParts().at({0.0, 0.0}).height));
	const auto wall = part_of({{0.0, 0.0, 0.0}, {0.0, 9.0, 0.0}, {0.0, 0.0, 4.0}});
	const auto floor = part_of({{-5.0, 1.0, -5.0}, {5.0, 1.0, -5.0}, {0.0, 1.0, 5.0}});
	CHECK(std::isnan(terrain_of({wall, part_of({})}).at({0.0, 1.0}).height));
	const TriangleParts terrain = terrain_of({wall, part_of({}), floor});
	CHECK(terrain.at({0.0, 1.0}).height == 1.0f);
	CHECK(std::isnan(terrain.at({nan_value, 0.0}).height));
	const std::vector<glm::dvec2> positions(2);
	std::vector<Ground> ground(3);
	check_refused(terrain.sample(positions, ground), ErrorCode::wrong_size, "ground", 3.0);
}
