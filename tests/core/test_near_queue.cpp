#include "flat_world.hpp"
#include "near_follower.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

TEST_CASE("near queue: instances within the distance enter, the nearest first, and leave an eighth farther away") {
	FlatWorld flat;
	flat.load();
	Follower follower;
	CHECK_FALSE(follower.queue.settled());
	const glm::dvec3 center{3.0, 1.0, -2.0};
	follower.check(center, flat.world);
	double last = 0.0;
	for (PlacedInstance instance; follower.queue.next_entering(instance);) {
		const double center_distance = glm::distance(instance.position, center);
		CHECK(center_distance >= last);
		last = center_distance;
		follower.held.insert(instance.id);
	}
	CHECK(follower.held == flat.within(center, NearQueue::enter_factor * distance));
	CHECK(follower.held.size() > 100);
	CHECK(follower.queue.settled());
	glm::dvec3 at = center;
	for (int step = 0; step < 20; ++step) {
		at.x += 1.0;
		follower.check(at, flat.world);
		follower.follow();
		const std::set<std::uint64_t> near_ids = flat.within(at, distance);
		const std::set<std::uint64_t> reachable_ids = flat.within(at, NearQueue::leave_factor * distance);
		CHECK(std::includes(follower.held.begin(), follower.held.end(), near_ids.begin(), near_ids.end()));
		CHECK(std::includes(reachable_ids.begin(), reachable_ids.end(), follower.held.begin(), follower.held.end()));
	}
	follower.check(at + glm::dvec3(0.3, 0.0, 0.0), flat.world);
	CHECK(follower.follow() == 0);
	follower.queue.set_distances(std::array{0.0});
	follower.check(at, flat.world);
	follower.follow();
	CHECK(follower.held.empty());
	CHECK(follower.queue.settled());
}

TEST_CASE("near queue: a removed instance leaves, and one that is placed differently changes") {
	FlatWorld flat;
	flat.load();
	Follower follower;
	follower.check({}, flat.world);
	follower.follow();
	const std::uint64_t felled = *follower.held.begin();
	CHECK(flat.state.remove(felled));
	flat.world.touch();
	CHECK_FALSE(follower.queue.settled());
	follower.check({}, flat.world);
	InstanceToRelease release;
	REQUIRE(follower.queue.next_removed(release));
	CHECK(release.id == felled);
	follower.held.erase(felled);
	CHECK_FALSE(follower.queue.next_removed(release));
	CHECK(follower.follow() == 0);

	flat.load(2, 1.5);
	follower.check({}, flat.world);
	std::set<std::uint64_t> changed_ids;
	for (PlacedInstance instance; follower.queue.next_changed(instance);) {
		CHECK(instance.position.y == doctest::Approx(1.5));
		CHECK(changed_ids.insert(instance.id).second);
	}
	CHECK(changed_ids.size() > 100);
	CHECK(std::includes(follower.held.begin(), follower.held.end(), changed_ids.begin(), changed_ids.end()));
	follower.follow();
	PlacedInstance repeated;
	CHECK_FALSE(follower.queue.next_changed(repeated));
	CHECK(follower.queue.settled());
}

TEST_CASE("near queue: if very many instances are removed, the nearest leave first, across all cells and layers") {
	FlatWorld flat;
	flat.settings.set.radius = 0.9;
	flat.set_layers();
	flat.load(3);
	NearQueue queue;
	const glm::dvec3 center{3.0, 0.0, -2.0};
	std::map<std::uint64_t, glm::dvec3> held_positions;
	queue.set_distances(std::array{2.0 * distance});
	const auto check = [&] {
		queue.find_changes(std::array{center}, flat.world);
	};
	for (check(); !queue.settled(); check()) {
		for (PlacedInstance instance; queue.next_entering(instance);) {
			held_positions[instance.id] = instance.position;
		}
	}
	CHECK(held_positions.size() >
			NearQueue::max_checked_instances); // Otherwise, a single check would find all removed instances.
	// The order is exact within a frame. The next frame checks cells that are farther away.
	const auto check_nearest_first = [&](std::size_t expected) {
		std::size_t released_count = 0;
		double nearest_of_last = 0.0;
		for (int frame = 0; frame < NearQueue::max_waiting_frames && !queue.settled(); ++frame) {
			check();
			double last = 0.0;
			for (InstanceToRelease leaving; queue.next_removed(leaving); ++released_count) {
				REQUIRE(held_positions.contains(leaving.id));
				CHECK(leaving.position == held_positions[leaving.id]);
				const double center_distance = glm::distance(leaving.position, center);
				nearest_of_last = last == 0.0 ? center_distance : nearest_of_last;
				CHECK(center_distance >= last);
				last = center_distance;
				held_positions.erase(leaving.id);
			}
		}
		CHECK(nearest_of_last > 0.5 * distance);
		CHECK(released_count == expected);
	};
	std::size_t felled_id = 0;
	for (const auto &[id, position] : std::map(held_positions)) {
		if (id % 2 == 0 && flat.state.remove(id)) {
			++felled_id;
		}
	}
	CHECK(felled_id > 100);
	flat.world.touch();
	check_nearest_first(felled_id);
	queue.set_distances(std::array{0.0}); // A distance of 0 disables the layer's bodies.
	check_nearest_first(held_positions.size());
	CHECK(held_positions.empty());
	CHECK(queue.settled());
}

TEST_CASE("near queue: an instance that enters is not also reported as changed") {
	FlatWorld flat;
	flat.load();
	Follower follower;
	follower.check({}, flat.world);
	follower.follow();
	follower.check({9.0, 0.0, 0.0}, flat.world);
	PlacedInstance instance;
	for (int entered = 0; entered < 5; ++entered) {
		REQUIRE(follower.queue.next_entering(instance));
	}
	CHECK_FALSE(follower.queue.next_changed(instance));
}

TEST_CASE("near queue: a released instance enters again") {
	FlatWorld flat;
	flat.load();
	Follower follower;
	follower.check({}, flat.world);
	follower.follow();
	const std::uint64_t id = *follower.held.begin();
	follower.queue.release(0, id);
	CHECK_FALSE(follower.queue.holds(0, id));
	CHECK_FALSE(follower.queue.settled());
	follower.held.erase(id);
	follower.check({}, flat.world);
	CHECK(follower.follow() == 1);
	CHECK(follower.held.contains(id));
	CHECK(follower.queue.holds(0, id));
	follower.queue.release(id);
	PlacedInstance instance;
	CHECK_FALSE(follower.queue.next_entering(instance));
	follower.queue.release_layer(0);
	follower.held.clear();
	follower.check({}, flat.world);
	CHECK(follower.follow() > 100);
}

TEST_CASE("near queue: very many centers take turns to be checked, although the world changes in every frame") {
	FlatWorld flat;
	flat.load(12);
	Follower follower;
	std::vector<glm::dvec3> centers;
	for (int index = 0; index < 49; ++index) {
		centers.emplace_back(index % 7 * 100.0 - 300.0, 0.0, index / 7 * 100.0 - 300.0);
	}
	std::set<std::uint64_t> near;
	for (const glm::dvec3 &center : centers) {
		near.merge(flat.within(center, NearQueue::enter_factor * distance));
	}
	CHECK(near.size() > 5 * NearQueue::max_checked_instances);
	int frames = 0;
	int max_count = 0;
	const auto follow = [&](bool restless) {
		if (restless) {
			flat.world.touch();
		}
		follower.queue.find_changes(centers, flat.world);
		max_count = std::max(max_count, follower.follow());
		++frames;
	};
	while (follower.held.size() < near.size() && frames < 100) {
		follow(true);
	}
	CHECK(follower.held == near);
	CHECK(frames > 5);
	CHECK(max_count < static_cast<int>(NearQueue::max_checked_instances + NearQueue::max_checked_instances / 2));
	while (!follower.queue.settled() && frames < 200) {
		follow(false);
	}
	CHECK(frames < 200);

	// Only one center moves. The cells of all other centers are not checked, and the changes around
	// the moving center are found immediately.
	for (int step = 0; step < 20; ++step) {
		centers[8].x += 1.0;
		follow(false);
		const std::set<std::uint64_t> center_ids = flat.within(centers[8], distance);
		CHECK(std::includes(follower.held.begin(), follower.held.end(), center_ids.begin(), center_ids.end()));
	}
	centers.clear();
	for (int frame = 0; frame < 100; ++frame) {
		follow(false);
	}
	CHECK(follower.held.empty());
	CHECK(follower.queue.settled());
}

TEST_CASE("near queue: a new distance keeps the near instances") {
	FlatWorld flat;
	flat.load(3);
	Follower follower;
	const glm::dvec3 center{-7.0, 0.0, 5.0};
	follower.check(center, flat.world);
	follower.follow();
	for (const double other : {9.0, 50.0, 2.0, distance}) {
		const std::set<std::uint64_t> before = follower.held;
		follower.queue.set_distances(std::array{other});
		CHECK_FALSE(follower.queue.settled());
		std::set<std::uint64_t> remaining;
		std::size_t entered = 0;
		for (int frame = 0; frame < 10; ++frame) {
			follower.check(center, flat.world);
			for (InstanceToRelease leaving; follower.queue.next_leaving(leaving);) {
				CHECK(remaining.insert(leaving.id).second);
			}
			for (PlacedInstance instance; follower.queue.next_entering(instance); ++entered) {
				CHECK_FALSE(before.contains(instance.id));
				follower.held.insert(instance.id);
			}
		}
		for (const std::uint64_t id : remaining) {
			CHECK(follower.held.erase(id) == 1);
		}
		const std::set<std::uint64_t> enter = flat.within(center, NearQueue::enter_factor * other);
		const std::set<std::uint64_t> reachable_ids = flat.within(center, NearQueue::leave_factor * other);
		CHECK(std::includes(follower.held.begin(), follower.held.end(), enter.begin(), enter.end()));
		CHECK(std::includes(reachable_ids.begin(), reachable_ids.end(), follower.held.begin(), follower.held.end()));
		CHECK((remaining.empty() || entered == 0));
		CHECK(follower.queue.settled());
	}
}

TEST_CASE("near queue: setting an unchanged distance leaves its layer unchanged, even if other layers change") {
	FlatWorld flat;
	flat.load(3);
	NearQueue queue;
	queue.set_distances(std::array{distance, 0.0});
	const std::array<glm::dvec3, 1> centers{glm::dvec3{-7.0, 0.0, 5.0}};
	queue.find_changes(centers, flat.world);
	std::size_t entered = 0;
	for (PlacedInstance instance; queue.next_entering(instance);) {
		++entered;
	}
	CHECK(entered > 100);
	CHECK(queue.settled());
	queue.set_distances(std::array{distance, 0.0});
	CHECK(queue.settled()); // No other check is needed.
	queue.set_distances(std::array{distance, 9.0});
	CHECK_FALSE(queue.settled());
	for (PlacedInstance instance; queue.next_entering(instance);) {
		CHECK(false);
	}
	InstanceToRelease leaving;
	for (int frame = 0; frame < 3; ++frame) {
		queue.find_changes(centers, flat.world);
		CHECK_FALSE(queue.next_leaving(leaving));
	}
}

TEST_CASE("near queue: nothing is near centers that are not finite") {
	FlatWorld flat;
	flat.load(1);
	Follower follower;
	for (const double invalid : {std::nan(""), std::numeric_limits<double>::infinity(), -1e300}) {
		follower.check({invalid, 0.0, 1.0}, flat.world);
		follower.check({1.0, 0.0, invalid}, flat.world);
		CHECK(follower.follow() == 0);
	}
	follower.check({}, flat.world);
	CHECK(follower.follow() > 100);
}

TEST_CASE("near queue: unknown tiles are reported as missing") {
	FlatWorld flat;
	Follower follower;
	follower.check({}, flat.world);
	CHECK(follower.follow() == 0);
	CHECK(flat.world.take_missing().size() >= 4);
	flat.load();
	follower.check({}, flat.world);
	CHECK(follower.follow() > 100);
	CHECK(flat.world.take_missing().empty());
}

TEST_CASE("near queue: nothing is checked while the centers do not move or move a small step") {
	FlatWorld flat; // The world is empty, so every check reports missing tiles.
	Follower follower;
	std::vector<glm::dvec3> centers{{5.0, 0.0, 5.0}};
	const auto checks = [&] {
		follower.queue.find_changes(centers, flat.world);
		return !flat.world.take_missing().empty();
	};
	CHECK(checks());
	for (int frame = 1; frame < NearCell::max_frames_between_checks / 2; ++frame) {
		centers[0].x += 0.9 * NearQueue::slack_fraction * distance / NearCell::max_frames_between_checks;
		CHECK_FALSE(checks());
	}
	centers[0].x += NearQueue::slack_fraction * distance;
	CHECK(checks());
	CHECK_FALSE(checks());
	flat.world.touch();
	CHECK(checks());
	flat.world.keep({0, {40, 0}}, flat.make({40, 0})); // A tile that loads far away causes no new check.
	CHECK_FALSE(checks());
	flat.world.keep({0, {0, 0}}, flat.make({0, 0}));
	CHECK(checks());
}

TEST_CASE("near queue: only the part of a cell within reach is checked") {
	FlatWorld flat;
	Follower follower;
	const std::vector<glm::dvec3> centers{
			// The square of 22.5 m around it touches 4 tiles of 32 m. The cells that it touches
			// would touch 9.
			{5.0, 0.0, 5.0}};
	follower.queue.find_changes(centers, flat.world);
	CHECK(flat.world.take_missing().size() == 4);
}
