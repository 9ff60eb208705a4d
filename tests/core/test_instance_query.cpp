#include "core/query/instance_query.hpp"

#include "query_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <random>
#include <set>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Two sources of the same world. `warm` has cached all tiles around a position; `cold` generates
/// each tile on request.
struct Worlds {
	World warm;
	World cold;
	std::vector<PlacedInstance> all;
	InstanceState state;

	Worlds(glm::dvec2 position, std::mt19937 &random) {
		const Rect area{position - 220.0, position + 220.0};
		state = changed_state(everything_in(warm, area), position, random);
		all = everything_in(warm, area, &state);
		REQUIRE(all.size() > 5000);
	}

	/// Calls `answer(query)` with both sources, then clears the tiles that `cold` has generated.
	template <class Answer>
	void each(const Answer &answer) {
		const std::vector<QueryLayer> layers = warm.query_layers();
		answer(InstanceQuery{layers, warm, &state});
		answer(InstanceQuery{layers, cold, &state});
		cold.forget();
	}
};

/// Returns a filter with a random selection of layers. An empty selection means all layers.
QueryFilter random_filter(std::mt19937 &random) {
	QueryFilter filter;
	const auto choice = random() % 6;
	if (choice == 1) {
		filter.layers = {1};
	} else if (choice == 2) {
		filter.layers = {2, 0, 2};
	} else if (choice == 3) {
		filter.layers = {3, 1};
	}
	return filter;
}

bool has_layer(const QueryFilter &filter, std::uint32_t layer) {
	return filter.layers.empty() || std::find(filter.layers.begin(), filter.layers.end(), layer) != filter.layers.end();
}

} // namespace

TEST_CASE("queries: a rectangle returns the same as a scan of all tiles, with a warm and a cold source") {
	std::mt19937 random(1);
	for (const glm::dvec2 position : world_centers) {
		Worlds worlds(position, random);
		for (int repeat = 0; repeat < 30; ++repeat) {
			const glm::dvec2 corner = position + glm::dvec2(between(random, -90.0, 60.0), between(random, -90.0, 60.0));
			Rect rect{corner, corner + glm::dvec2(between(random, 0.0, 40.0), between(random, 0.0, 40.0))};
			if (repeat % 3 == 0) {
				// The edges of the rectangle are borders of the trees' tiles.
				rect = tile_rect(64.0, tile_at(64.0, corner));
			}
			const QueryFilter filter = random_filter(random);
			const auto expected = matching(worlds.all, [&](const PlacedInstance &each) {
				return has_layer(filter, each.layer) && rect.contains({each.position.x, each.position.z});
			});
			worlds.each([&](const InstanceQuery &query) {
				std::vector<PlacedInstance> found(3);
				REQUIRE(query.in_rect(rect, filter, found).ok());
				CHECK(same(found, expected));
			});
		}
	}
}

TEST_CASE("queries: a sphere returns the same as a scan, in three dimensions") {
	std::mt19937 random(2);
	for (const glm::dvec2 position : world_centers) {
		Worlds worlds(position, random);
		std::size_t total = 0;
		for (int repeat = 0; repeat < 30; ++repeat) {
			const glm::dvec3 center(position.x + between(random, -80.0, 80.0), between(random, -20.0, 20.0),
					position.y + between(random, -80.0, 80.0));
			const double radius = repeat == 0 ? 0.0 : between(random, 0.1, 45.0);
			const QueryFilter filter = random_filter(random);
			const auto expected = matching(worlds.all, [&](const PlacedInstance &each) {
				const glm::dvec3 offset = each.position - center;
				return has_layer(filter, each.layer) && glm::dot(offset, offset) <= radius * radius;
			});
			total += expected.size();
			worlds.each([&](const InstanceQuery &query) {
				std::vector<PlacedInstance> results;
				REQUIRE(query.in_sphere(center, radius, filter, results).ok());
				CHECK(same(results, expected));
			});
		}
		CHECK(total > 5000);
		// A sphere of radius 0 at the exact position of an instance.
		worlds.each([&](const InstanceQuery &query) {
			std::vector<PlacedInstance> results;
			REQUIRE(query.in_sphere(worlds.all[2000].position, 0.0, {}, results).ok());
			REQUIRE(results.size() == 1);
			CHECK(same(results[0], worlds.all[2000]));
		});
	}
}

TEST_CASE("queries: the nearest instance is the one that a scan of all instances finds") {
	std::mt19937 random(3);
	for (const glm::dvec2 position : world_centers) {
		Worlds worlds(position, random);
		int empty_count = 0;
		for (int repeat = 0; repeat < 60; ++repeat) {
			const glm::dvec3 from(position.x + between(random, -60.0, 60.0), between(random, -20.0, 30.0),
					position.y + between(random, -60.0, 60.0));
			const double max_distance = std::exp(between(random, 0.0, 5.0));
			QueryFilter filter = random_filter(random);
			const bool picky = repeat % 2 == 0;
			if (picky) {
				filter.accepts = [](const PlacedInstance &each) {
					return each.id % 7 == 3;
				};
			}
			const PlacedInstance *nearest = nullptr;
			double distance = max_distance;
			for (const PlacedInstance &each : worlds.all) {
				const double end_distance = glm::length(each.position - from);
				if (has_layer(filter, each.layer) && (!picky || each.id % 7 == 3) &&
						(nearest == nullptr ? end_distance <= distance : end_distance < distance)) {
					nearest = &each;
					distance = end_distance;
				}
			}
			empty_count += nearest == nullptr;
			worlds.each([&](const InstanceQuery &query) {
				std::vector<NearestInstance> found(2);
				REQUIRE(query.nearest(from, max_distance, filter, found).ok());
				REQUIRE(found.size() == (nearest != nullptr ? 1 : 0));
				if (nearest != nullptr) {
					CHECK(same(found[0].instance, *nearest));
					CHECK(found[0].distance == doctest::Approx(distance).epsilon(1e-12));
				}
			});
		}
		CHECK(empty_count > 2);
		CHECK(empty_count < 40);
	}
}

TEST_CASE("queries: an ID finds its instance, or nothing if there is none") {
	std::mt19937 random(4);
	for (const glm::dvec2 position : world_centers) {
		Worlds worlds(position, random);
		for (std::size_t i = 0; i < worlds.all.size(); i += worlds.all.size() / 60) {
			worlds.each([&](const InstanceQuery &query) {
				std::vector<PlacedInstance> results(2);
				REQUIRE(query.by_id(worlds.all[i].id, results).ok());
				REQUIRE(results.size() == 1);
				CHECK(same(results[0], worlds.all[i]));
			});
			CHECK(worlds.cold.requests.size() <= 4);
			worlds.cold.requests.clear();
		}
		for (const std::uint64_t id : worlds.state.added_ids()) {
			worlds.each([&](const InstanceQuery &query) {
				std::vector<PlacedInstance> results;
				REQUIRE(query.by_id(id, results).ok());
				REQUIRE(results.size() == 1);
				CHECK(results[0].position == worlds.state.added(id)->position);
			});
		}
		std::set<std::uint64_t> standing_ids;
		for (const PlacedInstance &each : worlds.all) {
			standing_ids.insert(each.id);
		}
		// The IDs of adjacent cells, many of which have no instance.
		int empty = 0;
		for (std::size_t i = 0; i < worlds.all.size(); i += worlds.all.size() / 80) {
			const glm::dvec2 offset = glm::dvec2(worlds.all[i].position.x, worlds.all[i].position.z) - position;
			if (glm::length(offset) > 150.0) {
				continue; // The adjacent cell may be outside the scanned area.
			}
			const std::uint64_t id = worlds.all[i].id + 1;
			std::vector<PlacedInstance> results;
			worlds.each([&](const InstanceQuery &query) {
				REQUIRE(query.by_id(id, results).ok());
				CHECK(results.size() == standing_ids.count(id));
			});
			empty += results.empty();
		}
		CHECK(empty > 5);
	}
}

TEST_CASE("queries: a removed instance still has a position according to its layer's rules and returns to it") {
	World world;
	const std::vector<QueryLayer> layers = world.query_layers();
	const auto all = everything_in(world, {{0.0, 0.0}, {50.0, 50.0}});
	InstanceState state;
	const InstanceQuery query{layers, world, &state};
	for (std::size_t i = 0; i < all.size(); i += 37) {
		std::vector<PlacedInstance> results;
		const std::uint64_t id = all[i].id;
		CHECK(state.remove(id));
		REQUIRE(query.by_id(id, results).ok());
		CHECK(results.empty());
		REQUIRE(query.by_id_even_removed(id, results).ok());
		REQUIRE(results.size() == 1);
		CHECK(same(results[0], all[i]));
		CHECK(state.restore(id));
		REQUIRE(query.by_id(id, results).ok());
		CHECK(results.size() == 1);
	}
	std::uint64_t id = 0;
	REQUIRE(state.add({.layer = 7, .position = {1.0, 2.0, 3.0}}, id).ok());
	CHECK(state.remove(id));
	std::vector<PlacedInstance> results(1);
	REQUIRE(query.by_id_even_removed(id, results).ok());
	CHECK(results.empty());
}

TEST_CASE("queries: IDs of other layers, of missing layers and of empty layers find nothing") {
	World world;
	const std::vector<QueryLayer> layers = world.query_layers();
	const InstanceQuery query{layers, world, nullptr};
	for (const std::uint64_t id : {std::uint64_t{0}, std::uint64_t{1} << 48, ~std::uint64_t{0}, std::uint64_t{1} << 63,
				 std::uint64_t{7} << 48, (std::uint64_t{8} << 48) - 1}) {
		std::vector<PlacedInstance> results(1);
		REQUIRE(query.by_id(id, results).ok());
		CHECK(results.empty());
	}
	world.layers[0].query_layer.wanted = false;
	const std::vector<QueryLayer> unwanted = world.query_layers();
	const auto tree = everything_in(world, {{0.0, 0.0}, {9.0, 9.0}});
	std::vector<PlacedInstance> results;
	REQUIRE(InstanceQuery{unwanted, world, nullptr}.in_rect({{0.0, 0.0}, {9.0, 9.0}}, {{0, 3}, {}}, results).ok());
	CHECK(results.empty());
}

TEST_CASE("queries: a search by ID ends at the instance, and never starts for a removed one") {
	World world;
	const std::vector<QueryLayer> layers = world.query_layers();
	InstanceState state;
	const InstanceQuery query{layers, world, &state};
	std::size_t passed_over = 0; // Tiles that were read before the right one.
	for (const PlacedInstance &tree : everything_in(world, {{0.0, 0.0}, {200.0, 200.0}})) {
		if (tree.layer != 0) {
			continue;
		}
		std::vector<PlacedInstance> results;
		world.requests.clear();
		REQUIRE(query.by_id(tree.id, results).ok());
		REQUIRE(results.size() == 1);
		const auto [layer, x, y] = world.requests.back();
		CHECK(tile_rect(layers[0].tile_size, {x, y}).contains({tree.position.x, tree.position.z}));
		passed_over += world.requests.size() - 1;
		state.remove(tree.id);
		world.requests.clear();
		REQUIRE(query.by_id(tree.id, results).ok());
		CHECK(results.empty());
		CHECK(world.requests.empty());
	}
	CHECK(passed_over > 0);
}
