// Tests queries, NearQueue and overlays on a planet, whose tiles are cubes.

#include "core/base/planet.hpp"
#include "core/near/near_queue.hpp"
#include "core/near/tile_overlay.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/query/instance_world.hpp"
#include "core/query/query_requests.hpp"
#include "core/sampling/point_set.hpp"
#include "core/terrain/triangle_parts.hpp"
#include "surface_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <vector>

using namespace thicket;

namespace {

constexpr double planet_radius = 60.0;
constexpr double tile_size = 16.0;

/// A planet whose tiles are generated when a query needs them.
struct PlanetWorld {
	LayerSettings settings;
	TriangleParts ground;
	InstanceWorld world;
	InstanceState state;
	std::size_t generated_tiles = 0; ///< Number of generated tiles.

	PlanetWorld() {
		const surfaces::Triangles triangles = surfaces::sphere(planet_radius, 64);
		std::vector<glm::dvec3> corners;
		for (const std::uint32_t index : triangles.indices) {
			corners.push_back(triangles.vertices[index]);
		}
		auto terrain_part = std::make_shared<TriangleTerrain>();
		REQUIRE(terrain_part->set(corners, nullptr, Winding::counterclockwise).ok());
		REQUIRE(ground.set(std::vector<TriangleParts::Part>{terrain_part}).ok());
		settings.set = {.seed = 5, .radius = 2.0, .levels = 1, .layer = 4, .on_surface = true};
		settings.rules.max_slope_degrees = 180.0;
		settings.planet = {{0.0, 0.0, 0.0}, planet_radius};
		QueryLayer layer;
		layer.set = settings.set;
		layer.tile_size = tile_size;
		layer.bottom = settings.planet.bottom();
		layer.top = settings.planet.top();
		world.set_layers({layer});
		world.set_state(&state);
		world.set_maker([this](std::span<const WorldTile> tiles, auto &r_tiles) {
			r_tiles.clear();
			for (const WorldTile &tile : tiles) {
				r_tiles.push_back(make(tile));
			}
			return Status();
		});
	}

	std::shared_ptr<const CompactTile> make(const WorldTile &tile) {
		TileInstances instances;
		TileBuilder builder;
		++generated_tiles;
		REQUIRE(tile.slab != all_slabs);
		REQUIRE(builder.build(settings, ground, tile_space(tile_size, tile.tile, tile.slab), instances).ok());
		return std::make_shared<const CompactTile>(instances, std::make_shared<LayerSettings>(settings));
	}

	std::vector<PlacedInstance> all() {
		std::vector<PlacedInstance> results;
		REQUIRE(world.answer([&](const InstanceQuery &query) {
						 return query.in_rect(Rect{{-70.0, -70.0}, {70.0, 70.0}}, {}, results);
					 }).ok());
		return results;
	}
};

std::vector<glm::dvec3> positions() {
	std::vector<glm::dvec3> result;
	for (const glm::dvec3 direction : {glm::dvec3(0, 1, 0), glm::dvec3(1, 1, 0.2), glm::dvec3(1, 0, 0),
				 glm::dvec3(0.1, 0, -1), glm::dvec3(-1, -1, 1), glm::dvec3(0, -1, 0)}) {
		result.push_back(planet_radius * glm::normalize(direction));
	}
	return result;
}

} // namespace

TEST_CASE("planet queries: spheres, rectangles, the nearest instance and IDs, from pole to pole") {
	PlanetWorld planet;
	const std::vector<PlacedInstance> all = planet.all();
	CHECK(all.size() > 7000);
	for (const glm::dvec3 &position : positions()) {
		PlanetWorld fresh_world;
		std::vector<PlacedInstance> results;
		REQUIRE(fresh_world.world
						.answer([&](const InstanceQuery &query) {
							return query.in_sphere(position, 12.0, {}, results);
						})
						.ok());
		std::set<std::uint64_t> expected;
		const PlacedInstance *nearest = nullptr;
		for (const PlacedInstance &each : all) {
			const double query_distance = glm::distance(each.position, position);
			if (query_distance <= 12.0) {
				expected.insert(each.id);
			}
			nearest =
					nearest == nullptr || query_distance < glm::distance(nearest->position, position) ? &each : nearest;
		}
		CHECK(results.size() > 50);
		CHECK(results.size() == expected.size());
		for (const PlacedInstance &each : results) {
			CHECK(expected.contains(each.id));
		}
		CHECK(fresh_world.generated_tiles < 40); // No tiles on the far side or high above the ground are generated.
		std::vector<NearestInstance> first;
		REQUIRE(fresh_world.world
						.answer([&](const InstanceQuery &query) { return query.nearest(position, 12.0, {}, first); })
						.ok());
		REQUIRE(first.size() == 1);
		CHECK(first[0].instance.id == nearest->id);
		std::vector<PlacedInstance> repeated;
		REQUIRE(fresh_world.world.answer([&](const InstanceQuery &query) { return query.by_id(nearest->id, repeated); })
						.ok());
		REQUIRE(repeated.size() == 1);
		CHECK(glm::distance(repeated[0].position, nearest->position) < 1e-4);
		fresh_world.state.remove(nearest->id);
		REQUIRE(fresh_world.world
						.answer([&](const InstanceQuery &query) { return query.nearest(position, 12.0, {}, first); })
						.ok());
		CHECK(first[0].instance.id != nearest->id);
	}
}

TEST_CASE("planet queries: an instance is within the height range of the cell that its ID encodes") {
	PlanetWorld planet;
	for (const PlacedInstance &each : planet.all()) {
		const CellHeights heights = cell_heights(planet.settings.set, each.id);
		CHECK(heights.bottom <= each.position.y);
		CHECK(heights.top >= each.position.y);
		CHECK(heights.top - heights.bottom < 1.2);
	}
}

TEST_CASE("planet queries: rays hit instances on planets") {
	PlanetWorld planet;
	const std::vector<PlacedInstance> all = planet.all();
	PlanetWorld fresh_world;
	for (std::size_t i = 0; i < all.size(); i += 211) {
		const glm::dvec3 up = glm::normalize(all[i].position);
		const glm::dvec3 from = all[i].position + 30.0 * up;
		std::vector<RayHit> hit;
		REQUIRE(fresh_world.world
						.answer([&](const InstanceQuery &query) {
							return query.on_ray(from, all[i].position, {}, hit);
						})
						.ok());
		REQUIRE(hit.size() == 1);
		CHECK(hit[0].distance <= 28.01);
		CHECK(hit[0].distance > 27.0);
	}
	// This ray passes through the whole planet.
	std::vector<RayHit> hit;
	const glm::dvec3 start = all.front().position + 2.5 * glm::normalize(all.front().position);
	REQUIRE(fresh_world.world
					.answer([&](const InstanceQuery &query) { return query.on_ray(start, -2.0 * start, {}, hit); })
					.ok());
	CHECK(hit.size() == 1);
}

TEST_CASE("planet queries: requests generate only the cubes that they need") {
	PlanetWorld planet;
	QueryRequests requests;
	std::int64_t index = 0;
	const glm::dvec3 position(0.0, -planet_radius, 0.0);
	REQUIRE(requests.add(planet.world, QueryRequests::Sphere{position, 8.0}, {}, index).ok());
	CHECK(requests.frame(planet.world).empty());
	const std::vector<WorldTile> missing = planet.world.take_missing();
	CHECK(missing.size() >= 4);
	CHECK(missing.size() < 30);
	for (const WorldTile &tile : missing) {
		planet.world.keep(tile, planet.make(tile));
	}
	const auto answers = requests.frame(planet.world);
	REQUIRE(answers.size() == 1);
	CHECK(answers[0].found.size() > 20);
}

TEST_CASE("planet queries: bodies appear around a walker at the equator and at the south pole") {
	const std::vector<PlacedInstance> all = PlanetWorld().all();
	for (const glm::dvec3 &position : positions()) {
		PlanetWorld planet;
		NearQueue queue;
		queue.set_distances(std::vector<double>{10.0});
		std::set<std::uint64_t> held_ids;
		const std::vector<glm::dvec3> centers{position};
		for (int frame = 0; frame < 60; ++frame) {
			queue.find_changes(centers, planet.world);
			PlacedInstance entering;
			while (queue.next_entering(entering)) {
				CHECK(held_ids.insert(entering.id).second);
				CHECK(glm::distance(entering.position, position) <= 10.0 * NearQueue::enter_factor);
			}
			for (const WorldTile &tile : planet.world.take_missing()) {
				planet.world.keep(tile, planet.make(tile));
			}
		}
		CHECK(planet.generated_tiles < 60);
		std::size_t expected = 0;
		for (const PlacedInstance &each : all) {
			expected += glm::distance(each.position, position) <= 10.0 ? 1 : 0;
			CHECK((glm::distance(each.position, position) > 10.0 || held_ids.contains(each.id)));
		}
		CHECK(expected > 30);
	}
}

TEST_CASE("planet queries: a hand-placed instance is drawn by the cube that contains it") {
	PlanetWorld planet;
	std::uint64_t id = 0;
	REQUIRE(planet.state.add({.layer = 4, .position = {2.0, -planet_radius, 3.0}}, id).ok());
	for (const int slab : {-4, 3}) {
		const auto tile = planet.make({0, {0, 0}, slab});
		OverlaidMeshes meshes;
		REQUIRE(overlaid(tile, planet.settings, tile_space(tile_size, {0, 0}, slab), {&planet.state, nullptr}, meshes)
						.ok());
		REQUIRE(meshes.size() == 1);
		CHECK(meshes[0]->size() == tile->meshes[0].size() + (slab == -4 ? 1 : 0));
	}
}
