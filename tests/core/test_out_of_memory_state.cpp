// Tests that a state, the overlay of a visible tile, and a near set stay unchanged, whichever
// allocation fails.

#include "core/near/near_set.hpp"
#include "core/near/tile_overlay.hpp"
#include "short_of_memory.hpp"
#include "state_fixture.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// A state and the changes that it has reported.
struct RecordedState {
	InstanceState state;
	std::vector<InstanceChange> changes;
	std::uint64_t id = 0;
};

const StateBytes some_bytes(99, 7);

/// Returns true if everything that `save` writes is equal, including the clock and the stamps.
bool equal(const InstanceState &a, const InstanceState &b) { return bytes_of(a) == bytes_of(b); }

/// Returns a state. The same arguments always produce the same state, including its revision.
InstanceState some_state(std::uint64_t seed, int changes) {
	InstanceState state;
	StateRandom random(seed);
	change_at_random(state, random, changes);
	for (const int layer : {0, 16000, 32000}) {
		REQUIRE(state.claim(static_cast<std::uint16_t>(layer), 77).ok());
	}
	return state;
}

/// Repeats a change while each of its allocations fails in turn. A failed call must change and
/// report nothing, and the next call must succeed.
template <typename Change>
void fail_change(const std::string &refused, std::uint64_t seed, int random_changes, const Change &change) {
	const InstanceState before = some_state(seed, random_changes);
	RecordedState after{some_state(seed, random_changes), {}, 0};
	REQUIRE(change(after).ok());
	fail_every_request(
			refused, [&] { return RecordedState{some_state(seed, random_changes), {}, 0}; }, change,
			[&](RecordedState &recorded) {
				REQUIRE(equal(recorded.state, before));
				REQUIRE(recorded.state.revision() == before.revision());
				REQUIRE(recorded.changes.empty());
				REQUIRE(recorded.id == 0);
			},
			[&](const RecordedState &recorded) {
				REQUIRE(equal(recorded.state, after.state));
				REQUIRE(recorded.state.revision() == after.state.revision());
				REQUIRE(recorded.id == after.id);
				REQUIRE(recorded.changes.size() == after.changes.size());
				for (std::size_t i = 0; i < recorded.changes.size(); ++i) {
					REQUIRE(recorded.changes[i].id == after.changes[i].id);
					REQUIRE(recorded.changes[i].kind == after.changes[i].kind);
					REQUIRE(recorded.changes[i].added == after.changes[i].added);
				}
			});
}

/// Returns the IDs of points, some of which are removed in the states.
std::vector<std::uint64_t> near_points() {
	std::vector<std::uint64_t> ids;
	for (int i = -6; i < 6; ++i) {
		ids.push_back(point_id(16000, i, i / 2));
	}
	return ids;
}

} // namespace

TEST_CASE("out of memory: a single change to a state is complete or has no effect") {
	for (const std::uint64_t seed : {1u, 2u, 3u}) {
		for (const int random_changes : {0, 40, 300}) {
			const InstanceState state = some_state(seed, random_changes);
			for (const std::uint64_t id : near_points()) {
				if (!state.removed(id)) {
					fail_change("id", seed, random_changes,
							[id](RecordedState &recorded) { return recorded.state.remove(id).status; });
					fail_change("id", seed, random_changes, [id](RecordedState &recorded) {
						return recorded.state.remove(id, recorded.state.time() + 9.0).status;
					});
				} else {
					fail_change("id", seed, random_changes,
							[id](RecordedState &recorded) { return recorded.state.restore(id).status; });
				}
			}
			for (const std::uint64_t id : state.added_ids()) {
				fail_change("id", seed, random_changes,
						[id](RecordedState &recorded) { return recorded.state.remove(id).status; });
				fail_change("data", seed, random_changes,
						[id](RecordedState &recorded) { return recorded.state.set_data(id, some_bytes); });
				fail_change("instance", seed, random_changes, [id](RecordedState &recorded) {
					return recorded.state.move(
							id, instance_at(700.0, 80.0, layer_of(id)), recorded.id, recorded.changes);
				});
			}
			fail_change("instance", seed, random_changes, [](RecordedState &recorded) {
				return recorded.state.move(
						point_id(9, 1, 1), instance_at(70.0, 80.0, 9), recorded.id, recorded.changes);
			});
			fail_change("instance", seed, random_changes, [](RecordedState &recorded) {
				return recorded.state.add(instance_at(70.0, 80.0, 5), recorded.id);
			});
			fail_change("data", seed, random_changes,
					[](RecordedState &recorded) { return recorded.state.set_data(point_id(9, 1, 1), some_bytes); });
			fail_change(
					"layer", seed, random_changes, [](RecordedState &recorded) { return recorded.state.claim(77, 1); });
		}
	}
}

TEST_CASE("out of memory: a state loads, applies diffs and merges completely or not at all") {
	for (const std::uint64_t seed : {4u, 5u}) {
		for (const int random_changes : {0, 60, 400}) {
			InstanceState other = some_state(seed + 100, 200);
			const StateBytes saved_bytes = bytes_of(other);
			const StateBytes diff = diff_of(other, other.revision() / 2);
			other.set_origin(5);
			const StateBytes named = diff_of(other, 0);
			fail_change("data", seed, random_changes,
					[&](RecordedState &recorded) { return recorded.state.load(saved_bytes, recorded.changes); });
			fail_change("data", seed, random_changes,
					[&](RecordedState &recorded) { return recorded.state.apply(saved_bytes, recorded.changes); });
			fail_change("data", seed, random_changes,
					[&](RecordedState &recorded) { return recorded.state.apply(diff, recorded.changes); });
			fail_change("data", seed, random_changes,
					[&](RecordedState &recorded) { return recorded.state.apply(named, recorded.changes); });
			fail_change("data", seed, random_changes, [&](RecordedState &recorded) {
				const Status status = recorded.state.merge_diff(diff, recorded.changes);
				REQUIRE(recorded.state.known_revision(5) == 0);
				return status;
			});
			fail_change("other", seed, random_changes,
					[&](RecordedState &recorded) { return recorded.state.merge(other, recorded.changes); });
		}
	}
}

TEST_CASE("out of memory: a clock advances and a state is cleared completely or not at all") {
	for (const std::uint64_t seed : {6u, 7u}) {
		for (const int random_changes : {60, 400}) {
			fail_change("changes", seed, random_changes,
					[](RecordedState &recorded) { return recorded.state.clear(recorded.changes); });
			for (const double seconds : {20.0, 1000.0}) {
				fail_change("seconds", seed, random_changes,
						[=](RecordedState &recorded) { return recorded.state.advance(seconds, recorded.changes); });
			}
		}
	}
}

TEST_CASE("out of memory: a state returns complete bytes and lists, or none") {
	InstanceState state = some_state(8, 300);
	for (int i = 0; i < 9; ++i) {
		std::uint64_t id = 0;
		REQUIRE(state.add(instance_at(i, 100.0 * i, 16000), id).ok());
	}
	const StateBytes saved_bytes = bytes_of(state);
	const StateBytes diff = diff_of(state, 20);
	const auto nothing = [](const StateBytes &bytes) {
		REQUIRE(bytes.empty());
	};
	fail_every_request(
			"state", [] { return StateBytes(3); }, [&](StateBytes &bytes) { return state.save(bytes); }, nothing,
			[&](const StateBytes &bytes) { REQUIRE(bytes == saved_bytes); });
	fail_every_request(
			"state", [] { return StateBytes(3); }, [&](StateBytes &bytes) { return state.diff_since(20, bytes); },
			nothing, [&](const StateBytes &bytes) { REQUIRE(bytes == diff); });
	const Rect all{glm::dvec2(-1e6), glm::dvec2(1e6)};
	using Ids = std::vector<std::uint64_t>;
	Ids expected{42};
	REQUIRE(state.added_in(16000, all, expected).ok());
	REQUIRE(expected.size() > 5);
	fail_every_request(
			"rect", [] { return Ids{42}; }, [&](Ids &ids) { return state.added_in(16000, all, ids); },
			[](const Ids &ids) { REQUIRE(ids == Ids{42}); }, [&](const Ids &ids) { REQUIRE(ids == expected); });
}

TEST_CASE("out of memory: a peer that requests forgotten changes gets the whole state") {
	for (std::size_t allowed = 0; allowed < 30; ++allowed) {
		InstanceState recorded = some_state(9, 100);
		InstanceState peer = copy_of(recorded);
		const std::uint64_t known_revision = recorded.revision();
		{
			const AllocationLimit limit(allowed, AllocationLimit::Fails::one);
			for (int i = 0; i < 300; ++i) {
				static_cast<void>(recorded.remove(point_id(3, i, 2 * i)));
			}
		}
		std::vector<InstanceChange> changes;
		REQUIRE(peer.apply(diff_of(recorded, known_revision), changes).ok());
		REQUIRE(peer.digest() == recorded.digest());
	}
}

TEST_CASE("out of memory: a state continues like one that never ran out of memory") {
	InstanceState state;
	InstanceState twin;
	StateRandom random(10);
	for (int i = 0; i < 3000; ++i) {
		const std::uint64_t id = point_id(2, static_cast<int>(random() % 60), static_cast<int>(random() % 3));
		const double end_time = random() % 2 == 0 ? state.time() + 1.0 + static_cast<double>(random() % 30) : 0.0;
		const std::uint64_t operation = random() % 8;
		const auto change = [&](InstanceState &r_state, std::vector<InstanceChange> &r_changes) -> Status {
			if (operation == 0) {
				return r_state.advance(1.0, r_changes);
			}
			return operation < 6 ? r_state.remove(id, end_time).status : r_state.restore(id).status;
		};
		std::vector<InstanceChange> changes;
		Status status;
		{
			const AllocationLimit limit(random() % 4);
			status = change(state, changes);
		}
		if (!status.ok()) {
			REQUIRE(change(state, changes).ok());
		}
		std::vector<InstanceChange> expected;
		REQUIRE(change(twin, expected).ok());
		REQUIRE(changes.size() == expected.size());
		REQUIRE(state.removed_count() == twin.removed_count());
	}
	CHECK(equal(state, twin));
}

TEST_CASE("out of memory: a visible tile gets its complete overlay or stays unchanged") {
	const auto tile = compact_tile(rich_layer(), built(rich_layer(), hills(), {{-20.0, 0.0}, {20.0, 40.0}}));
	InstanceState state;
	std::unordered_set<std::uint64_t> hidden_ids;
	for (const CompactMesh &mesh : tile->meshes) {
		for (std::size_t i = 0; i < mesh.size(); i += 5) {
			state.remove(mesh.id(i));
			hidden_ids.insert(mesh.id(i + 1 < mesh.size() ? i + 1 : i));
		}
	}
	for (int i = 0; i < 5; ++i) {
		std::uint64_t id = 0;
		REQUIRE(state.add(instance_at(i, 3.0 + i, 3), id).ok());
	}
	const Overlay overlay{&state, &hidden_ids};
	const Rect rect{{-20.0, 0.0}, {20.0, 40.0}};
	OverlaidMeshes expected;
	REQUIRE(overlaid(tile, rich_layer(), rect, overlay, expected).ok());
	const LayerSettings layer = rich_layer();
	OverlaidMeshes before;
	REQUIRE(overlaid(tile, layer, rect, {}, before).ok());
	fail_every_request(
			"tile", [&] { return before; },
			[&](OverlaidMeshes &meshes) { return overlaid(tile, layer, rect, overlay, meshes); },
			[&](const OverlaidMeshes &meshes) { REQUIRE(meshes == before); },
			[&](const OverlaidMeshes &meshes) {
				REQUIRE(meshes.size() == expected.size());
				for (std::size_t i = 0; i < meshes.size(); ++i) {
					REQUIRE(digest(*meshes[i]) == digest(*expected[i]));
				}
			});
}

TEST_CASE("out of memory: a near set returns all changes or none and keeps its instances") {
	std::vector<PlacedInstance> present;
	for (int i = 0; i < 40; ++i) {
		present.push_back({.id = static_cast<std::uint64_t>(i), .position = {i, 0.0, 0.0}});
	}
	const std::vector<glm::dvec3> centers{{20.0, 0.0, 0.0}};
	const auto prepared = [&] {
		NearSet set;
		for (std::size_t i = 0; i < 25; ++i) {
			REQUIRE(set.retain(present[i]));
		}
		return set;
	};
	NearChanges expected;
	NearSet twin = prepared();
	REQUIRE(twin.find_changes(centers, {8.0, 10.0}, present, expected));
	REQUIRE(!expected.enter.empty());
	REQUIRE(!expected.leave.empty());
	std::size_t failures = 0;
	for (std::size_t allowed = 0, done = 0; done == 0; ++allowed) {
		NearSet set = prepared();
		NearChanges changes;
		bool complete = false;
		bool is_held = false;
		{
			const AllocationLimit limit(allowed);
			complete = set.find_changes(centers, {8.0, 10.0}, present, changes);
			is_held = set.retain(present[30]);
			done = limit.reached() ? 0 : 1;
		}
		REQUIRE(set.holds(30) == is_held);
		REQUIRE(set.size() == (is_held ? 26 : 25));
		if (!complete) {
			++failures;
			REQUIRE(changes.enter.empty());
			REQUIRE(changes.leave.empty());
			set.release(30);
			REQUIRE(set.find_changes(centers, {8.0, 10.0}, present, changes));
		}
		REQUIRE(changes.enter.size() == expected.enter.size());
		REQUIRE(changes.leave == expected.leave);
		REQUIRE(changes.removed_count == expected.removed_count);
	}
	CHECK(failures > 3);
}
