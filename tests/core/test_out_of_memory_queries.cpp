// Tests that queries return an error that names the invalid argument and no partial result,
// whichever allocation fails.

#include "query_fixture.hpp"
#include "short_of_memory.hpp"

#include <doctest/doctest.h>

#include <random>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// A world whose tiles have all been generated, and a state that changes it.
struct QueriedWorld {
	World world;
	std::vector<QueryLayer> layers = world.query_layers();
	InstanceState state;
	std::vector<PlacedInstance> all;

	QueriedWorld() {
		std::mt19937 random(3);
		all = everything_in(world, {{-40.0, -40.0}, {110.0, 110.0}});
		state = changed_state(all, {30.0, 30.0}, random);
		world.requests.reserve(1 << 16); // The list of requests must not allocate during a query.
	}

	InstanceQuery query() { return {layers, world, &state}; }
};

bool equal(const std::vector<PlacedInstance> &a, const std::vector<PlacedInstance> &b) { return same(a, b); }

bool equal(const std::vector<RayHit> &a, const std::vector<RayHit> &b) {
	return std::ranges::equal(a, b,
			[](const RayHit &x, const RayHit &y) { return same(x.instance, y.instance) && x.distance == y.distance; });
}

bool equal(const std::vector<NearestInstance> &a, const std::vector<NearestInstance> &b) {
	return std::ranges::equal(a, b, [](const NearestInstance &x, const NearestInstance &y) {
		return same(x.instance, y.instance) && x.distance == y.distance;
	});
}

bool equal(const std::vector<InstanceQuery::Tile> &a, const std::vector<InstanceQuery::Tile> &b) {
	return std::ranges::equal(a, b, [](const InstanceQuery::Tile &x, const InstanceQuery::Tile &y) {
		return x.layer == y.layer && x.tile == y.tile;
	});
}

/// Repeats a query while each of its allocations fails in turn. `query(answer)` returns a Status.
template <typename Answer, typename Query>
void fail_query(QueriedWorld &r_queried, const char *property, const Query &query) {
	Answer expected;
	REQUIRE(query(expected).ok());
	REQUIRE(!expected.empty());
	fail_every_request(
			property,
			[&] {
				r_queried.world.requests.clear();
				return Answer(3);
			},
			[&](Answer &answer) { return query(answer); }, [](const Answer &answer) { REQUIRE(answer.empty()); },
			[&](const Answer &answer) { REQUIRE(equal(answer, expected)); });
}

} // namespace

TEST_CASE("out of memory: a query of any kind returns an error and no result, and works the next time") {
	QueriedWorld queried;
	const InstanceQuery query = queried.query();
	QueryFilter all;
	QueryFilter layer_filter;
	layer_filter.layers = {0, 2};
	layer_filter.accepts = [](const PlacedInstance &instance) {
		return instance.id % 3 != 0;
	};
	for (const QueryFilter &filter : {all, layer_filter}) {
		fail_query<std::vector<PlacedInstance>>(
				queried, "rect", [&](auto &found) { return query.in_rect(glade, filter, found); });
		fail_query<std::vector<PlacedInstance>>(queried, "radius",
				[&](auto &found) { return query.in_sphere({30.0, 0.0, 30.0}, 30.0, filter, found); });
		fail_query<std::vector<NearestInstance>>(queried, "max_distance",
				[&](auto &found) { return query.nearest({30.0, 0.0, 30.0}, 30.0, filter, found); });
		std::vector<NearestInstance> nearest;
		REQUIRE(query.nearest({30.0, 0.0, 30.0}, 30.0, filter, nearest).ok());
		const glm::dvec3 aim = nearest.at(0).instance.position;
		fail_query<std::vector<RayHit>>(queried, "to",
				[&](auto &hit) { return query.on_ray(aim + glm::dvec3(30.0, 9.0, 40.0), aim, filter, hit); });
		fail_query<std::vector<InstanceQuery::Tile>>(
				queried, "rect", [&](auto &tiles) { return query.tiles_in_rect(glade, filter, tiles); });
		fail_query<std::vector<InstanceQuery::Tile>>(queried, "radius",
				[&](auto &tiles) { return query.tiles_in_sphere({30.0, 0.0, 30.0}, 30.0, filter, tiles); });
	}
}

TEST_CASE("out of memory: a query by ID returns an error") {
	QueriedWorld queried;
	const InstanceQuery query = queried.query();
	for (const std::uint32_t layer : {0u, 1u, 2u}) { // For layer 2, the query samples the point set to find the tile.
		CAPTURE(layer);
		const auto found = std::ranges::find_if(queried.all, [&](const PlacedInstance &each) {
			return each.layer == layer && glade.contains({each.position.x, each.position.z}) &&
					!queried.state.removed(each.id);
		});
		REQUIRE(found != queried.all.end());
		Status sampled;
		std::vector<PlacedInstance> expected;
		REQUIRE(query.by_id(found->id, expected).ok());
		for (std::size_t allowed = 0;; ++allowed) {
			std::vector<PlacedInstance> answer;
			Status status;
			queried.world.requests.clear();
			bool reached = false;
			{
				const AllocationLimit limit(allowed);
				status = query.by_id(found->id, answer);
				reached = limit.reached();
			}
			if (!reached) {
				REQUIRE(status.ok());
				REQUIRE(equal(answer, expected));
				break;
			}
			REQUIRE(status.code == ErrorCode::out_of_memory);
			REQUIRE(answer.empty());
			REQUIRE(query.by_id(found->id, answer).ok());
			REQUIRE(equal(answer, expected));
		}
	}
}

TEST_CASE("out of memory: tiles that a query generates fail in the same way") {
	QueriedWorld queried;
	const InstanceQuery query = queried.query();
	std::vector<PlacedInstance> expected;
	REQUIRE(query.in_rect({{0.0, 0.0}, {20.0, 20.0}}, {.layers = {0}, .accepts = {}}, expected).ok());
	for (std::size_t allowed = 0, done = 0; done == 0; ++allowed) {
		queried.world.forget();
		queried.world.requests.clear();
		std::vector<PlacedInstance> found(3);
		Status status;
		const QueryFilter trees{.layers = {0}, .accepts = {}};
		{
			const AllocationLimit limit(allowed);
			status = query.in_rect({{0.0, 0.0}, {20.0, 20.0}}, trees, found);
			done = limit.reached() ? 0 : 1;
		}
		if (!status.ok()) {
			REQUIRE(status.code == ErrorCode::out_of_memory);
			REQUIRE(found.empty());
			REQUIRE(query.in_rect({{0.0, 0.0}, {20.0, 20.0}}, trees, found).ok());
		}
		REQUIRE(equal(found, expected));
	}
}
