#include "flat_world.hpp"
#include "near_follower.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

using namespace thicket;
using namespace thicket::test;

TEST_CASE("near queue: each due instance is returned once, the nearest first, while centers move") {
	FlatWorld flat;
	flat.load(3);
	Follower follower;
	const glm::dvec3 center{3.0, 0.0, -2.0};
	follower.check(center, flat.world);
	follower.follow();
	const auto take_due = [&](std::size_t max_count, double &r_last) {
		std::set<std::uint64_t> due_ids;
		PlacedInstance instance;
		while (due_ids.size() < max_count && follower.queue.next_due(instance)) {
			const double center_distance = glm::distance(instance.position, center);
			CHECK(center_distance >= r_last - 0.9); // Between the calls, the center moves by 0.4 m.
			r_last = center_distance;
			CHECK(due_ids.insert(instance.id).second);
			CHECK(follower.held.contains(instance.id));
		}
		return due_ids;
	};
	double last = 0.0;
	CHECK(take_due(1000, last).empty());
	CHECK(follower.queue.settled());
	follower.queue.renew(0);
	CHECK_FALSE(follower.queue.settled());
	std::set<std::uint64_t> due_ids = take_due(60, last);
	CHECK(due_ids.size() == 60);
	follower.check(center + glm::dvec3(0.4, 0.0, 0.0), flat.world);
	follower.follow();
	due_ids.merge(take_due(10000, last));
	CHECK(due_ids == follower.held);
	CHECK(follower.queue.settled());

	// A new distance changes the cells. All held instances are returned again, so some of them are
	// returned twice.
	follower.queue.renew(0);
	last = 0.0;
	due_ids = take_due(60, last);
	follower.queue.set_distances(std::array{60.0});
	last = 0.0;
	const std::set<std::uint64_t> remaining = take_due(10000, last);
	CHECK(remaining == follower.held);

	// Instances that have left since then are no longer due.
	follower.check(center, flat.world);
	follower.follow();
	follower.queue.renew(0);
	follower.queue.release_layer(0);
	CHECK(take_due(10000, last).empty());
}

TEST_CASE("near queue: finds the nearest held instances around positions") {
	FlatWorld flat;
	flat.load(3);
	Follower follower;
	follower.check({}, flat.world);
	follower.follow();
	const std::array<glm::dvec3, 2> positions{glm::dvec3{4.0, 0.0, 4.0}, glm::dvec3{-15.0, 0.0, 0.0}};
	std::set<std::uint64_t> expected = flat.within(positions[0], 6.0);
	expected.merge(flat.within(positions[1], 6.0));
	const std::vector<NearHeld> results = follower.queue.held_within(positions, 6.0, 1000);
	std::set<std::uint64_t> ids;
	double last = 0.0;
	for (const NearHeld &instance : results) {
		CHECK(instance.layer == 0);
		CHECK(instance.distance_squared >= last);
		last = instance.distance_squared;
		ids.insert(instance.id);
	}
	CHECK(last <= 6.0 * 6.0);
	CHECK(ids == expected);
	CHECK(results.size() == expected.size());
	const std::vector<NearHeld> first = follower.queue.held_within(positions, 6.0, 10);
	REQUIRE(first.size() == 10);
	CHECK(first[9].id == results[9].id);
	CHECK(follower.queue.held_within({}, 1e6, 10).empty());
}
