// Tests that a diff has the same result if it is applied in one call or while the state stays in use.

#include "pending_diff_fixture.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

using namespace thicket;
using namespace thicket::test;

namespace {

/// The visible content of a state. After construction, only the state's reported changes update it.
class Mirror {
public:
	explicit Mirror(const InstanceState &state) {
		for (const std::uint64_t id : state.removed_ids()) {
			removed_[id] = true;
		}
		for (const std::uint64_t id : state.added_ids()) {
			added_[id] = *state.added(id);
		}
	}

	void follow(const InstanceChange &change) {
		switch (change.kind) {
			case InstanceChangeKind::removed:
				if (is_added(change.id)) {
					take(change);
				} else {
					CHECK(removed_.emplace(change.id, true).second);
				}
				break;
			case InstanceChangeKind::restored: CHECK(removed_.erase(change.id) == 1); break;
			case InstanceChangeKind::left: take(change); break;
			case InstanceChangeKind::added:
			case InstanceChangeKind::moved: CHECK(added_.emplace(change.id, change.added).second); break;
			case InstanceChangeKind::data: break;
		}
	}

	void follow(const StateChanges &changes) {
		for (std::size_t at = 0; at < changes.size(); ++at) {
			if (const InstanceChange *change = changes.at(at)) {
				follow(*change);
			}
		}
	}

	void check(const InstanceState &state) const {
		const Mirror now(state);
		CHECK(now.removed_ == removed_);
		CHECK(now.added_ == added_);
	}

private:
	void take(const InstanceChange &change) {
		REQUIRE(added_.contains(change.id));
		CHECK(added_.at(change.id) == change.added);
		added_.erase(change.id);
	}

	std::map<std::uint64_t, bool> removed_;
	std::map<std::uint64_t, AddedInstance> added_;
};

} // namespace

TEST_CASE("pending diffs: the result is the same as applying them when they are queued") {
	for (std::uint64_t seed = 1; seed <= 60; ++seed) {
		CAPTURE(seed);
		StateRandom random(seed);
		InstanceState at_once = some_state(seed, static_cast<int>(random() % 200));
		InstanceState later_state = copy_of(at_once);
		at_once = copy_of(at_once); // A copy as well, so that both have the same revision numbers.
		const std::vector<std::uint64_t> added_ids = later_state.added_ids();
		InstanceState other = copy_of(later_state);
		std::vector<StateBytes> diffs;
		for (std::size_t i = 0; i < 1 + seed % 3; ++i) {
			const std::uint64_t revision = other.revision();
			change_at_random(other, random, 80);
			diffs.push_back(seed % 5 == 0 ? bytes_of(other) : diff_of(other, revision));
		}
		std::vector<Calls> later_calls;
		for (const StateBytes &diff : diffs) {
			Changes changes;
			REQUIRE(at_once.apply(diff, changes).ok());
			queue(later_state, diff);
			later_calls.push_back(some_calls(random, added_ids, 40));
			run_calls(later_calls.back(), at_once);
			run_calls(later_calls.back(), later_state);
		}
		for (std::size_t i = 0; i < diffs.size(); ++i) {
			Mirror mirror(later_state);
			StateChanges changes;
			finish(later_state, changes);
			mirror.follow(changes);
			mirror.check(later_state);
		}
		CHECK(later_state.pending_diff() == nullptr);
		CHECK(bytes_of(later_state) == bytes_of(at_once));
		// Data that the bytes do not contain must be correct as well.
		for (const int layer : {0, 16000, 32000}) {
			std::vector<std::uint64_t> layer_ids;
			REQUIRE(later_state.added_in(static_cast<std::uint16_t>(layer), {{-1e9, -1e9}, {1e9, 1e9}}, layer_ids)
							.ok());
			CHECK(layer_ids == later_state.added_ids(layer));
		}
		Changes remaining;
		Changes right;
		REQUIRE(later_state.advance(1000.0, remaining).ok());
		REQUIRE(at_once.advance(1000.0, right).ok());
		CHECK(remaining.size() == right.size());
		CHECK(bytes_of(later_state) == bytes_of(at_once));
	}
}

TEST_CASE("pending diffs: nothing is visible before a diff is finished") {
	InstanceState state = some_state(3, 100);
	const StateBytes before = bytes_of(state);
	InstanceState other = copy_of(state);
	StateRandom random(4);
	change_at_random(other, random, 200);
	const std::uint64_t revision = state.revision();
	const StateBytes diff = diff_of(other, 0);
	queue(state, diff);
	state.pending_diff()->work();
	CHECK(bytes_of(state) == before);
	CHECK(state.revision() == revision);
	CHECK(diff_of(state, revision) == diff_of(copy_of(state), copy_of(state).revision()));
}

TEST_CASE("pending diffs: moved instances keep their IDs, even if a diff uses the same ones") {
	InstanceState state;
	const std::uint64_t oak = added_to(state, instance_at(1.0, 2.0));
	const std::uint64_t point = point_id(1, 3, 3);
	REQUIRE(state.set_data(oak, StateBytes{7}).ok());
	InstanceState other = copy_of(state);
	other.remove(oak);
	other.remove(point, 50.0);
	REQUIRE(other.set_data(point, StateBytes{9}).ok());
	const StateBytes diff = diff_of(other, 0);
	queue(state, diff);
	Changes changes;
	std::uint64_t moved_id = 0;
	std::uint64_t moved_point = 0;
	REQUIRE(state.move(oak, instance_at(5.0, 6.0), moved_id, changes).ok());
	REQUIRE(state.move(point, instance_at(9.0, 9.0), moved_point, changes).ok());
	Mirror mirror(state);
	StateChanges reported;
	finish(state, reported);
	mirror.follow(reported);
	mirror.check(state);
	CHECK(moved_id == oak);
	REQUIRE(state.added(oak) != nullptr);
	CHECK(*state.added(oak) == instance_at(5.0, 6.0));
	REQUIRE(state.added(moved_point) != nullptr);
	CHECK(state.removed(point));
	CHECK(state.data(moved_point).size() == 1); // The data comes from the diff.
}

TEST_CASE("pending diffs: peers that request changes get all changes, for any last known revision") {
	InstanceState state = some_state(5, 150);
	InstanceState other = copy_of(state);
	StateRandom random(6);
	std::vector<std::pair<std::uint64_t, InstanceState>> peers;
	const auto add_peer = [&] {
		peers.emplace_back(state.revision(), copy_of(state));
	};
	add_peer();
	for (int round = 0; round < 3; ++round) {
		const std::uint64_t revision = other.revision();
		change_at_random(other, random, 60);
		const StateBytes diff = diff_of(other, revision);
		queue(state, diff);
		add_peer();
		run_calls(some_calls(random, {}, 30), state);
		add_peer();
		StateChanges changes;
		finish(state, changes);
		add_peer();
		change_at_random(state, random, 5);
	}
	for (auto &[known, peer] : peers) {
		Changes changes;
		REQUIRE(peer.apply(diff_of(state, known), changes).ok());
		CHECK(peer.digest() == state.digest());
	}
}

TEST_CASE("pending diffs: very many changes are recorded, but no more than the limit") {
	constexpr int change_count = 70000;
	const auto removals = [](int first) {
		InstanceState state;
		for (int i = 0; i < change_count; ++i) {
			state.remove(point_id(1, first + i, 0));
		}
		return diff_of(state, 0);
	};
	InstanceState state;
	for (int i = 0; i < 100; ++i) {
		state.remove(point_id(2, i, 0));
	}
	const std::uint64_t early = state.revision();
	const InstanceState early_peer = copy_of(state);
	for (int round = 0; round < 6; ++round) {
		const StateBytes diff = removals(round % 2 == 0 ? 0 : 1000);
		queue(state, diff);
		state.remove(point_id(3, round, 0));
		StateChanges changes;
		finish(state, changes);
		CHECK(changes.size() == (round == 0 ? change_count : round == 1 ? 1000 : 0));
	}
	CHECK(state.removed_count() == change_count + 1000 + 100 + 6);
	InstanceState peer = copy_of(early_peer);
	Changes changes;
	const StateBytes diff = diff_of(state, early);
	CHECK(diff[8] == 1); // The diff is not a complete state.
	REQUIRE(peer.apply(diff, changes).ok());
	CHECK(changes.size() == change_count + 1000 + 6);
	CHECK(peer.digest() == state.digest());
}
