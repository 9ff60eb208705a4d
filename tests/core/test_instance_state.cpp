// Tests how a state records removed instances, their regrowth times, and data.

#include "state_fixture.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <set>

using namespace thicket;

namespace {

using Changes = std::vector<InstanceChange>;

constexpr double infinite = std::numeric_limits<double>::infinity();

Changes advanced(InstanceState &r_state, double seconds) {
	Changes changes;
	REQUIRE(r_state.advance(seconds, changes).ok());
	return changes;
}

StateBytes data_of(const InstanceState &state, std::uint64_t id) {
	const auto bytes = state.data(id);
	return {bytes.begin(), bytes.end()};
}

} // namespace

TEST_CASE("state: a removed instance stays removed until it is restored") {
	InstanceState state;
	const std::uint64_t id = point_id(7, -3, 12);
	CHECK_FALSE(state.removed(id));
	CHECK_FALSE(state.restore(id));
	CHECK(state.revision() == 0);
	CHECK(state.remove(id));
	CHECK(state.removed(id));
	CHECK_FALSE(state.remove(id));
	CHECK(state.revision() == 1);
	CHECK_FALSE(state.removed(point_id(7, -3, 13)));
	CHECK_FALSE(state.removed(point_id(8, -3, 12)));
	CHECK(state.any_removed(7));
	CHECK_FALSE(state.any_removed(8));
	CHECK(state.restore(id));
	CHECK_FALSE(state.removed(id));
	CHECK_FALSE(state.any_removed(7));
	CHECK(state.revision() == 2);
	CHECK_FALSE(state.remove(std::uint64_t{1} << 63));
	CHECK(state.removed_count() == 0);
}

TEST_CASE("state: the set of removed IDs equals a plain set") {
	StateRandom random(1);
	InstanceState state;
	std::set<std::uint64_t> expected;
	for (int round = 0; round < 60000; ++round) {
		// The set grows, shrinks, and grows again.
		const bool grow = round / 20000 % 2 == 0 ? random() % 4 != 0 : random() % 4 == 0;
		const std::uint64_t id = point_id(static_cast<std::uint16_t>(random() % 2), static_cast<int>(random() % 100),
				static_cast<int>(random() % 100));
		REQUIRE(state.removed(id) == expected.contains(id));
		REQUIRE((
				grow ? state.remove(id) == expected.insert(id).second : state.restore(id) == (expected.erase(id) > 0)));
	}
	CHECK(state.removed_count() == expected.size());
	CHECK(state.removed_ids() == std::vector<std::uint64_t>(expected.begin(), expected.end()));
	const auto first_of_1 = expected.lower_bound(std::uint64_t{1} << 48);
	CHECK(state.removed_ids(0) == std::vector<std::uint64_t>(expected.begin(), first_of_1));
	CHECK(state.removed_ids(1) == std::vector<std::uint64_t>(first_of_1, expected.end()));
	CHECK(state.removed_ids(2).empty());
}

TEST_CASE("state: removed generated instances keep their data, and removing a hand-placed one deletes its data") {
	InstanceState state;
	const std::uint64_t point = point_id(1, 5, 5);
	const std::uint64_t added_id = added_to(state, instance_at(1.0, 1.0));
	const StateBytes apples{3, 1, 4};
	REQUIRE(state.set_data(point, apples).ok());
	REQUIRE(state.set_data(added_id, apples).ok());
	CHECK(data_of(state, point) == apples);
	CHECK(state.data_ids() == std::vector<std::uint64_t>{point, added_id});
	Changes changes;
	REQUIRE(InstanceState().load(bytes_of(state), changes).ok());
	REQUIRE(changes.size() == 3);
	for (const InstanceChange &change : changes) { // Only the change of a hand-placed instance contains the instance.
		CHECK(change.added == (change.id == added_id ? *state.added(added_id) : AddedInstance()));
	}
	const std::uint64_t revision = state.revision();
	REQUIRE(state.set_data(point, apples).ok());
	CHECK(state.revision() == revision);
	state.remove(point);
	state.remove(added_id);
	CHECK(data_of(state, point) == apples);
	CHECK(state.data(added_id).empty());
	CHECK(state.data_count() == 1);
	CHECK(state.set_data(added_id, apples).code == ErrorCode::missing);
	CHECK(state.set_data(point, StateBytes(max_instance_data + 1)).code == ErrorCode::wrong_size);
	CHECK(data_of(state, point) == apples);
	REQUIRE(state.set_data(point, StateBytes(max_instance_data)).ok());
	REQUIRE(state.set_data(point, {}).ok());
	CHECK(state.data_count() == 0);
}

TEST_CASE("state: an instance that is removed for a limited time is restored when the time is over") {
	InstanceState state;
	const std::uint64_t oak = point_id(1, 0, 0);
	const std::uint64_t fern = point_id(2, 0, 0);
	const std::uint64_t rock = point_id(3, 0, 0);
	state.remove(oak, 10.0);
	state.remove(fern, 5.0);
	state.remove(rock);
	REQUIRE(state.set_data(fern, StateBytes{1}).ok());
	CHECK(advanced(state, 4.5).empty());
	for (const double nothing : {0.0, -3.0, std::nan("")}) {
		CHECK(advanced(state, nothing).empty());
	}
	CHECK(state.time() == 4.5);
	// Removing an instance again changes its regrowth time.
	const std::uint64_t revision = state.revision();
	CHECK_FALSE(state.remove(oak, 20.0));
	CHECK(state.revision() > revision);
	const Changes first = advanced(state, 10.5);
	REQUIRE(first.size() == 1);
	CHECK(first[0].id == fern);
	CHECK(first[0].kind == InstanceChangeKind::restored);
	CHECK(state.data(fern).size() == 1);
	CHECK(state.removed(oak));
	InstanceState loaded = copy_of(state);
	CHECK(loaded.time() == 15.0);
	for (InstanceState *each_state : {&state, &loaded}) {
		CHECK(advanced(*each_state, 5.0).size() == 1);
		CHECK_FALSE(each_state->removed(oak));
		CHECK(each_state->removed(rock));
		CHECK(advanced(*each_state, infinite).empty());
		CHECK(each_state->time() == max_state_time);
	}
}

TEST_CASE("state: a forest that is cut repeatedly regrows in the order of its regrowth times") {
	StateRandom random(4);
	InstanceState state;
	std::map<std::uint64_t, double> end_times;
	for (int round = 0; round < 400; ++round) {
		for (int i = 0; i < 50; ++i) {
			const std::uint64_t id = point_id(1, static_cast<int>(random() % 40), 0);
			const double time = random() % 5 == 0 ? 0.0 : state.time() + 1.0 + static_cast<double>(random() % 30);
			if (random() % 4 == 0) {
				state.restore(id);
				end_times.erase(id);
			} else {
				state.remove(id, time);
				end_times[id] = time;
			}
		}
		std::set<std::uint64_t> expired;
		for (const auto &[id, time] : end_times) {
			if (time > 0.0 && time <= state.time() + 1.0) {
				expired.insert(id);
			}
		}
		const Changes changes = advanced(state, 1.0);
		REQUIRE(changes.size() == expired.size());
		for (const InstanceChange &change : changes) {
			REQUIRE(expired.contains(change.id));
			end_times.erase(change.id);
		}
		REQUIRE(state.removed_count() == end_times.size());
	}
}

TEST_CASE("state: clearing reports every change and forgets the previous content") {
	InstanceState state;
	REQUIRE(state.claim(1, 77).ok());
	state.remove(point_id(1, 2, 3));
	const std::uint64_t added_id = added_to(state, instance_at(1.0, 2.0));
	REQUIRE(state.set_data(point_id(2, 0, 0), StateBytes{1}).ok());
	REQUIRE(state.set_data(added_id, StateBytes{2}).ok());
	const std::uint64_t revision = state.revision();
	Changes changes = advanced(state, 3.0);
	REQUIRE(state.clear(changes).ok());
	REQUIRE(changes.size() == 3);
	CHECK(changes[0].kind == InstanceChangeKind::restored);
	CHECK(changes[1].kind == InstanceChangeKind::data);
	CHECK(changes[2].kind == InstanceChangeKind::removed);
	CHECK(changes[2].added == instance_at(1.0, 2.0));
	CHECK(state.digest() == InstanceState().digest());
	CHECK(bytes_of(state) == bytes_of(InstanceState()));
	CHECK(state.revision() > revision);
	CHECK(state.stamp(1) == 77);
	CHECK(diff_of(state, revision) == bytes_of(state));
}

TEST_CASE("state: layers keep their point sets") {
	const PointSet oaks{.seed = 5, .radius = 4.0, .levels = 2, .layer = 1};
	CHECK(stamp_of(oaks) == stamp_of({.seed = 5, .radius = 4.0, .levels = 2, .layer = 9}));
	CHECK(stamp_of(oaks) != stamp_of({.seed = 6, .radius = 4.0, .levels = 2}));
	CHECK(stamp_of(oaks) != stamp_of({.seed = 5, .radius = 4.5, .levels = 2}));
	CHECK(stamp_of(oaks) != stamp_of({.seed = 5, .radius = 4.0, .levels = 3}));

	InstanceState state;
	REQUIRE(state.claim(1, 10).ok());
	REQUIRE(state.claim(1, 20).ok()); // The state contains no IDs yet, so the stamp may change.
	state.remove(point_id(1, 0, 0));
	CHECK(state.claim(1, 20).ok());
	const Status status = state.claim(1, 30);
	CHECK(status.code == ErrorCode::foreign);
	CHECK(describe(status).starts_with("layer 1 belongs to a different"));
	CHECK(state.claim(32768, 1).code == ErrorCode::out_of_range);
	CHECK(state.stamp(1) == 20);
	CHECK(copy_of(state).stamp(1) == 20);

	InstanceState foreign;
	REQUIRE(foreign.claim(1, 30).ok());
	foreign.remove(point_id(1, 4, 4));
	Changes changes;
	const StateBytes before = bytes_of(state);
	CHECK(state.load(bytes_of(foreign), changes).code == ErrorCode::foreign);
	CHECK(state.apply(diff_of(foreign, 0), changes).code == ErrorCode::foreign);
	CHECK(state.merge(foreign, changes).code == ErrorCode::foreign);
	CHECK(changes.empty());
	CHECK(bytes_of(state) == before);
	// Without claims, a state loads any other state, but merges only states of the same point sets.
	state.release_claims();
	CHECK(state.merge(foreign, changes).code == ErrorCode::foreign);
	CHECK(state.load(bytes_of(foreign), changes).ok());
	CHECK(state.stamp(1) == 30);
	CHECK(state.removed_ids() == foreign.removed_ids());
	// After loading a state without claims, the state has none.
	InstanceState unknown;
	unknown.remove(point_id(1, 0, 0));
	CHECK(state.load(bytes_of(unknown), changes).ok());
	CHECK(bytes_of(state) == bytes_of(unknown));
}

TEST_CASE("state: a diff of IDs undoes every change to them, bit for bit") {
	StateRandom random(11);
	for (int trial = 0; trial < 300; ++trial) {
		InstanceState state;
		change_at_random(state, random, 20);
		REQUIRE(state.claim(1, 7).ok());
		const StateBytes before = bytes_of(state);
		std::vector<std::uint64_t> ids = state.added_ids();
		const std::vector<std::uint64_t> removed = state.removed_ids();
		ids.insert(ids.end(), removed.begin(), removed.end());
		ids.insert(ids.end(), 2, point_id(1, 50, 50));
		ids.push_back(~std::uint64_t{0});
		StateBytes diff;
		REQUIRE(state.diff_of(ids, diff).ok());
		Changes changes;
		std::uint64_t id = 0;
		REQUIRE(state.set_data(point_id(1, 50, 50), StateBytes{3}).ok());
		for (const std::uint64_t target_id : ids) {
			if (random() % 2 != 0) {
				state.remove(target_id);
				state.restore(target_id);
			} else if (is_added(target_id)) {
				static_cast<void>(state.move(target_id, instance_at(1e4, 1e4, layer_of(target_id)), id, changes));
			}
		}
		REQUIRE(state.apply(diff, changes).ok());
		REQUIRE(bytes_of(state) == before);
	}
}
