// Tests the exchange between states: diffs and merges.

#include "state_fixture.hpp"

#include <algorithm>
#include <map>

using namespace thicket;

namespace {

using Changes = std::vector<InstanceChange>;

/// The content of a state, reconstructed from the changes that the state reports.
struct Reported {
	std::map<std::uint64_t, bool> removed;
	std::map<std::uint64_t, AddedInstance> added;

	/// Applies changes and checks that each of them has an effect.
	void follow(const Changes &changes) {
		for (const InstanceChange &change : changes) {
			const bool is_placed = is_added(change.id);
			switch (change.kind) {
				case InstanceChangeKind::removed:
					if (is_placed) {
						REQUIRE(added.at(change.id) == change.added);
						added.erase(change.id);
					} else {
						REQUIRE(removed.emplace(change.id, true).second);
					}
					break;
				case InstanceChangeKind::restored: REQUIRE(removed.erase(change.id) == 1); break;
				case InstanceChangeKind::added:
					REQUIRE(is_placed);
					REQUIRE(added.emplace(change.id, change.added).second);
					break;
				case InstanceChangeKind::left: REQUIRE(added.at(change.id) == change.added); break;
				case InstanceChangeKind::moved:
					REQUIRE(added.contains(change.id));
					added[change.id] = change.added;
					break;
				case InstanceChangeKind::data: break;
			}
		}
	}

	void check(const InstanceState &state) const {
		REQUIRE(state.removed_count() == removed.size());
		for (const auto &[id, is_removed] : removed) {
			REQUIRE(state.removed(id));
		}
		REQUIRE(state.added_count() == added.size());
		for (const auto &[id, instance] : added) {
			REQUIRE(*state.added(id) == instance);
		}
	}
};

InstanceState state_of(StateRandom &random, int changes) {
	InstanceState state;
	change_at_random(state, random, changes);
	return state;
}

InstanceState merged(const InstanceState &left, const InstanceState &right) {
	InstanceState result = copy_of(left);
	Changes changes;
	REQUIRE(result.merge(right, changes).ok());
	return result;
}

} // namespace

TEST_CASE("state exchange: a peer that receives the diffs has the same content") {
	StateRandom random(21);
	for (int round = 0; round < 100; ++round) {
		InstanceState server;
		std::vector<std::pair<std::uint64_t, InstanceState>> peers;
		InstanceState follower;
		Reported reported;
		std::uint64_t known_revision = 0;
		for (int step = 0; step < 12; ++step) {
			peers.emplace_back(server.revision(), copy_of(server));
			change_at_random(server, random, static_cast<int>(random() % 20));
			Changes changes;
			REQUIRE(follower.apply(diff_of(server, known_revision), changes).ok());
			known_revision = server.revision();
			reported.follow(changes);
			reported.check(follower);
			REQUIRE(follower.digest() == server.digest());
			REQUIRE(follower.time() == server.time());
		}
		for (auto &[revision, peer] : peers) {
			Changes changes;
			const StateBytes diff = diff_of(server, revision);
			REQUIRE(peer.apply(diff, changes).ok());
			REQUIRE(bytes_of(peer) == bytes_of(server));
			const std::uint64_t after = peer.revision();
			changes.clear();
			REQUIRE(peer.apply(diff, changes).ok());
			REQUIRE(changes.empty());
			REQUIRE(peer.revision() == after);
		}
	}
}

TEST_CASE("state exchange: a diff contains only the changed IDs") {
	InstanceState server;
	server.remove(point_id(1, 0, 0));
	const std::uint64_t known_revision = server.revision();
	server.remove(point_id(1, 1, 0));
	server.restore(point_id(1, 0, 0));
	InstanceState peer;
	peer.remove(point_id(1, 0, 0));
	peer.remove(point_id(1, 9, 9));
	Changes changes;
	REQUIRE(peer.apply(diff_of(server, known_revision), changes).ok());
	CHECK(peer.removed_ids() == std::vector<std::uint64_t>{point_id(1, 1, 0), point_id(1, 9, 9)});
	CHECK(changes.size() == 2);
	const StateBytes nothing = diff_of(server, server.revision());
	CHECK(nothing.size() < 64);
	CHECK(peer.apply(nothing, changes).ok());
	CHECK(changes.size() == 2);
}

TEST_CASE("state exchange: a request for a forgotten revision returns everything") {
	StateRandom random(22);
	InstanceState server = state_of(random, 100);
	const std::uint64_t old = server.revision();
	Changes changes;
	REQUIRE(server.load(bytes_of(state_of(random, 100)), changes).ok());
	change_at_random(server, random, 20);
	for (const std::uint64_t revision : {std::uint64_t{0}, old, server.revision() + 1}) {
		InstanceState peer = state_of(random, 100);
		Reported reported;
		InstanceState empty;
		Changes from_nothing;
		REQUIRE(empty.apply(bytes_of(peer), from_nothing).ok());
		reported.follow(from_nothing);
		Changes reported_now;
		REQUIRE(peer.apply(diff_of(server, revision), reported_now).ok());
		reported.follow(reported_now);
		reported.check(peer);
		CHECK(peer.digest() == server.digest());
	}
}

TEST_CASE("state exchange: the history of added and removed instances is bounded") {
	InstanceState server;
	for (int i = 0; i < 300000; ++i) {
		server.remove(point_id(1, i, 0));
		server.restore(point_id(1, i, 0));
	}
	server.remove(point_id(1, 5, 5));
	InstanceState peer;
	peer.remove(point_id(1, 0, 0));
	const StateBytes all = diff_of(server, 1);
	CHECK(all == bytes_of(server));
	const StateBytes recent_diff = diff_of(server, server.revision() - 60000);
	CHECK(recent_diff != all);
	Changes changes;
	REQUIRE(peer.apply(all, changes).ok());
	CHECK(peer.digest() == server.digest());
}

TEST_CASE("state exchange: a damaged diff is rejected and has no effect") {
	StateRandom random(23);
	InstanceState server = state_of(random, 60);
	const StateBytes diff = diff_of(server, 10);
	const InstanceState peer = state_of(random, 60);
	const StateBytes before = bytes_of(peer);
	InstanceState receiver = copy_of(peer);
	Changes changes;
	for (std::size_t at = 0; at < diff.size(); ++at) {
		StateBytes bytes = diff;
		bytes[at] ^= static_cast<std::uint8_t>(1 + random() % 255);
		REQUIRE_FALSE(receiver.apply(bytes, changes).ok());
		bytes.resize(at);
		REQUIRE_FALSE(receiver.apply(bytes, changes).ok());
	}
	CHECK(changes.empty());
	CHECK(bytes_of(receiver) == before);
}

TEST_CASE("state exchange: a merged state has the content of both") {
	StateRandom random(24);
	for (int round = 0; round < 60; ++round) {
		InstanceState a = state_of(random, 60);
		InstanceState b = state_of(random, 60);
		Changes until_then; // With equal clocks, nothing regrows during the merge.
		REQUIRE(a.advance(b.time() - a.time(), until_then).ok());
		REQUIRE(b.advance(a.time() - b.time(), until_then).ok());
		InstanceState joined = copy_of(a);
		Reported reported;
		Changes changes;
		InstanceState empty;
		REQUIRE(empty.apply(bytes_of(a), changes).ok());
		REQUIRE(joined.merge(b, changes).ok());
		reported.follow(changes);
		reported.check(joined);
		for (const std::uint64_t id : joined.removed_ids()) {
			REQUIRE((a.removed(id) || b.removed(id)));
		}
		for (const InstanceState *peer : {&a, &b}) {
			REQUIRE(std::ranges::all_of(peer->removed_ids(), [&](std::uint64_t id) { return joined.removed(id); }));
			REQUIRE(std::ranges::all_of(
					peer->added_ids(), [&](std::uint64_t id) { return joined.added(id) != nullptr; }));
		}
		for (const std::uint64_t id : joined.added_ids()) {
			const auto is_there = [&](const InstanceState &peer) {
				return peer.added(id) != nullptr && *peer.added(id) == *joined.added(id);
			};
			REQUIRE((is_there(a) || is_there(b)));
		}
		for (const std::uint64_t id : joined.data_ids()) {
			REQUIRE((std::ranges::equal(joined.data(id), a.data(id)) ||
					std::ranges::equal(joined.data(id), b.data(id))));
		}
		CHECK(joined.time() == std::max(a.time(), b.time()));
	}
}

TEST_CASE("state exchange: merging is commutative, associative and idempotent") {
	StateRandom random(25);
	for (int round = 0; round < 40; ++round) {
		const InstanceState a = state_of(random, 50);
		const InstanceState b = state_of(random, 50);
		const InstanceState c = state_of(random, 50);
		InstanceState merged_again = merged(a, b);
		Changes changes;
		REQUIRE(merged_again.merge(b, changes).ok());
		REQUIRE(merged_again.merge(merged_again, changes).ok());
		CHECK(changes.empty());
		CHECK(bytes_of(merged_again) == bytes_of(merged(a, b)));
		CHECK(bytes_of(merged(merged(a, b), c)) == bytes_of(merged(a, merged(b, c))));
		CHECK(bytes_of(merged(a, b)) == bytes_of(merged(b, a)));
	}
}

TEST_CASE("state exchange: of two removals of an instance, the longer one applies") {
	const std::uint64_t id = point_id(1, 2, 3);
	const auto removed_until = [id](double end_time) {
		InstanceState state;
		state.remove(id, end_time);
		return state;
	};
	const InstanceState joined = merged(removed_until(10.0), removed_until(20.0));
	CHECK(joined.digest() == removed_until(20.0).digest());
	CHECK(merged(removed_until(20.0), removed_until(10.0)).digest() == joined.digest());
	CHECK(merged(joined, removed_until(0.0)).digest() == removed_until(0.0).digest());
	CHECK(merged(removed_until(0.0), joined).digest() == removed_until(0.0).digest());
}
