// Diffs that are applied beside the state that they are for: the same comes of them as if they had been applied at once.

#include "core/state/pending_diff.hpp"
#include "short_of_memory.hpp"
#include "state_fixture.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <thread>
#include <utility>

using namespace thicket;

namespace {

using Changes = std::vector<InstanceChange>;
using Calls = std::vector<std::function<void(InstanceState &)>>;

constexpr std::uint16_t layer_count = 3;

/// What is seen of a state, kept up to date by nothing but what it tells.
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

std::uint64_t near_point(StateRandom &random) {
	const auto near = [&random] {
		return static_cast<int>(random() % 12) - 6;
	};
	return point_id(static_cast<std::uint16_t>(random() % layer_count * 16000), near(), near());
}

/// Calls that depend on nothing that a state says, about few ids, of which `placed` are hand-placed.
Calls some_calls(StateRandom &random, const std::vector<std::uint64_t> &placed, int count) {
	Calls calls;
	for (int i = 0; i < count; ++i) {
		const std::uint64_t any =
				random() % 4 == 0 && !placed.empty() ? placed[random() % placed.size()] : near_point(random);
		const double number = static_cast<double>(random() % 60);
		switch (random() % 6) {
			case 0: calls.emplace_back([=](InstanceState &r_state) { r_state.remove(any, number); }); break;
			case 1: calls.emplace_back([=](InstanceState &r_state) { r_state.remove(any); }); break;
			case 2: calls.emplace_back([=](InstanceState &r_state) { r_state.restore(any); }); break;
			case 3:
				calls.emplace_back([point = near_point(random), bytes = StateBytes(random() % 3, 7)](
										   InstanceState &r_state) { REQUIRE(r_state.set_data(point, bytes).ok()); });
				break;
			case 4:
				calls.emplace_back([=, at = static_cast<double>(random() % 1000000)](InstanceState &r_state) {
					added_to(r_state, instance_at(at, number, 16000));
				});
				break;
			default:
				calls.emplace_back([=](InstanceState &r_state) {
					Changes changes;
					REQUIRE(r_state.advance(number / 9.0, changes).ok());
				});
		}
	}
	return calls;
}

/// Does calls, and has a mirror follow.
void make(const Calls &calls, InstanceState &r_state) {
	for (const auto &call : calls) {
		call(r_state);
	}
}

void finish(InstanceState &r_state, StateChanges &r_changes) {
	REQUIRE(r_state.pending_diff() != nullptr);
	r_state.pending_diff()->work();
	REQUIRE(r_state.finish_pending_diff(r_changes).ok());
}

InstanceState some_state(std::uint64_t seed, int changes) {
	StateRandom random(seed);
	InstanceState state;
	disturb(state, random, changes);
	return state;
}

/// The bytes stay until it is finished.
void queue(InstanceState &r_state, const StateBytes &&diff) = delete;
void queue(InstanceState &r_state, const StateBytes &diff) {
	std::shared_ptr<PendingDiff> pending;
	REQUIRE(r_state.queue_diff(diff, pending).ok());
}

} // namespace

TEST_CASE("pending diffs: the same comes of them as if they had been applied when they were queued") {
	for (std::uint64_t seed = 1; seed <= 60; ++seed) {
		CAPTURE(seed);
		StateRandom random(seed);
		InstanceState at_once = some_state(seed, static_cast<int>(random() % 200));
		InstanceState later = copy_of(at_once);
		at_once = copy_of(at_once); // The same numbers of changes.
		const std::vector<std::uint64_t> placed = later.added_ids();
		InstanceState other = copy_of(later);
		std::vector<StateBytes> diffs;
		for (std::size_t i = 0; i < 1 + seed % 3; ++i) {
			const std::uint64_t revision = other.revision();
			disturb(other, random, 80);
			diffs.push_back(seed % 5 == 0 ? bytes_of(other) : diff_of(other, revision));
		}
		std::vector<Calls> between;
		for (const StateBytes &diff : diffs) {
			Changes changes;
			REQUIRE(at_once.apply(diff, changes).ok());
			queue(later, diff);
			between.push_back(some_calls(random, placed, 40));
			make(between.back(), at_once);
			make(between.back(), later);
		}
		for (std::size_t i = 0; i < diffs.size(); ++i) {
			Mirror mirror(later);
			StateChanges changes;
			finish(later, changes);
			mirror.follow(changes);
			mirror.check(later);
		}
		CHECK(later.pending_diff() == nullptr);
		CHECK(bytes_of(later) == bytes_of(at_once));
		// What makes no part of the bytes is right, too.
		for (const int layer : {0, 16000, 32000}) {
			std::vector<std::uint64_t> near;
			REQUIRE(later.added_in(static_cast<std::uint16_t>(layer), {{-1e9, -1e9}, {1e9, 1e9}}, near).ok());
			CHECK(near == later.added_ids(layer));
		}
		Changes left;
		Changes right;
		REQUIRE(later.advance(1000.0, left).ok());
		REQUIRE(at_once.advance(1000.0, right).ok());
		CHECK(left.size() == right.size());
		CHECK(bytes_of(later) == bytes_of(at_once));
	}
}

TEST_CASE("pending diffs: nothing of one is seen before it is finished") {
	InstanceState state = some_state(3, 100);
	const StateBytes before = bytes_of(state);
	InstanceState other = copy_of(state);
	StateRandom random(4);
	disturb(other, random, 200);
	const std::uint64_t revision = state.revision();
	const StateBytes diff = diff_of(other, 0);
	queue(state, diff);
	state.pending_diff()->work();
	CHECK(bytes_of(state) == before);
	CHECK(state.revision() == revision);
	CHECK(diff_of(state, revision) == diff_of(copy_of(state), copy_of(state).revision()));
}

TEST_CASE("pending diffs: moved instances keep the ids that they were given, also where a diff has taken them") {
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
	std::uint64_t moved = 0;
	std::uint64_t moved_point = 0;
	REQUIRE(state.move(oak, instance_at(5.0, 6.0), moved, changes).ok());
	REQUIRE(state.move(point, instance_at(9.0, 9.0), moved_point, changes).ok());
	Mirror mirror(state);
	StateChanges told;
	finish(state, told);
	mirror.follow(told);
	mirror.check(state);
	CHECK(moved == oak);
	REQUIRE(state.added(oak) != nullptr);
	CHECK(*state.added(oak) == instance_at(5.0, 6.0));
	REQUIRE(state.added(moved_point) != nullptr);
	CHECK(state.removed(point));
	CHECK(state.data(moved_point).size() == 1); // As the diff has it.
}

TEST_CASE("pending diffs: peers that ask for what is new get all of it, whenever they asked last") {
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
		disturb(other, random, 60);
		const StateBytes diff = diff_of(other, revision);
		queue(state, diff);
		add_peer();
		make(some_calls(random, {}, 30), state);
		add_peer();
		StateChanges changes;
		finish(state, changes);
		add_peer();
		disturb(state, random, 5);
	}
	for (auto &[known, peer] : peers) {
		Changes changes;
		REQUIRE(peer.apply(diff_of(state, known), changes).ok());
		CHECK(peer.digest() == state.digest());
	}
}

TEST_CASE("pending diffs: very many changes are remembered, and no more than are held") {
	constexpr int many = 70000;
	const auto removals = [](int first) {
		InstanceState state;
		for (int i = 0; i < many; ++i) {
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
		CHECK(changes.size() == (round == 0 ? many : round == 1 ? 1000 : 0));
	}
	CHECK(state.removed_count() == many + 1000 + 100 + 6);
	InstanceState peer = copy_of(early_peer);
	Changes changes;
	const StateBytes diff = diff_of(state, early);
	CHECK(diff[8] == 1); // Not a whole state.
	REQUIRE(peer.apply(diff, changes).ok());
	CHECK(changes.size() == many + 1000 + 6);
	CHECK(peer.digest() == state.digest());
}

TEST_CASE("pending diffs: a bad one changes nothing, and those behind it go on") {
	InstanceState state = some_state(7, 120);
	InstanceState at_once = copy_of(state);
	InstanceState other = copy_of(state);
	StateRandom random(8);
	const std::vector<std::uint64_t> placed = state.added_ids();
	disturb(other, random, 90);
	const StateBytes good = diff_of(other, 0);
	StateBytes bad = good;
	bad[bad.size() / 2] ^= 1;
	const StateBytes newer = [&] {
		disturb(other, random, 90);
		return diff_of(other, 0);
	}();
	const StateBytes *const in_order[] = {&bad, &good, &bad, &newer};
	for (const StateBytes *diff : in_order) {
		queue(state, *diff);
		Changes changes;
		CHECK(at_once.apply(*diff, changes).ok() == (diff != &bad));
		const Calls calls = some_calls(random, placed, 30);
		make(calls, state);
		make(calls, at_once);
	}
	for (const bool is_good : {false, true, false, true}) {
		const StateBytes before = bytes_of(state);
		state.pending_diff()->work();
		StateChanges changes;
		const Status status = state.finish_pending_diff(changes);
		CHECK(status.ok() == is_good);
		if (!is_good) {
			CHECK(status.code == ErrorCode::corrupt);
			CHECK(changes.size() == 0);
			CHECK(bytes_of(state) == before);
		}
	}
	CHECK(bytes_of(state) == bytes_of(at_once));
}

TEST_CASE("pending diffs: one of other points is refused, also if a node has claimed the layer since") {
	InstanceState other;
	REQUIRE(other.claim(1, 77).ok());
	other.remove(point_id(1, 0, 0));
	const StateBytes diff = diff_of(other, 0);
	for (const bool before : {true, false}) {
		CAPTURE(before);
		InstanceState state;
		if (before) {
			REQUIRE(state.claim(1, 78).ok());
		}
		queue(state, diff);
		REQUIRE(state.claim(1, 78).ok());
		state.pending_diff()->work();
		StateChanges changes;
		const Status status = state.finish_pending_diff(changes);
		CHECK(status.code == ErrorCode::foreign);
		CHECK(state.removed_count() == 0);
		CHECK(state.stamp(1) == 78);
	}
	InstanceState state;
	queue(state, diff);
	REQUIRE(state.claim(1, 77).ok());
	StateChanges changes;
	finish(state, changes);
	CHECK(state.is_foreign(1, 78));
	CHECK(state.removed_count() == 1);
}

TEST_CASE("pending diffs: the state changes while another thread is at work") {
	InstanceState other;
	StateRandom random(10);
	disturb(other, random, 3000);
	for (int i = 0; i < 20000; ++i) {
		other.remove(point_id(16000, i % 150, i / 150), i % 3 == 0 ? 100.0 : 0.0);
	}
	const StateBytes diff = diff_of(other, 0);
	InstanceState state = some_state(11, 3000);
	InstanceState at_once = copy_of(state);
	const std::vector<std::uint64_t> placed = state.added_ids();
	for (int round = 0; round < 4; ++round) {
		queue(state, diff);
		Changes changes;
		REQUIRE(at_once.apply(diff, changes).ok());
		std::jthread thread([pending = state.pending_diff()] { pending->work(); });
		const Calls calls = some_calls(random, placed, 2000);
		make(calls, state);
		thread.join();
		make(calls, at_once);
		StateChanges told;
		REQUIRE(state.finish_pending_diff(told).ok());
		CHECK(bytes_of(state) == bytes_of(at_once));
	}
}

TEST_CASE("pending diffs: one that is cancelled ends soon and does nothing") {
	InstanceState state = some_state(12, 100);
	const StateBytes before = bytes_of(state);
	const StateBytes diff = bytes_of(some_state(13, 400));
	queue(state, diff);
	state.pending_diff()->cancel();
	state.pending_diff()->work();
	StateChanges changes;
	CHECK(state.finish_pending_diff(changes).code == ErrorCode::cancelled);
	CHECK(bytes_of(state) == before);
	// A state may go while a thread is at work.
	auto gone = std::make_unique<InstanceState>(copy_of(state));
	queue(*gone, diff);
	const std::shared_ptr<PendingDiff> pending = gone->pending_diff();
	std::jthread thread([pending] { pending->work(); });
	pending->cancel();
	gone.reset();
}

TEST_CASE("out of memory: a pending diff is taken over wholly or not at all") {
	for (const std::uint64_t seed : {14u, 15u}) {
		StateRandom random(seed);
		const InstanceState before = some_state(seed, 120);
		const std::vector<std::uint64_t> placed = before.added_ids();
		const StateBytes diff = bytes_of(some_state(seed + 10, 60));
		const Calls calls = some_calls(random, placed, 12);
		InstanceState at_once = copy_of(before);
		Changes changes;
		REQUIRE(at_once.apply(diff, changes).ok());
		make(calls, at_once);
		InstanceState unchanged = copy_of(before);
		make(calls, unchanged);
		const auto run = [](InstanceState &r_state) {
			StateChanges told;
			return r_state.finish_pending_diff(told);
		};
		const auto prepare = [&] {
			InstanceState state = copy_of(before);
			queue(state, diff);
			make(calls, state);
			state.pending_diff()->work();
			return state;
		};
		test::fail_every_request(
				"data", prepare, run,
				[&](InstanceState &r_state) {
					REQUIRE(r_state.pending_diff() == nullptr);
					REQUIRE(bytes_of(r_state) == bytes_of(unchanged));
					r_state = prepare(); // It is asked again.
				},
				[&](const InstanceState &state) { REQUIRE(bytes_of(state) == bytes_of(at_once)); });
		// So is one that cannot be queued, or worked on.
		test::fail_every_request(
				"data", [&] { return copy_of(before); },
				[&](InstanceState &r_state) {
					std::shared_ptr<PendingDiff> pending;
					if (const Status status = r_state.queue_diff(diff, pending); !status.ok()) {
						return status;
					}
					pending->work();
					return run(r_state);
				},
				[&](const InstanceState &state) {
					REQUIRE(state.pending_diff() == nullptr);
					REQUIRE(bytes_of(state) == bytes_of(before));
				},
				[](const InstanceState &) {});
	}
}

TEST_CASE("out of memory: a call while a diff is pending happens or does not") {
	const InstanceState before = some_state(16, 60);
	const StateBytes diff = bytes_of(some_state(17, 60));
	StateRandom random(18);
	const std::uint64_t point = point_id(9, 1, 1);
	const std::span diff_start(diff.data(), 2);
	const std::vector<std::pair<std::string, std::function<Status(InstanceState &)>>> calls{
			{"id", [=](InstanceState &r_state) { return r_state.remove(point, 5.0).status; }},
			{"instance",
					[](InstanceState &r_state) {
						std::uint64_t id = 0;
						return r_state.add(instance_at(70.0, 80.0, 5), id);
					}},
			{"instance",
					[=](InstanceState &r_state) {
						Changes changes;
						std::uint64_t id = 0;
						return r_state.move(point, instance_at(70.0, 80.0, 9), id, changes);
					}},
			{"data", [=](InstanceState &r_state) { return r_state.set_data(point, diff_start); }},
			{"seconds",
					[](InstanceState &r_state) {
						Changes changes;
						return r_state.advance(1000.0, changes);
					}},
	};
	for (const auto &[asked_for, call] : calls) {
		InstanceState called = copy_of(before);
		REQUIRE(call(called).ok());
		InstanceState at_once = copy_of(before);
		Changes changes;
		REQUIRE(at_once.apply(diff, changes).ok());
		REQUIRE(call(at_once).ok());
		test::fail_every_request(
				asked_for,
				[&] {
					InstanceState state = copy_of(before);
					queue(state, diff);
					return state;
				},
				call, [&](const InstanceState &state) { REQUIRE(bytes_of(state) == bytes_of(before)); },
				[&](InstanceState &r_state) {
					REQUIRE(bytes_of(r_state) == bytes_of(called));
					StateChanges told;
					finish(r_state, told);
					REQUIRE(bytes_of(r_state) == bytes_of(at_once));
				});
	}
}
