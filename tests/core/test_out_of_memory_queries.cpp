// Whichever request for memory fails: an error that says what was asked for, and no half answer. Queries.

#include "query_fixture.hpp"
#include "short_of_memory.hpp"

#include <doctest/doctest.h>

#include <random>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// A world whose tiles are all made, and what a game changed in it.
struct Asked {
	World world;
	std::vector<QueryLayer> layers = world.asked();
	InstanceState state;
	std::vector<PlacedInstance> all;

	Asked() {
		std::mt19937 random(3);
		all = everything_in(world, {{-40.0, -40.0}, {110.0, 110.0}});
		state = changed_state(all, {30.0, 30.0}, random);
		world.asked_for.reserve(1 << 16); // A test's own list asks for no memory while a query runs.
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

/// Asks in little memory; `ask(answer)` gives a Status.
template <typename Answer, typename Ask>
void fail_question(Asked &r_asked, const char *asked_for, const Ask &ask) {
	Answer expected;
	REQUIRE(ask(expected).ok());
	REQUIRE(!expected.empty());
	fail_every_request(
			asked_for,
			[&] {
				r_asked.world.asked_for.clear();
				return Answer(3);
			},
			[&](Answer &answer) { return ask(answer); }, [](const Answer &answer) { REQUIRE(answer.empty()); },
			[&](const Answer &answer) { REQUIRE(equal(answer, expected)); });
}

} // namespace

TEST_CASE("out of memory: a query of any kind gives nothing, says so, and answers the next time") {
	Asked asked;
	const InstanceQuery query = asked.query();
	QueryFilter all;
	QueryFilter some;
	some.layers = {0, 2};
	some.accepts = [](const PlacedInstance &instance) {
		return instance.id % 3 != 0;
	};
	for (const QueryFilter &filter : {all, some}) {
		fail_question<std::vector<PlacedInstance>>(
				asked, "rect", [&](auto &found) { return query.in_rect(glade, filter, found); });
		fail_question<std::vector<PlacedInstance>>(
				asked, "radius", [&](auto &found) { return query.in_sphere({30.0, 0.0, 30.0}, 30.0, filter, found); });
		fail_question<std::vector<NearestInstance>>(asked, "max_distance",
				[&](auto &found) { return query.nearest({30.0, 0.0, 30.0}, 30.0, filter, found); });
		std::vector<NearestInstance> nearest;
		REQUIRE(query.nearest({30.0, 0.0, 30.0}, 30.0, filter, nearest).ok());
		const glm::dvec3 aim = nearest.at(0).instance.position;
		fail_question<std::vector<RayHit>>(asked, "to",
				[&](auto &hit) { return query.on_ray(aim + glm::dvec3(30.0, 9.0, 40.0), aim, filter, hit); });
		fail_question<std::vector<InstanceQuery::Tile>>(
				asked, "rect", [&](auto &tiles) { return query.tiles_in_rect(glade, filter, tiles); });
		fail_question<std::vector<InstanceQuery::Tile>>(asked, "radius",
				[&](auto &tiles) { return query.tiles_in_sphere({30.0, 0.0, 30.0}, 30.0, filter, tiles); });
	}
}

TEST_CASE("out of memory: an instance by its id") {
	Asked asked;
	const InstanceQuery query = asked.query();
	for (const std::uint32_t layer : {0u, 1u, 2u}) { // The last one has to sample its set to find the tile.
		CAPTURE(layer);
		const auto found = std::ranges::find_if(asked.all, [&](const PlacedInstance &each) {
			return each.layer == layer && glade.contains({each.position.x, each.position.z}) &&
					!asked.state.removed(each.id);
		});
		REQUIRE(found != asked.all.end());
		Status sampled;
		std::vector<PlacedInstance> expected;
		REQUIRE(query.by_id(found->id, expected).ok());
		for (std::size_t allowed = 0;; ++allowed) {
			std::vector<PlacedInstance> answer;
			Status status;
			asked.world.asked_for.clear();
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

TEST_CASE("out of memory: tiles that a query makes fail alike") {
	Asked asked;
	const InstanceQuery query = asked.query();
	std::vector<PlacedInstance> expected;
	REQUIRE(query.in_rect({{0.0, 0.0}, {20.0, 20.0}}, {.layers = {0}, .accepts = {}}, expected).ok());
	for (std::size_t allowed = 0, done = 0; done == 0; ++allowed) {
		asked.world.forget();
		asked.world.asked_for.clear();
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
