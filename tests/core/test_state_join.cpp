// Tests that states without an authority converge when they are joined, even if messages are
// reordered, lost and repeated.

#include "pending_diff_fixture.hpp"

#include <algorithm>
#include <array>

using namespace thicket;
using namespace thicket::test;

namespace {

const DiffLimits any_clock = [] {
	DiffLimits limits;
	limits.max_clock_advance = max_state_time;
	return limits;
}();

void join(InstanceState &r_state, const StateBytes &bytes) {
	Changes changes;
	REQUIRE(r_state.merge_diff(bytes, changes, any_clock).ok());
}

InstanceState joined(const InstanceState &first, const InstanceState &right) {
	InstanceState result = copy_of(first);
	Changes changes;
	REQUIRE(result.merge(right, changes).ok());
	return result;
}

/// Returns a state whose clock is at `time`.
InstanceState state_at(double time) {
	InstanceState state;
	Changes changes;
	REQUIRE(state.advance(time, changes).ok());
	return state;
}

void set(InstanceState &r_state, std::uint64_t id, StateBytes data) { REQUIRE(r_state.set_data(id, data).ok()); }

} // namespace

TEST_CASE("state join: both directions have equal bytes") {
	StateRandom random(41);
	for (int round = 0; round < 200; ++round) {
		const InstanceState a = some_state(random(), 60);
		const InstanceState b = some_state(random(), 60);
		CHECK(joined(a, b).digest() == joined(b, a).digest());
		CHECK(bytes_of(joined(a, b)) == bytes_of(joined(b, a)));
		InstanceState by_bytes = copy_of(a);
		join(by_bytes, bytes_of(b));
		CHECK(bytes_of(by_bytes) == bytes_of(joined(a, b)));
	}
}

TEST_CASE("state join: data written later wins, or the greater bytes if the times are equal") {
	const std::uint64_t id = point_id(1, 2, 3);
	InstanceState early_state = state_at(10.0);
	InstanceState late_state = state_at(20.0);
	set(early_state, id, {9, 9});
	set(late_state, id, {1});
	CHECK(joined(early_state, late_state).data(id).size() == 1);
	CHECK(joined(late_state, early_state).data(id).size() == 1);
	InstanceState same_state = state_at(20.0);
	set(same_state, id, {1, 0});
	CHECK(joined(same_state, late_state).data(id).size() == 2);
	CHECK(joined(late_state, same_state).data(id).size() == 2);
	// A write that replaces known data is treated as later, even if the writer's clock is behind.
	InstanceState delayed = joined(state_at(5.0), early_state);
	set(delayed, id, {3});
	CHECK(joined(early_state, delayed).data(id)[0] == 3);
	// Writing the same data again does not count as a new write.
	Changes changes;
	REQUIRE(early_state.advance(90.0, changes).ok());
	set(early_state, id, {9, 9});
	CHECK(joined(early_state, late_state).data(id).size() == 1);
}

TEST_CASE("state join: of two positions of an instance, the later one wins") {
	InstanceState a = state_at(1.0);
	const std::uint64_t id = added_to(a, instance_at(1.0, 2.0));
	InstanceState b = copy_of(a);
	Changes changes;
	std::uint64_t moved_id = 0;
	REQUIRE(b.advance(5.0, changes).ok());
	REQUIRE(b.move(id, instance_at(50.0, 2.0), moved_id, changes).ok());
	REQUIRE(a.advance(9.0, changes).ok());
	REQUIRE(a.move(id, instance_at(7.0, 2.0), moved_id, changes).ok());
	CHECK(joined(a, b).added(id)->position.x == 7.0);
	CHECK(joined(b, a).added(id)->position.x == 7.0);
	// At equal times, the position with the larger x wins.
	InstanceState c = copy_of(b);
	REQUIRE(c.move(id, instance_at(60.0, 2.0), moved_id, changes).ok());
	InstanceState d = copy_of(b);
	REQUIRE(d.move(id, instance_at(-60.0, 2.0), moved_id, changes).ok());
	CHECK(joined(c, d).added(id)->position.x == 60.0);
	CHECK(joined(d, c).added(id)->position.x == 60.0);
}

TEST_CASE("state join: a peer that still has a change restores it after another peer has reverted it") {
	InstanceState a;
	const std::uint64_t point = point_id(1, 4, 4);
	a.remove(point);
	const std::uint64_t oak = added_to(a, instance_at(1.0, 2.0));
	set(a, point, {1});
	InstanceState b = copy_of(a);
	const std::uint64_t known_revision = b.revision();
	b.restore(point);
	b.remove(oak);
	set(b, point, {});
	join(a, diff_of(b, known_revision));
	CHECK(a.removed(point));
	CHECK(a.added(oak) != nullptr);
	CHECK(a.data(point).size() == 1);
	join(b, bytes_of(a));
	CHECK(bytes_of(a) == bytes_of(b));
}

TEST_CASE("state join: instances that are due by the later clock are restored") {
	const std::uint64_t id = point_id(1, 4, 4);
	InstanceState a = state_at(10.0);
	a.remove(id, 20.0);
	const InstanceState b = state_at(30.0);
	CHECK_FALSE(joined(a, b).removed(id));
	CHECK_FALSE(joined(b, a).removed(id));
	Changes changes;
	InstanceState newer = copy_of(a);
	REQUIRE(newer.merge(b, changes).ok());
	REQUIRE(changes.size() == 1);
	CHECK(changes[0].kind == InstanceChangeKind::restored);
	// A diff advances the clock only up to the limit.
	InstanceState bounded = copy_of(a);
	DiffLimits limits;
	limits.max_clock_advance = 5.0;
	REQUIRE(bounded.merge_diff(bytes_of(b), changes, limits).ok());
	CHECK(bounded.time() == 15.0);
	CHECK(bounded.removed(id));
}

TEST_CASE("state join: four editing peers converge over a channel that reorders, loses and repeats") {
	StateRandom random(42);
	for (int run = 0; run < 20; ++run) {
		std::array<InstanceState, 4> peers;
		std::array<std::array<std::uint64_t, 4>, 4> sent{};
		std::array<std::vector<StateBytes>, 4> boxes;
		for (int round = 0; round < 500; ++round) {
			const std::size_t from = random() % peers.size();
			const std::size_t target = random() % peers.size();
			change_at_random(peers[from], random, 1 + static_cast<int>(random() % 2));
			const StateBytes diff = diff_of(peers[from], sent[from][target]);
			sent[from][target] = peers[from].revision();
			for (auto copies = random() % 5; copies < 4; copies += 3) { // Sends no copy, one, or two.
				boxes[target].push_back(diff);
			}
			std::vector<StateBytes> &box = boxes[random() % boxes.size()];
			if (!box.empty()) {
				const std::size_t any = random() % box.size();
				join(peers[static_cast<std::size_t>(&box - boxes.data())], box[any]);
				box.erase(box.begin() + static_cast<std::ptrdiff_t>(any));
			}
		}
		for (int round = 0; round < 2; ++round) {
			for (const InstanceState &from : peers) {
				const StateBytes all = bytes_of(from);
				for (InstanceState &target : peers) {
					join(target, all);
				}
			}
		}
		for (const InstanceState &peer : peers) {
			REQUIRE(peer.digest() == peers[0].digest());
			REQUIRE(bytes_of(peer) == bytes_of(peers[0]));
		}
	}
}
