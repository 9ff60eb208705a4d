#include "core/placement/tile_builder.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <map>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

TEST_CASE("tile: without rules, every point of the set is at its position, on the ground") {
	const Heightfield terrain = hills();
	LayerSettings layer;
	layer.set = {.seed = 5, .radius = 2.0, .levels = 1, .layer = 0};
	TileSampler sampler;
	std::vector<SamplePoint> points;
	for (const Rect &rect : {tile_of_hills, Rect{{-17.25, -93.5}, {41.0, -80.0}}, Rect{{0.0, 0.0}, {3.0, 2.0}}}) {
		REQUIRE(sampler.sample(layer.set, rect, points).ok());
		std::map<std::uint64_t, SamplePoint> by_id;
		for (const SamplePoint &point : points) {
			by_id.emplace(point.id, point);
		}
		const TileInstances tile = built(layer, terrain, rect);
		REQUIRE(tile.meshes.size() == 1);
		const MeshInstances &mesh = tile.meshes[0];
		CHECK(mesh.size() == points.size());
		CHECK(tile.counts.sampled == points.size());
		CHECK(tile.counts.dense == points.size());
		CHECK(tile.counts.placed == points.size());
		CHECK(mesh.buffer.size() == mesh.size() * transform_floats);
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			REQUIRE(by_id.contains(mesh.ids[i]));
			const SamplePoint &point = by_id[mesh.ids[i]];
			const glm::dvec3 position = world_position(tile, mesh, i);
			CHECK(mesh.ranks[i] == point.rank);
			CHECK(glm::distance(glm::dvec2(position.x, position.z), point.position) < 1e-5);
			CHECK(std::abs(position.y - terrain.at(point.position).height) < 1e-4);
		}
	}
}

TEST_CASE("tile: instances are sorted by rank and ID, and the box contains them") {
	const TileInstances tile = built(rich_layer(), hills(), tile_of_hills);
	CHECK(tile.meshes.size() == 3);
	CHECK(tile.counts.placed == size_of(tile));
	CHECK(tile.counts.placed > 500);
	CHECK(tile.counts.placed < tile.counts.dense);
	for (const MeshInstances &mesh : tile.meshes) {
		REQUIRE(mesh.size() > 10);
		glm::dvec3 lowest(1e9);
		glm::dvec3 highest(-1e9);
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			const glm::dvec3 local = world_position(tile, mesh, i) - tile.origin;
			lowest = glm::min(lowest, local);
			highest = glm::max(highest, local);
			if (i > 0) {
				CHECK(std::pair(mesh.ranks[i - 1], mesh.ids[i - 1]) < std::pair(mesh.ranks[i], mesh.ids[i]));
			}
		}
		CHECK(glm::distance(lowest, glm::dvec3(mesh.min)) < 1e-4);
		CHECK(glm::distance(highest, glm::dvec3(mesh.max)) < 1e-4);
		CHECK(mesh.max_scale <= 1.0f);
		CHECK(mesh.max_scale > 0.95f);
	}
	// The origin's height is near the ground, and a whole number of meters.
	CHECK(tile.origin.y == std::floor(tile.origin.y));
	CHECK(tile.origin.y > 0.0);
	CHECK(tile.origin.y < 90.0);
}

TEST_CASE("tile: rules are pure filters; the remaining instances are bit-identical") {
	const Heightfield terrain = hills();
	LayerSettings open = rich_layer();
	open.rules = {};
	const Transforms all = transforms_of(built(open, terrain, tile_of_hills));
	std::vector<Rules> tries(6, Rules{});
	tries[0].max_slope_degrees = 30.0;
	tries[1].min_slope_degrees = 30.0;
	tries[1].slope_falloff_degrees = 20.0;
	tries[2].density = 0.3;
	tries[3].min_height = 40.0;
	tries[4].max_height = 40.0;
	tries[4].height_falloff = 10.0;
	tries[5] = rich_layer().rules;
	for (const Rules &rules : tries) {
		LayerSettings filtered = open;
		filtered.rules = rules;
		check_filtered(all, transforms_of(built(filtered, terrain, tile_of_hills)));
	}
}

TEST_CASE("tile: all instances satisfy their rules") {
	const Heightfield terrain = hills();
	LayerSettings layer = rich_layer();
	layer.placement.height_offset = 0.0;
	const TileInstances tile = built(layer, terrain, tile_of_hills);
	TileSampler sampler;
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(layer.set, tile_of_hills, points).ok());
	const Transforms transforms = transforms_of(tile);
	for (const SamplePoint &point : points) {
		if (transforms.contains(point.id)) {
			const Ground ground = terrain.at(point.position);
			CHECK(ground.height >= 10.0f);
			CHECK(std::acos(double{ground.normal.y}) * 57.29577951308232 <= 50.0 + 1e-4);
		}
	}
}

TEST_CASE("tile: new meshes or a new scale move no instance") {
	const Heightfield terrain = hills();
	LayerSettings layer = rich_layer();
	const Transforms before = transforms_of(built(layer, terrain, tile_of_hills));
	layer.mesh_weights = {1.0f};
	CHECK(transforms_of(built(layer, terrain, tile_of_hills)) == before);
	layer.placement.max_scale = 4.0;
	for (const auto &[id, transform] : transforms_of(built(layer, terrain, tile_of_hills))) {
		REQUIRE(before.contains(id));
		for (const std::size_t at : {3u, 7u, 11u}) {
			CHECK(transform[at] == before.at(id)[at]);
		}
	}
}

TEST_CASE("tile: a tile is bit-identical when repeated, in pieces, after other work or on another thread") {
	const Heightfield terrain = hills();
	const LayerSettings layer = rich_layer();
	const TileInstances first = built(layer, terrain, tile_of_hills);

	TileBuilder used;
	TileInstances tile;
	LayerSettings other;
	other.set.radius = 0.7;
	REQUIRE(used.build(other, FlatTerrain(7.0f), {{5.0, 5.0}, {60.0, 20.0}}, tile).ok());
	REQUIRE(used.build(layer, terrain, tile_of_hills, tile).ok());
	CHECK(digest(tile) == digest(first));

	REQUIRE(used.find_points(layer, tile_of_hills).ok());
	std::vector<Ground> ground(used.positions().size());
	REQUIRE(terrain.sample(used.positions(), ground).ok());
	for (int repeat = 0; repeat < 2; ++repeat) {
		REQUIRE(used.place(ground, tile).ok());
		CHECK(digest(tile) == digest(first));
	}

	check_on_threads(layer, terrain, digest(first));

	LayerSettings reseeded = layer;
	++reseeded.set.seed;
	CHECK(digest(built(reseeded, terrain, tile_of_hills)) != digest(first));
}

TEST_CASE("tile: the two halves of a tile together have the same instances") {
	const Heightfield terrain = hills();
	const LayerSettings layer = rich_layer();
	const TileInstances whole_tile = built(layer, terrain, tile_of_hills);
	std::map<std::uint64_t, glm::dvec3> positions;
	for (const double split_x : {-10.0, 0.0, 33.3}) {
		std::size_t count = 0;
		for (const Rect &half : {Rect{tile_of_hills.min, {split_x, 128.0}}, Rect{{split_x, 0.0}, tile_of_hills.max}}) {
			const TileInstances half_tile = built(layer, terrain, half);
			count += size_of(half_tile);
			for (const MeshInstances &mesh : half_tile.meshes) {
				for (std::size_t i = 0; i < mesh.size(); ++i) {
					positions[mesh.ids[i]] = world_position(half_tile, mesh, i);
				}
			}
		}
		CHECK(count == size_of(whole_tile));
		for (std::size_t mesh = 0; mesh < whole_tile.meshes.size(); ++mesh) {
			for (std::size_t i = 0; i < whole_tile.meshes[mesh].size(); ++i) {
				const auto match = positions.find(whole_tile.meshes[mesh].ids[i]);
				REQUIRE(match != positions.end());
				CHECK(glm::distance(match->second, world_position(whole_tile, whole_tile.meshes[mesh], i)) < 2e-5);
			}
		}
	}
}

TEST_CASE("tile: 10,000 km out a tile is as exact as at the origin") {
	const glm::dvec2 corner(9.99e6 + 0.37, -9.99e6 + 0.81);
	LayerSettings layer;
	layer.set = {.seed = 8, .radius = 2.0, .levels = 1, .layer = 0};
	const Rect rect{corner, corner + 64.0};
	TileSampler sampler;
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(layer.set, rect, points).ok());
	const TileInstances tile = built(layer, FlatTerrain(1234.5f), rect);
	const MeshInstances &mesh = tile.meshes[0];
	REQUIRE(mesh.size() == points.size());
	REQUIRE(mesh.size() > 500);
	std::map<std::uint64_t, glm::dvec2> expected;
	for (const SamplePoint &point : points) {
		expected[point.id] = point.position;
	}
	std::vector<glm::vec2> local;
	for (std::size_t i = 0; i < mesh.size(); ++i) {
		const glm::dvec3 position = world_position(tile, mesh, i);
		CHECK(glm::distance(glm::dvec2(position.x, position.z), expected[mesh.ids[i]]) < 3e-6);
		CHECK(position.y == 1234.5);
		local.emplace_back(mesh.buffer[i * transform_floats + 3], mesh.buffer[i * transform_floats + 11]);
	}
	for (std::size_t i = 0; i < local.size(); ++i) {
		for (std::size_t j = 0; j < i; ++j) {
			REQUIRE(glm::distance(local[i], local[j]) > 2.0f - 1e-5f);
		}
	}
}
