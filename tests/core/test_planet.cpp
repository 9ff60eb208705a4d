// Tests layers on planets: up directions, slopes, altitudes and cubic tiles.

#include "core/base/planet.hpp"
#include "core/base/tile_grid.hpp"
#include "core/explain/position_explainer.hpp"
#include "core/placement/merged_mesh.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/placement/transform_batch.hpp"
#include "core/terrain/ground_shell.hpp"
#include "core/terrain/planet_ground.hpp"
#include "core/terrain/triangle_parts.hpp"
#include "counted_threads.hpp"
#include "placement_fixture.hpp"
#include "surface_fixture.hpp"
#include "tests/bench/common/simd_targets.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <string_view>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

constexpr glm::dvec3 center{3.0, -5.0, 8.0};

/// Returns the ground of spheres around `center`.
TriangleParts spheres(const std::vector<double> &radii) {
	std::vector<TriangleParts::Part> parts;
	for (const double radius : radii) {
		const surfaces::Triangles triangles = surfaces::sphere(radius, 40);
		std::vector<glm::dvec3> corners;
		for (const std::uint32_t index : triangles.indices) {
			corners.push_back(center + triangles.vertices[index]);
		}
		auto terrain_part = std::make_shared<TriangleTerrain>();
		REQUIRE(terrain_part->set(corners, nullptr, Winding::counterclockwise).ok());
		parts.push_back(terrain_part);
	}
	TriangleParts ground;
	REQUIRE(ground.set(parts).ok());
	return ground;
}

LayerSettings layer_on_planet(double radius, double planet_radius = 20.0) {
	LayerSettings layer;
	layer.set = {.seed = 3, .radius = radius, .levels = 1, .layer = 2, .on_surface = true};
	layer.rules.max_slope_degrees = 180.0;
	layer.planet = {center, planet_radius};
	return layer;
}

struct Placed {
	glm::dvec3 position;
	glm::dmat3 basis;
};

void add_placed(const LayerSettings &layer, const Terrain &ground, const TileSpace &space,
		std::map<std::uint64_t, Placed> &r_placed) {
	TileBuilder builder;
	TileInstances tile;
	REQUIRE(builder.build(layer, ground, space, tile).ok());
	const CompactTile compact(tile, std::make_shared<const LayerSettings>(layer));
	for (std::size_t at = 0; at < tile.meshes.size(); ++at) {
		const MeshInstances &mesh = tile.meshes[at];
		std::vector<float> floats(mesh.buffer.size());
		compact.meshes[at].read_all(floats);
		CHECK(std::equal(floats.begin(), floats.end(), mesh.buffer.begin()));
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			Placed placed{world_position(tile, mesh, i), {}};
			for (int row = 0; row < 3; ++row) {
				for (int column = 0; column < 3; ++column) {
					placed.basis[column][row] =
							double{mesh.buffer[i * mesh.stride + static_cast<std::size_t>(row * 4 + column)]};
				}
			}
			CHECK(r_placed.emplace(mesh.ids[i], placed).second);
		}
	}
}

constexpr Rect area{{-32.0, -32.0}, {48.0, 48.0}};

std::map<std::uint64_t, Placed> placed_in(const LayerSettings &layer, const Terrain &ground) {
	std::map<std::uint64_t, Placed> result;
	add_placed(layer, ground, area, result);
	return result;
}

/// Returns a layer that keeps a distance from a second layer.
LayerSettings layer_beside_trees() {
	LayerSettings layer = layer_on_planet(0.9);
	auto trees = std::make_shared<LayerSettings>(layer_on_planet(4.0));
	trees->set.layer = 9;
	layer.neighbors.push_back({.layer = trees, .distance = 1.5, .curve = nullptr});
	return layer;
}

} // namespace

TEST_CASE("planet: up is away from the center, and heights are altitudes") {
	const Planet planet{center, 20.0};
	CHECK(planet.up_at(center + glm::dvec3(0, 7, 0)) == glm::dvec3(0, 1, 0));
	CHECK(planet.up_at(center - glm::dvec3(0, 7, 0)) == glm::dvec3(0, -1, 0));
	CHECK(planet.up_at(center) == glm::dvec3(0, 1, 0));
	CHECK(planet.altitude(center + glm::dvec3(0, 0, -23)) == 3.0);
	const Ground east{static_cast<float>(center.y), {1, 0, 0}, 0.5f};
	const Ground expected = on_planet(planet, {center.x + 22.0, center.z}, east);
	CHECK(expected.height == 2.0f);
	CHECK(expected.normal == glm::vec3(0, 1, 0));
	CHECK(expected.weight == 0.5f);
	CHECK(on_planet(planet, {center.x - 22.0, center.z}, east).normal == glm::vec3(0, -1, 0));
	CHECK(on_planet(planet, {center.x, center.z + 22.0}, east).normal == glm::vec3(1, 0, 0));
	CHECK_FALSE(Planet().exists());
}

TEST_CASE("planet: only layers on surfaces can have a planet") {
	LayerSettings layer = layer_on_planet(1.0);
	CHECK(validate(layer).ok());
	layer.set.on_surface = false;
	CHECK(validate(layer).code == ErrorCode::missing);
	layer.planet.radius = 0.0;
	CHECK(validate(layer).ok());
	layer.planet.radius = std::nan("");
	CHECK_FALSE(validate(layer).ok());
	layer.planet = {{0.0, 0.0, 1e8}, 10.0};
	CHECK(std::string_view(validate(layer).property) == "planet_center.z");
}

TEST_CASE("planet: the box that a tile covers, and distances to it") {
	CHECK(tile_space(4.0, {1, -2}).covers_all_heights());
	const TileSpace space = tile_space(4.0, {1, -2}, -3);
	CHECK(space.bottom == -12.0);
	CHECK(space.top == -8.0);
	CHECK(space.min == glm::dvec2(4.0, -8.0));
	CHECK_FALSE(space.covers_all_heights());
	CHECK(space.contains_height(-12.0));
	CHECK_FALSE(space.contains_height(-8.0));
	CHECK(slab_at(4.0, -12.0) == -3);
	CHECK(slab_at(4.0, -12.1) == -4);
	CHECK(distance_squared(space, {6.0, -10.0, -6.0}) == 0.0);
	CHECK(distance_squared(space, {6.0, -5.0, -6.0}) == 9.0);
	CHECK(distance_squared(space, {3.0, -14.0, -10.0}) == 1.0 + 4.0 + 4.0);
	CHECK(distance_squared(tile_space(4.0, {1, -2}), {3.0, -1e9, -10.0}) == 5.0);
	CHECK(space.grown(1.0).bottom == -13.0);
	CHECK(space.grown(1.0).max == glm::dvec2(9.0, -3.0));
}

TEST_CASE("planet: upright instances point away from the center, everywhere") {
	const TriangleParts ground = spheres({20.0});
	LayerSettings layer = layer_on_planet(1.0);
	layer.placement.height_offset = 0.5;
	const auto placed = placed_in(layer, ground);
	CHECK(placed.size() > 3000);
	std::array<std::size_t, 8> octants{};
	for (const auto &[id, each] : placed) {
		const glm::dvec3 from = each.position - center;
		CHECK(glm::distance(each.basis[1], glm::normalize(from)) < 1e-6);
		CHECK(std::abs(glm::determinant(each.basis) - 1.0) < 1e-5);
		CHECK(glm::length(from) > 20.43);
		CHECK(glm::length(from) < 20.51);
		++octants[static_cast<std::size_t>((from.x > 0) + 2 * (from.y > 0) + 4 * (from.z > 0))];
	}
	for (const std::size_t count : octants) {
		CHECK(static_cast<double>(count) == doctest::Approx(static_cast<double>(placed.size()) / 8.0).epsilon(0.06));
	}
	layer.placement.align_to_normal = 1.0;
	layer.placement.height_offset = 0.0;
	layer.placement.offset_along_normal = -0.25;
	for (const auto &[id, each] : placed_in(layer, ground)) {
		CHECK(glm::dot(each.basis[1], glm::normalize(each.position - center)) > 0.996);
		CHECK(glm::distance(each.position, center) < 19.76);
	}
}

TEST_CASE("planet: slopes and heights are relative to the local up direction") {
	const TriangleParts ground = spheres({20.0, 24.0});
	const auto count = [&](double min_slope, double max_slope, double min_height, double max_height) {
		LayerSettings layer = layer_on_planet(1.0);
		layer.rules.min_slope_degrees = min_slope;
		layer.rules.max_slope_degrees = max_slope;
		layer.rules.min_height = min_height;
		layer.rules.max_height = max_height;
		return placed_in(layer, ground).size();
	};
	const std::size_t all = count(0.0, 180.0, -100.0, 100.0);
	CHECK(count(0.0, 6.0, -100.0, 100.0) == all);
	CHECK(count(6.0, 180.0, -100.0, 100.0) == 0);
	const std::size_t inner = count(0.0, 180.0, -1.0, 1.0);
	const std::size_t outer = count(0.0, 180.0, 3.0, 4.5);
	CHECK(inner + outer == all);
	CHECK(static_cast<double>(outer) / static_cast<double>(inner) == doctest::Approx(1.44).epsilon(0.05));
}

TEST_CASE("planet: cubes have the same instances as whole columns, also next to other layers") {
	const TriangleParts ground = spheres({20.0});
	LayerSettings layer = layer_beside_trees();
	layer.instance_data.color.kind = SourceKind::height;
	const auto all_placed = placed_in(layer, ground);
	CHECK(all_placed.size() > 2000);
	for (const double size : {16.0, 7.3}) {
		std::map<std::uint64_t, Placed> joined_parts;
		const glm::ivec2 first = tile_at(size, area.min);
		const glm::ivec2 last = tile_at(size, area.max);
		for (int z = first.y; z <= last.y; ++z) {
			for (int x = first.x; x <= last.x; ++x) {
				for (int slab = slab_at(size, center.y - 21.0); slab <= slab_at(size, center.y + 21.0); ++slab) {
					add_placed(layer, ground, tile_space(size, {x, z}, slab), joined_parts);
				}
			}
		}
		REQUIRE(joined_parts.size() == all_placed.size());
		for (const auto &[id, each] : all_placed) {
			REQUIRE(joined_parts.contains(id));
			CHECK(glm::distance(joined_parts.at(id).position, each.position) < 1e-5);
			CHECK(glm::distance(joined_parts.at(id).basis[0], each.basis[0]) < 1e-5);
		}
	}
}

TEST_CASE("planet: lent threads share a large cube, and the cubes of a column can be merged") {
	const TriangleParts ground = spheres({20.0});
	const LayerSettings layer = layer_on_planet(0.5);
	const TileSpace space(area, -30.0, 2.0);
	TileBuilder builder;
	TileInstances alone;
	TileInstances shared;
	CountedThreads threads(2);
	REQUIRE(builder.build(layer, ground, space, alone).ok());
	REQUIRE(builder.build(layer, ground, space, shared, nullptr, &threads).ok());
	CHECK(threads.runs > 0);
	CHECK(alone.origin == glm::dvec3(8.0, -14.0, 8.0));
	CHECK(digest(alone) == digest(shared));

	const auto settings = std::make_shared<const LayerSettings>(layer);
	TileInstances other;
	REQUIRE(builder.build(layer, ground, {area, 2.0, 30.0}, other).ok());
	TileInstances whole_tile;
	REQUIRE(builder.build(layer, ground, {area, -30.0, 30.0}, whole_tile).ok());
	const CompactTile low(alone, settings);
	const CompactTile high(other, settings);
	const std::array<TileMesh, 2> meshes{TileMesh{&low.meshes[0], low.origin}, TileMesh{&high.meshes[0], high.origin}};
	const CompactMesh merged_mesh = merged(meshes, whole_tile.origin);
	REQUIRE(merged_mesh.size() == whole_tile.meshes[0].size());
	CHECK(merged_mesh.size() > alone.meshes[0].size());
	for (std::size_t i = 0; i < merged_mesh.size(); ++i) {
		CHECK(merged_mesh.id(i) == whole_tile.meshes[0].ids[i]);
		CHECK(merged_mesh.ranks()[i] == whole_tile.meshes[0].ranks[i]);
		const float *floats = whole_tile.meshes[0].buffer.data() + i * transform_floats;
		CHECK(glm::distance(merged_mesh.positions()[i], glm::vec3(floats[3], floats[7], floats[11])) < 1e-4f);
	}
	CHECK(glm::distance(merged_mesh.min(), whole_tile.meshes[0].min) < 1e-4f);
	CHECK(glm::distance(merged_mesh.max(), whole_tile.meshes[0].max) < 1e-4f);
	CHECK(merged({}, {}).size() == 0);
}

TEST_CASE("planet: the neighbors of an explained position are sampled near it") {
	const TriangleParts ground = spheres({20.0});
	LayerSettings layer = layer_beside_trees();
	layer.rules.max_slope_degrees = 20.0;
	const auto placed = placed_in(layer, ground);
	PositionExplainer explainer;
	PositionExplanation explanation;
	std::size_t standing_count = 0;
	std::mt19937 random(4);
	std::uniform_real_distribution<double> along(-1.0, 1.0);
	for (int i = 0; i < 100; ++i) {
		const glm::dvec3 direction = glm::normalize(glm::dvec3(along(random), along(random), along(random)));
		REQUIRE(explainer.find(layer, center + 20.0 * direction, ground.surface()).ok());
		REQUIRE(explainer.explain({}, explanation).ok());
		CHECK(explanation.is_placed() == placed.contains(explanation.point.id));
		standing_count += explanation.is_placed() ? 1 : 0;
	}
	CHECK(standing_count > 30);
	CHECK(standing_count < 100);
}

TEST_CASE("planet: the shell of the ground contains all of it") {
	const surfaces::Triangles triangles = surfaces::sphere(20.0, 40);
	GroundShell shell;
	CHECK(shell.nearest > shell.farthest);
	for (std::size_t i = 0; i + 2 < triangles.indices.size(); i += 3) {
		shell.add(triangles.vertices[triangles.indices[i]], triangles.vertices[triangles.indices[i + 1]],
				triangles.vertices[triangles.indices[i + 2]]);
	}
	CHECK(shell.farthest == doctest::Approx(20.0));
	CHECK(shell.nearest > 19.9);
	CHECK(shell.nearest <= 20.0);
	GroundShell wall;
	wall.add({20.0, 0.0, 0.0}, {22.0, 0.0, 0.0}, {20.0, 1.0, 0.0}); // The triangle's plane contains the center.
	CHECK(wall.nearest == 20.0);
	CHECK(wall.farthest == 22.0);
	GroundShell flat;
	// The point nearest to the center is inside the triangle.
	flat.add({-50.0, 3.0, -50.0}, {50.0, 3.0, -50.0}, {0.0, 3.0, 80.0});
	CHECK(flat.nearest == doctest::Approx(3.0));
	CHECK(flat.widened().nearest == 0.0);
	CHECK(wall.widened().nearest == 16.0);
	CHECK(wall.widened().farthest == 32.0);
	wall.add(GroundShell::everywhere());
	CHECK(wall == GroundShell::everywhere());
}

TEST_CASE("planet: ground far above has no instances") {
	CHECK_FALSE(placed_in(layer_on_planet(1.0, 11.0), spheres({20.0})).empty());
	CHECK(placed_in(layer_on_planet(1.0, 5.0), spheres({20.0})).size() <
			placed_in(layer_on_planet(1.0, 11.0), spheres({20.0})).size());
}

TEST_CASE("planet: batches are bit-identical to single transforms, on every instruction set") {
	for (const bench::SimdTarget &target : bench::simd_targets()) {
		CAPTURE(target.name);
		const bench::ForcedTarget forced(target);
		std::mt19937 random(11);
		std::uniform_real_distribution<float> along(-30.0f, 30.0f);
		for (const double align : {0.0, 0.5, 1.0}) {
			Placement placement;
			placement.align_to_normal = align;
			for (const double tilt : {0.0, 20.0}) {
				placement.max_tilt_degrees = tilt;
				TransformBatch batch;
				const UpField up_field({{1.0, 2.0, 3.0}, 20.0}, {1.0, 2.0, 3.0});
				for (std::size_t i = 0; i < TransformBatch::capacity; ++i) {
					const glm::vec3 position = i == 0 ? glm::vec3(0.0f)
							: i < 3                   ? glm::vec3(0.0f, i == 1 ? 20.0f : -20.0f, 0.0f)
													  : glm::vec3(along(random), along(random), along(random));
					const glm::vec3 direction = glm::vec3(up_field.at(position));
					batch.add(i * 977, i % 5 == 0 ? -direction : random_normal(random), position);
				}
				batch.make(placement, seed, up_field);
				for (std::size_t i = 0; i < TransformBatch::capacity; ++i) {
					std::array<float, transform_floats> expected{};
					std::array<float, transform_floats> actual{};
					write_position(batch.position(i), expected);
					write_basis(placement, seed, batch.ids[i], batch.normal(i), expected, up_field);
					batch.write(i, actual);
					REQUIRE(std::memcmp(expected.data(), actual.data(), sizeof actual) == 0);
				}
			}
		}
	}
}
