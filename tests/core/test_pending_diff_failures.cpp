// Tests pending diffs that are rejected, canceled or run out of memory, and changes to the state at
// the same time.

#include "pending_diff_fixture.hpp"
#include "short_of_memory.hpp"

#include <algorithm>
#include <memory>
#include <thread>
#include <utility>

using namespace thicket;
using namespace thicket::test;

TEST_CASE("pending diffs: an invalid diff has no effect, and later diffs proceed") {
	InstanceState state = some_state(7, 120);
	InstanceState at_once = copy_of(state);
	InstanceState other = copy_of(state);
	StateRandom random(8);
	const std::vector<std::uint64_t> added_ids = state.added_ids();
	change_at_random(other, random, 90);
	const StateBytes good = diff_of(other, 0);
	StateBytes bad = good;
	bad[bad.size() / 2] ^= 1;
	const StateBytes newer = [&] {
		change_at_random(other, random, 90);
		return diff_of(other, 0);
	}();
	const StateBytes *const in_order[] = {&bad, &good, &bad, &newer};
	for (const StateBytes *diff : in_order) {
		queue(state, *diff);
		Changes changes;
		CHECK(at_once.apply(*diff, changes).ok() == (diff != &bad));
		const Calls calls = some_calls(random, added_ids, 30);
		run_calls(calls, state);
		run_calls(calls, at_once);
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

TEST_CASE("pending diffs: a diff of a different point set is rejected, even if the layer was claimed later") {
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

TEST_CASE("pending diffs: the state changes while another thread works") {
	InstanceState other;
	StateRandom random(10);
	change_at_random(other, random, 3000);
	for (int i = 0; i < 20000; ++i) {
		other.remove(point_id(16000, i % 150, i / 150), i % 3 == 0 ? 100.0 : 0.0);
	}
	const StateBytes diff = diff_of(other, 0);
	InstanceState state = some_state(11, 3000);
	InstanceState at_once = copy_of(state);
	const std::vector<std::uint64_t> added_ids = state.added_ids();
	for (int round = 0; round < 4; ++round) {
		queue(state, diff);
		Changes changes;
		REQUIRE(at_once.apply(diff, changes).ok());
		std::jthread thread([pending = state.pending_diff()] { pending->work(); });
		const Calls calls = some_calls(random, added_ids, 2000);
		run_calls(calls, state);
		thread.join();
		run_calls(calls, at_once);
		StateChanges reported;
		REQUIRE(state.finish_pending_diff(reported).ok());
		CHECK(bytes_of(state) == bytes_of(at_once));
	}
}

TEST_CASE("pending diffs: a canceled diff ends soon and has no effect") {
	InstanceState state = some_state(12, 100);
	const StateBytes before = bytes_of(state);
	const StateBytes diff = bytes_of(some_state(13, 400));
	queue(state, diff);
	state.pending_diff()->cancel();
	state.pending_diff()->work();
	StateChanges changes;
	CHECK(state.finish_pending_diff(changes).code == ErrorCode::cancelled);
	CHECK(bytes_of(state) == before);
	// A state may be destroyed while a thread is working on its diff.
	auto destroyed = std::make_unique<InstanceState>(copy_of(state));
	queue(*destroyed, diff);
	const std::shared_ptr<PendingDiff> pending = destroyed->pending_diff();
	std::jthread thread([pending] { pending->work(); });
	pending->cancel();
	destroyed.reset();
}

TEST_CASE("out of memory: a pending diff is applied completely or not at all") {
	for (const std::uint64_t seed : {14u, 15u}) {
		StateRandom random(seed);
		const InstanceState before = some_state(seed, 120);
		const std::vector<std::uint64_t> added_ids = before.added_ids();
		const StateBytes diff = bytes_of(some_state(seed + 10, 60));
		const Calls calls = some_calls(random, added_ids, 12);
		InstanceState at_once = copy_of(before);
		Changes changes;
		REQUIRE(at_once.apply(diff, changes).ok());
		run_calls(calls, at_once);
		InstanceState unchanged = copy_of(before);
		run_calls(calls, unchanged);
		const auto run = [](InstanceState &r_state) {
			StateChanges reported;
			return r_state.finish_pending_diff(reported);
		};
		const auto prepare = [&] {
			InstanceState state = copy_of(before);
			queue(state, diff);
			run_calls(calls, state);
			state.pending_diff()->work();
			return state;
		};
		test::fail_every_request(
				"data", prepare, run,
				[&](InstanceState &r_state) {
					REQUIRE(r_state.pending_diff() == nullptr);
					REQUIRE(bytes_of(r_state) == bytes_of(unchanged));
					r_state = prepare(); // The job is repeated with a new state.
				},
				[&](const InstanceState &state) { REQUIRE(bytes_of(state) == bytes_of(at_once)); });
		// If queuing or applying a diff fails, the state does not change either.
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

TEST_CASE("out of memory: a call while a diff is pending is complete or has no effect") {
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
	for (const auto &[property, call] : calls) {
		InstanceState called = copy_of(before);
		REQUIRE(call(called).ok());
		InstanceState at_once = copy_of(before);
		Changes changes;
		REQUIRE(at_once.apply(diff, changes).ok());
		REQUIRE(call(at_once).ok());
		test::fail_every_request(
				property,
				[&] {
					InstanceState state = copy_of(before);
					queue(state, diff);
					return state;
				},
				call, [&](const InstanceState &state) { REQUIRE(bytes_of(state) == bytes_of(before)); },
				[&](InstanceState &r_state) {
					REQUIRE(bytes_of(r_state) == bytes_of(called));
					StateChanges reported;
					finish(r_state, reported);
					REQUIRE(bytes_of(r_state) == bytes_of(at_once));
				});
	}
}
