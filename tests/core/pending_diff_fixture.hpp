// Random calls that change states, and helpers for pending diffs.

#pragma once

#include "core/state/pending_diff.hpp"
#include "state_fixture.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace thicket::test {

using Changes = std::vector<InstanceChange>;
using Calls = std::vector<std::function<void(InstanceState &)>>;

inline constexpr std::uint16_t layer_count = 3;

inline std::uint64_t near_point(StateRandom &random) {
	const auto near_coordinate = [&random] {
		return static_cast<int>(random() % 12) - 6;
	};
	return point_id(static_cast<std::uint16_t>(random() % layer_count * 16000), near_coordinate(), near_coordinate());
}

/// Returns random calls whose arguments do not depend on the state. They use few IDs. The IDs in
/// `placed` belong to hand-placed instances.
inline Calls some_calls(StateRandom &random, const std::vector<std::uint64_t> &added_ids, int count) {
	Calls calls;
	for (int i = 0; i < count; ++i) {
		const std::uint64_t any =
				random() % 4 == 0 && !added_ids.empty() ? added_ids[random() % added_ids.size()] : near_point(random);
		const double value = static_cast<double>(random() % 60);
		switch (random() % 6) {
			case 0: calls.emplace_back([=](InstanceState &r_state) { r_state.remove(any, value); }); break;
			case 1: calls.emplace_back([=](InstanceState &r_state) { r_state.remove(any); }); break;
			case 2: calls.emplace_back([=](InstanceState &r_state) { r_state.restore(any); }); break;
			case 3:
				calls.emplace_back([point = near_point(random), bytes = StateBytes(random() % 3, 7)](
										   InstanceState &r_state) { REQUIRE(r_state.set_data(point, bytes).ok()); });
				break;
			case 4:
				calls.emplace_back([=, at = static_cast<double>(random() % 1000000)](InstanceState &r_state) {
					added_to(r_state, instance_at(at, value, 16000));
				});
				break;
			default:
				calls.emplace_back([=](InstanceState &r_state) {
					Changes changes;
					REQUIRE(r_state.advance(value / 9.0, changes).ok());
				});
		}
	}
	return calls;
}

inline void run_calls(const Calls &calls, InstanceState &r_state) {
	for (const auto &call : calls) {
		call(r_state);
	}
}

inline void finish(InstanceState &r_state, StateChanges &r_changes) {
	REQUIRE(r_state.pending_diff() != nullptr);
	r_state.pending_diff()->work();
	REQUIRE(r_state.finish_pending_diff(r_changes).ok());
}

inline InstanceState some_state(std::uint64_t seed, int changes) {
	StateRandom random(seed);
	InstanceState state;
	change_at_random(state, random, changes);
	return state;
}

/// The bytes must outlive the pending diff, so the overload for temporaries is deleted.
inline void queue(InstanceState &r_state, const StateBytes &&diff) = delete;
inline void queue(InstanceState &r_state, const StateBytes &diff) {
	std::shared_ptr<PendingDiff> pending;
	REQUIRE(r_state.queue_diff(diff, pending).ok());
}

} // namespace thicket::test
