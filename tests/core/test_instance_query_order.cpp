// Tests instances on a border, the tiles that a query reads, and the order in which it calls its
// filter.

#include "core/query/instance_query.hpp"

#include "query_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

using namespace thicket;
using namespace thicket::test;

TEST_CASE("queries: rectangles are half-open, so adjacent pieces return each instance of the whole once") {
	World world;
	const std::vector<QueryLayer> layers = world.query_layers();
	const InstanceQuery query{layers, world, nullptr};
	const auto whole_glade = found_in(query, glade);
	REQUIRE(whole_glade.size() > 500);
	for (std::size_t i = 0; i < whole_glade.size(); i += 41) {
		// Divide the rectangle at the position of an instance.
		const glm::dvec2 cut(whole_glade[i].position.x, whole_glade[i].position.z);
		std::vector<PlacedInstance> pieced;
		for (const Rect &rect :
				{Rect{glade.min, cut}, Rect{cut, glade.max}, Rect{{cut.x, glade.min.y}, {glade.max.x, cut.y}},
						Rect{{glade.min.x, cut.y}, {cut.x, glade.max.y}}}) {
			const auto results = found_in(query, rect);
			pieced.insert(pieced.end(), results.begin(), results.end());
		}
		std::sort(pieced.begin(), pieced.end(), [](const PlacedInstance &a, const PlacedInstance &b) {
			return std::tie(a.layer, a.id) < std::tie(b.layer, b.id);
		});
		CHECK(same(pieced, whole_glade));
		const auto alone = found_in(query, {cut, {std::nextafter(cut.x, 1e9), std::nextafter(cut.y, 1e9)}});
		REQUIRE(alone.size() == 1);
		CHECK(same(alone[0], whole_glade[i]));
	}
	CHECK(found_in(query, {{5.0, 5.0}, {5.0, 60.0}}).empty());
}

TEST_CASE("queries: a sphere is closed, and so is the distance to the nearest") {
	World world;
	const std::vector<QueryLayer> layers = world.query_layers();
	InstanceState state;
	std::uint64_t id = 0;
	REQUIRE(state.add({.layer = 3, .position = {1000.0, 500.0, -2000.0}}, id).ok());
	const InstanceQuery query{layers, world, &state};
	for (const glm::dvec3 offset : {glm::dvec3(8.0, 0.0, 0.0), glm::dvec3(0.0, 0.0, -8.0), glm::dvec3(0.0, 8.0, 0.0)}) {
		std::vector<PlacedInstance> results;
		std::vector<NearestInstance> nearest;
		const glm::dvec3 center = glm::dvec3(1000.0, 500.0, -2000.0) + offset;
		REQUIRE(query.in_sphere(center, 8.0, {}, results).ok());
		CHECK(results.size() == 1);
		REQUIRE(query.nearest(center, 8.0, {}, nearest).ok());
		CHECK(nearest.size() == 1);
		REQUIRE(query.in_sphere(center, 7.999999, {}, results).ok());
		CHECK(results.empty());
		REQUIRE(query.nearest(center, 7.999999, {}, nearest).ok());
		CHECK(nearest.empty());
	}
}

TEST_CASE("queries: the filter is called last, in order, and no more often than needed") {
	World world;
	const std::vector<QueryLayer> layers = world.query_layers();
	const auto all = everything_in(world, {{-64.0, -64.0}, {128.0, 128.0}});
	InstanceState state;
	for (std::size_t i = 0; i < all.size(); i += 3) {
		state.remove(all[i].id);
	}
	std::uint64_t id = 0;
	REQUIRE(state.add({.layer = 3, .position = {30.0, 0.0, 30.0}}, id).ok());
	const InstanceQuery query{layers, world, &state};
	std::vector<PlacedInstance> tested;
	QueryFilter filter;
	filter.accepts = [&](const PlacedInstance &each) {
		tested.push_back(each);
		return tested.size() % 2 == 0;
	};
	const auto expected = found_in(query, glade);
	std::vector<PlacedInstance> results;
	REQUIRE(query.in_rect(glade, filter, results).ok());
	CHECK(same(tested, expected));
	CHECK(results.size() == expected.size() / 2);

	tested.clear();
	const glm::dvec3 position(31.0, 3.0, 33.0);
	filter.accepts = [&](const PlacedInstance &each) {
		tested.push_back(each);
		return tested.size() == 25;
	};
	std::vector<NearestInstance> nearest;
	REQUIRE(query.nearest(position, 60.0, filter, nearest).ok());
	auto by_distance = expected;
	const auto distance = [position](const PlacedInstance &each) {
		return glm::length(each.position - position);
	};
	std::sort(by_distance.begin(), by_distance.end(),
			[&](const PlacedInstance &a, const PlacedInstance &b) { return distance(a) < distance(b); });
	by_distance.resize(25);
	CHECK(same(tested, by_distance));
	REQUIRE(nearest.size() == 1);
	CHECK(same(nearest[0].instance, by_distance.back()));

	// Instances that the filter itself removes are missing from the next query, but not from this
	// one.
	filter.accepts = [&](const PlacedInstance &each) {
		return state.remove(each.id);
	};
	REQUIRE(query.in_rect(glade, filter, results).ok());
	CHECK(same(results, expected));
	CHECK(found_in(query, glade).empty());
}

TEST_CASE("queries: at equal distances, the smaller layer and ID win") {
	World world;
	const std::vector<QueryLayer> layers = world.query_layers();
	InstanceState state;
	std::vector<std::uint64_t> ids(4);
	for (std::size_t i = 0; i < ids.size(); ++i) {
		const std::uint16_t layer = i == 0 ? max_state_layer : std::uint16_t{3};
		const double x = i % 2 == 0 ? -5.0 : 5.0;
		REQUIRE(state.add({.layer = layer, .mesh = static_cast<std::uint8_t>(i), .position = {x, 900.0, 0.0}}, ids[i])
						.ok());
	}
	const InstanceQuery query{layers, world, &state};
	const std::uint64_t smallest = *std::min_element(ids.begin() + 1, ids.end());
	std::vector<NearestInstance> nearest;
	REQUIRE(query.nearest({0.0, 900.0, 0.0}, 10.0, {}, nearest).ok());
	REQUIRE(nearest.size() == 1);
	CHECK(nearest[0].instance.id == smallest);
	CHECK(nearest[0].distance == 5.0);
	std::vector<RayHit> hit;
	// The ray runs down the common axis of a tree and a stone.
	REQUIRE(query.on_ray({-5.0, 901.0, 0.0}, {-5.0, 800.0, 0.0}, {}, hit).ok());
	REQUIRE(hit.size() == 1);
	CHECK(hit[0].instance.id == ids[2]);
	CHECK(hit[0].distance == 0.0);
}

TEST_CASE("queries: the tiles that a query lists are those that it reads, the nearest first") {
	World world;
	const std::vector<QueryLayer> layers = world.query_layers();
	const InstanceQuery query{layers, world, nullptr};
	for (const bool is_sphere : {false, true}) {
		const glm::dvec3 center(glade.center().x, 0.0, glade.center().y);
		std::vector<InstanceQuery::Tile> tiles;
		std::vector<PlacedInstance> results;
		world.requests.clear();
		REQUIRE((is_sphere ? query.tiles_in_sphere(center, 35.0, {}, tiles) : query.tiles_in_rect(glade, {}, tiles))
						.ok());
		CHECK(world.requests.empty());
		REQUIRE((is_sphere ? query.in_sphere(center, 35.0, {}, results) : query.in_rect(glade, {}, results)).ok());
		REQUIRE(tiles.size() == world.requests.size());
		for (std::size_t i = 0; i < tiles.size(); ++i) {
			CHECK(std::tuple(tiles[i].layer, tiles[i].tile.x, tiles[i].tile.y) == world.requests[i]);
			const auto is_far = [&](const InstanceQuery::Tile &tile) {
				return distance_squared(tile_rect(layers[tile.layer].tile_size, tile.tile), glade.center());
			};
			if (i > 0 && tiles[i - 1].layer == tiles[i].layer) {
				// The query sorts tiles by their enlarged rectangles, so the order may differ by up
				// to 4 m.
				CHECK(std::sqrt(is_far(tiles[i - 1])) <= std::sqrt(is_far(tiles[i])) + 4.0);
			}
		}
		CHECK(std::set(world.requests.begin(), world.requests.end()).size() == tiles.size());
	}
}
