// Drives a NearQueue as the code for physics bodies does and checks that each instance enters and
// leaves only once.

#pragma once

#include "core/near/near_queue.hpp"

#include <doctest/doctest.h>

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <set>

namespace thicket::test {

inline constexpr double distance = 20.0;

/// Tracks the IDs of all near instances from the changes that the queue reports.
struct Follower {
	NearQueue queue;
	std::set<std::uint64_t> held;

	Follower() { queue.set_distances(std::array{distance}); }

	void check(glm::dvec3 center, const InstanceWorld &world) { queue.find_changes(std::array{center}, world); }

	/// Takes all pending changes from the queue. Returns their number.
	int follow() {
		int steps = 0;
		for (InstanceToRelease leaving; queue.next_leaving(leaving); ++steps) {
			CHECK(held.erase(leaving.id) == 1);
		}
		for (PlacedInstance instance; queue.next_changed(instance); ++steps) {
			CHECK(held.contains(instance.id));
		}
		for (PlacedInstance instance; queue.next_entering(instance); ++steps) {
			CHECK(held.insert(instance.id).second);
		}
		return steps;
	}
};

} // namespace thicket::test
