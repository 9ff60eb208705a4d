#include "core/near/near_set.hpp"
#include "rounding.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

using namespace thicket;
using test::rounds;

namespace {

PlacedInstance instance_at(std::uint64_t id, glm::dvec3 position) {
	PlacedInstance instance;
	instance.id = id;
	instance.position = position;
	return instance;
}

/// Returns instances with the IDs 1 to `count`. Instance i is at x = i * apart.
std::vector<PlacedInstance> row(std::uint64_t count, double spacing = 1.0) {
	std::vector<PlacedInstance> result;
	for (std::uint64_t id = 1; id <= count; ++id) {
		result.push_back(instance_at(id, {static_cast<double>(id) * spacing, 0.0, 0.0}));
	}
	return result;
}

std::vector<std::uint64_t> ids_of(const std::vector<PlacedInstance> &instances) {
	std::vector<std::uint64_t> result;
	for (const PlacedInstance &instance : instances) {
		result.push_back(instance.id);
	}
	return result;
}

std::vector<std::uint64_t> ids_of(const std::vector<NearRelease> &leaving) {
	std::vector<std::uint64_t> result;
	for (const NearRelease &each : leaving) {
		result.push_back(each.id);
	}
	return result;
}

/// Applies all changes that a check returned.
void follow(NearSet &set, const NearChanges &changes) {
	for (const NearRelease &leaving : changes.leave) {
		CHECK(set.holds(leaving.id));
		set.release(leaving.id);
	}
	for (const PlacedInstance &instance : changes.changed) {
		CHECK(set.holds(instance.id));
		REQUIRE(set.retain(instance));
	}
	for (const PlacedInstance &instance : changes.enter) {
		CHECK_FALSE(set.holds(instance.id));
		REQUIRE(set.retain(instance));
	}
}

using Ids = std::vector<std::uint64_t>;

} // namespace

TEST_CASE("near set: the nearest enter first, the farthest leave first") {
	NearSet set;
	NearChanges changes;
	std::vector<PlacedInstance> present = row(10);
	std::reverse(present.begin(), present.end());
	std::vector<glm::dvec3> centers{{4.2, 0.0, 0.0}};
	set.find_changes(centers, {2.5, 4.0}, present, changes);
	CHECK(ids_of(changes.enter) == Ids{4, 5, 3, 6, 2});
	CHECK(changes.leave.empty());
	follow(set, changes);
	CHECK(set.size() == 5);

	centers[0].x = 8.1; // Instance 5 is within 4 m; instances 2 to 4 are not.
	set.find_changes(centers, {2.5, 4.0}, present, changes);
	CHECK(ids_of(changes.enter) == Ids{8, 9, 7, 10});
	CHECK(ids_of(changes.leave) == Ids{2, 3, 4});
	CHECK(changes.removed_count == 0);
}

TEST_CASE("near set: both ends of the range are inclusive, in three dimensions") {
	NearSet set;
	NearChanges changes;
	const std::vector<glm::dvec3> centers{{0.0, 3.0, 0.0}};
	std::vector<PlacedInstance> present{instance_at(1, {4.0, 0.0, 0.0})}; // The instance is 5 m away.
	set.find_changes(centers, {4.999, 6.0}, present, changes);
	CHECK(changes.enter.empty());
	set.find_changes(centers, {5.0, 6.0}, present, changes);
	CHECK(ids_of(changes.enter) == Ids{1});
	follow(set, changes);
	set.find_changes(centers, {1.0, 5.0}, present, changes);
	CHECK(changes.leave.empty());
	set.find_changes(centers, {1.0, 4.999}, present, changes);
	CHECK(ids_of(changes.leave) == Ids{1});
}

TEST_CASE("near set: a range of 0 contains no instances, and an inverted range uses the enter distance") {
	NearSet set;
	NearChanges changes;
	const std::vector<glm::dvec3> centers{{1.0, 0.0, 0.0}};
	const std::vector<PlacedInstance> present = row(5);
	set.find_changes(centers, {2.0, 0.0}, present, changes);
	CHECK(ids_of(changes.enter) == Ids{1, 2, 3});
	follow(set, changes);
	set.find_changes(centers, {2.0, 0.0}, present, changes);
	CHECK(changes.enter.empty());
	CHECK(changes.leave.empty());
	set.find_changes(centers, {0.0, 10.0}, present, changes);
	CHECK(changes.enter.empty());
	CHECK(ids_of(changes.leave) == Ids{1, 2, 3}); // The range is 0, so all leave, the nearest first.
	CHECK(changes.removed_count == 3);
	set.find_changes({}, {2.0, 3.0}, present, changes); // Without centers, nothing is near.
	CHECK(changes.enter.empty());
	CHECK(ids_of(changes.leave) == Ids{1, 2, 3});
}

TEST_CASE("near set: removed instances leave before distant ones, the nearest first") {
	NearSet set;
	NearChanges changes;
	std::vector<glm::dvec3> centers{{0.0, 0.0, 0.0}};
	std::vector<PlacedInstance> present = row(6);
	set.find_changes(centers, {6.0, 8.0}, present, changes);
	follow(set, changes);
	std::erase_if(present, [](const PlacedInstance &instance) { return instance.id == 2 || instance.id == 3; });
	centers[0].x = -3.5; // Instances 5 and 6 are beyond 8 m.
	set.find_changes(centers, {6.0, 8.0}, present, changes);
	CHECK(changes.enter.empty());
	CHECK(ids_of(changes.leave) == Ids{2, 3, 6, 5});
	CHECK(changes.removed_count == 2);
}

TEST_CASE("near set: an instance that is placed differently has changed, and neither enters nor leaves") {
	NearSet set;
	NearChanges changes;
	const std::vector<glm::dvec3> centers{{0.0, 0.0, 0.0}};
	const std::vector<PlacedInstance> before = row(5);
	set.find_changes(centers, {5.0, 7.0}, before, changes);
	follow(set, changes);

	std::vector<PlacedInstance> present = before;
	present[0].position.y += 0.5 * NearSet::same_position; // The difference is within rounding.
	present[0].basis[1][1] += 0.5f * NearSet::same_basis;
	present[1].position.y += 0.25;
	present[2].basis[1][1] = 1.1f;
	present[3].mesh = 1;
	present[4].position.x = 6.0; // The instance is between the enter and leave distances, so it stays.
	set.find_changes(centers, {5.0, 7.0}, present, changes);
	CHECK(changes.leave.empty());
	CHECK(changes.enter.empty());
	CHECK(ids_of(changes.changed) == Ids{2, 3, 4, 5});
	CHECK(changes.changed[0].position.y == present[1].position.y);
	follow(set, changes);
	set.find_changes(centers, {5.0, 7.0}, present, changes);
	CHECK(changes.leave.empty());
	CHECK(changes.enter.empty());
	CHECK(changes.changed.empty());

	for (PlacedInstance &instance : present) {
		instance.layer = 3;
	}
	set.find_changes(centers, {5.0, 7.0}, present, changes);
	CHECK(changes.changed.size() == 5);
	follow(set, changes);

	present[4].position.x = 7.5; // The instance is beyond both distances.
	set.find_changes(centers, {5.0, 7.0}, present, changes);
	CHECK(ids_of(changes.leave) == Ids{5});
	CHECK(changes.leave[0].position.x == 6.0);
	CHECK(changes.removed_count == 1);
	CHECK(changes.changed.empty());
}

TEST_CASE("near set: moving back and forth within the hysteresis has no effect") {
	NearSet set;
	NearChanges changes;
	const std::vector<PlacedInstance> present = row(400, 0.05);
	std::vector<glm::dvec3> centers{{10.0, 0.0, 0.0}};
	const NearRange range{4.0, 5.0};
	std::map<std::uint64_t, int> entered;
	std::map<std::uint64_t, int> leave_counts;
	std::mt19937_64 random(5);
	// The range is shorter than the difference between the leave and enter distances.
	std::uniform_real_distribution<double> along(-0.499, 0.499);
	for (int frame = 0; frame < 300; ++frame) {
		centers[0].x = 10.0 + along(random);
		set.find_changes(centers, range, present, changes);
		for (const PlacedInstance &instance : changes.enter) {
			++entered[instance.id];
		}
		for (const std::uint64_t id : ids_of(changes.leave)) {
			++leave_counts[id];
		}
		follow(set, changes);
	}
	CHECK(entered.size() > 150);
	CHECK(std::all_of(entered.begin(), entered.end(), [](const auto &entry) { return entry.second == 1; }));
	CHECK(leave_counts.empty());
}

TEST_CASE("near set: several centers work, and an instance may be passed several times") {
	NearSet set;
	NearChanges changes;
	const std::vector<glm::dvec3> centers{{0.0, 0.0, 0.0}, {100.0, 0.0, 0.0}, {100.5, 0.0, 0.0}};
	std::vector<PlacedInstance> present = row(101);
	const std::vector<PlacedInstance> first_results = present;
	present.insert(present.end(), first_results.begin(), first_results.end());
	set.find_changes(centers, {2.0, 3.0}, present, changes);
	CHECK(ids_of(changes.enter) == Ids{100, 101, 1, 99, 2, 98});
	follow(set, changes);
	set.find_changes(centers, {2.0, 3.0}, present, changes);
	CHECK(changes.enter.empty());
	set.find_changes(std::span(centers).first(1), {2.0, 3.0}, present, changes);
	CHECK(ids_of(changes.leave) == Ids{101, 100, 99, 98});
}

TEST_CASE("near set: released instances are no longer held") {
	NearSet set;
	NearChanges changes;
	const std::vector<glm::dvec3> centers{{0.0, 0.0, 0.0}};
	const std::vector<PlacedInstance> present = row(4);
	set.find_changes(centers, {3.0, 4.0}, present, changes);
	REQUIRE(set.retain(changes.enter[0])); // The caller had time for only two of three.
	REQUIRE(set.retain(changes.enter[1]));
	set.release(1);
	set.release(77);
	set.find_changes(centers, {3.0, 4.0}, present, changes);
	CHECK(ids_of(changes.enter) == Ids{1, 3});
	set.clear();
	CHECK(set.size() == 0);
	set.find_changes(centers, {3.0, 4.0}, present, changes);
	CHECK(ids_of(changes.enter) == Ids{1, 2, 3});
	CHECK(changes.leave.empty());
}

TEST_CASE("near set: random walks, removals and moves match brute force") {
	std::mt19937_64 random(77);
	std::uniform_real_distribution<double> anywhere(-50.0, 50.0);
	std::uniform_real_distribution<double> step(-4.0, 4.0);
	std::uniform_int_distribution<int> percent(0, 99);
	NearSet set;
	NearChanges changes;
	std::vector<PlacedInstance> present;
	for (std::uint64_t id = 1; id <= 600; ++id) {
		present.push_back(
				instance_at(id * 0x9e3779b97f4a7c15ULL, {anywhere(random), 0.1 * step(random), anywhere(random)}));
	}
	std::vector<glm::dvec3> centers(3);
	std::map<std::uint64_t, glm::dvec3> held_positions; // The positions of held instances by ID.
	const NearRange range{12.0, 15.0};
	for (int frame = 0; frame < 400; ++frame) {
		for (glm::dvec3 &center : centers) {
			center += percent(random) == 0 ? glm::dvec3(anywhere(random), 0.0, anywhere(random))
										   : glm::dvec3(step(random), 0.2 * step(random), step(random));
			center = glm::clamp(center, glm::dvec3(-50.0), glm::dvec3(50.0));
		}
		for (PlacedInstance &instance : present) {
			if (percent(random) == 0) {
				instance.position.x = anywhere(random);
			}
		}
		std::vector<PlacedInstance> nearby = present;
		std::erase_if(nearby, [&](const PlacedInstance &) { return percent(random) < 2; });
		std::shuffle(nearby.begin(), nearby.end(), random);
		const auto distance_to_centers = [&centers](glm::dvec3 position) {
			double nearest = 1e9;
			for (const glm::dvec3 &center : centers) {
				nearest = std::min(nearest, glm::distance(center, position));
			}
			return nearest;
		};

		std::set<std::uint64_t> enter;
		std::set<std::uint64_t> changed_ids;
		std::set<std::uint64_t> leave;
		for (const auto &[id, position] : held_positions) {
			leave.insert(id);
		}
		for (const PlacedInstance &instance : nearby) {
			const auto previous = held_positions.find(instance.id);
			if (previous == held_positions.end() || previous->second != instance.position) {
				if (previous == held_positions.end() && distance_to_centers(instance.position) <= range.enter) {
					enter.insert(instance.id);
				} else if (previous != held_positions.end() && distance_to_centers(instance.position) <= range.leave) {
					changed_ids.insert(instance.id);
					leave.erase(instance.id);
				}
			} else if (distance_to_centers(instance.position) <= range.leave) {
				leave.erase(instance.id);
			}
		}
		set.find_changes(centers, range, nearby, changes);
		const Ids entering = ids_of(changes.enter);
		CHECK(std::set<std::uint64_t>(entering.begin(), entering.end()) == enter);
		CHECK(entering.size() == enter.size());
		const Ids changing = ids_of(changes.changed);
		CHECK(std::set<std::uint64_t>(changing.begin(), changing.end()) == changed_ids);
		CHECK(changing.size() == changed_ids.size());
		const Ids leaving = ids_of(changes.leave);
		CHECK(std::set<std::uint64_t>(leaving.begin(), leaving.end()) == leave);
		CHECK(leaving.size() == leave.size());
		CHECK(std::is_sorted(
				changes.enter.begin(), changes.enter.end(), [&distance_to_centers](const auto &a, const auto &b) {
					return distance_to_centers(a.position) < distance_to_centers(b.position);
				}));

		// Sometimes the caller has no time for all entering instances.
		for (const std::uint64_t id : leaving) {
			set.release(id);
			held_positions.erase(id);
		}
		for (const PlacedInstance &instance : changes.changed) {
			REQUIRE(set.retain(instance));
			held_positions[instance.id] = instance.position;
		}
		const std::size_t checked_count =
				changes.enter.size() - changes.enter.size() * static_cast<std::size_t>(percent(random)) / 200;
		for (std::size_t i = 0; i < checked_count; ++i) {
			REQUIRE(set.retain(changes.enter[i]));
			held_positions[changes.enter[i].id] = changes.enter[i].position;
		}
		CHECK(set.size() == held_positions.size());
	}
}

TEST_CASE("near set: an instance that stays near is tested against its previous center first") {
	// The distances to the center at integer coordinates are integers. Those to the other centers
	// are rounded.
	std::vector<glm::dvec3> centers(100, glm::dvec3(900.1, 0.3, 0.7));
	centers.emplace_back(4.0, 0.0, 0.0);
	const std::vector<PlacedInstance> present = row(6);
	NearSet set;
	NearChanges changes;
	const NearRange range{8.0, 9.0};
	REQUIRE(set.find_changes(centers, range, present, changes));
	follow(set, changes);
	CHECK(set.size() == 6);
	// The first check searches for the center.
	CHECK(rounds([&] { REQUIRE(set.find_changes(centers, range, present, changes)); }));
	centers.back().x += 1.0;
	CHECK_FALSE(rounds([&] { REQUIRE(set.find_changes(centers, range, present, changes)); }));
	CHECK(changes.enter.empty());
	CHECK(changes.leave.empty());
}
