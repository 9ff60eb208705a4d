// Tests the limits that a receiver sets on the changes of a diff, and the summary that it reads
// before applying one.

#include "allocation_count.hpp"
#include "core/state/diff_summary.hpp"
#include "core/state/state_format.hpp"
#include "pending_diff_fixture.hpp"

#include <bit>
#include <string>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Returns a diff of few bytes that removes `count` points with consecutive codes. `clock` is the
/// sender's clock. The points belong to layer 0, which has no stamp.
StateBytes diff_with_count(std::uint32_t count, std::uint32_t format, double clock = 0.0) {
	StateBytes bytes{'T', 'S', 'T', 'A'};
	append(bytes, format);
	bytes.push_back(1);
	append(bytes, std::bit_cast<std::uint64_t>(clock));
	const std::size_t list = (6ULL * ((count + 127ULL) / 128) + count + 7) / 8;
	if (format == former_state_format) {
		bytes.resize(bytes.size() + 2 + 2 + 8);
		append(bytes, count);
		bytes.resize(bytes.size() + list + 5 * 4ULL);
	} else {
		bytes.push_back(1);
		bytes.resize(bytes.size() + 1 + 8);
		for (std::uint32_t remaining = count; remaining > 0; remaining >>= 7) {
			bytes.push_back(static_cast<std::uint8_t>(remaining | (remaining >= 0x80 ? 0x80 : 0)));
		}
		bytes.resize(bytes.size() + 5 + list);
	}
	bytes.resize(bytes.size() + 8);
	return with_checksum(bytes);
}

/// Checks that the limits reject a diff when it is applied, merged and queued. The message must
/// start with `words`, and the state must not change.
void check_refused(
		const InstanceState &state, const StateBytes &diff, const DiffLimits &limits, const std::string &words) {
	InstanceState target_state = copy_of(state);
	REQUIRE(target_state.claim(1, 7, 10.0).ok());
	const StateBytes before = bytes_of(target_state);
	const std::uint64_t revision = target_state.revision();
	Changes changes;
	const Status status = target_state.apply(diff, changes, limits);
	CHECK(status.code == ErrorCode::not_allowed);
	CHECK(describe(status).starts_with(words));
	if (limits.allow_replacement) {
		CHECK(target_state.merge_diff(diff, changes, limits).code == ErrorCode::not_allowed);
	}
	CHECK(changes.empty());
	std::shared_ptr<PendingDiff> pending;
	REQUIRE(target_state.queue_diff(diff, pending, limits).ok());
	pending->work();
	StateChanges reported;
	CHECK(target_state.finish_pending_diff(reported).code == ErrorCode::not_allowed);
	CHECK(reported.size() == 0);
	CHECK(bytes_of(target_state) == before);
	CHECK(target_state.revision() == revision);
}

bool is_applied(const InstanceState &state, const StateBytes &diff, const DiffLimits &limits) {
	InstanceState applied_to = copy_of(state);
	REQUIRE(applied_to.claim(1, 7, 10.0).ok());
	InstanceState joined_state = copy_of(applied_to);
	REQUIRE(joined_state.claim(1, 7, 10.0).ok());
	Changes changes;
	const bool applied = applied_to.apply(diff, changes, limits).ok();
	CHECK(joined_state.merge_diff(diff, changes, limits).ok() == applied);
	return applied;
}

StateBytes diff_of_removals(int count, int x = 0) {
	InstanceState state;
	for (int i = 0; i < count; ++i) {
		state.remove(point_id(1, x, i));
	}
	return diff_of(state, 0);
}

} // namespace

TEST_CASE("diff limits: a diff with huge counts is rejected before any ID is read") {
	for (const std::uint32_t format : {former_state_format, state_format}) {
		CAPTURE(format);
		const StateBytes diff = diff_with_count(8'000'000, format);
		CHECK(diff.size() < 1'100'000);
		InstanceState state;
		Changes changes;
		const std::size_t before = allocation_count();
		const Status status = state.apply(diff, changes);
		CHECK(allocation_count() - before < 10);
		CHECK(status.code == ErrorCode::not_allowed);
		CHECK(describe(status) ==
				"changes must be at most 2097152 (max_changes of diff_limits), got 8000000. Reject the diff, or "
				"relax that limit in diff_limits");
		CHECK(state.merge_diff(diff, changes).code == ErrorCode::not_allowed);
		CHECK(state.revision() == 0);
		// The smaller diff is valid.
		REQUIRE(state.apply(diff_with_count(3000, format), changes).ok());
		CHECK(state.removed_count() == 3000);
		DiffLimits limits;
		limits.max_changes = 2999;
		check_refused({}, diff_with_count(3000, format), limits,
				"changes must be at most 2999 (max_changes of diff_limits), got 3000");
	}
}

TEST_CASE("diff limits: every kind of ID is counted, and no list may exceed the limit") {
	InstanceState state;
	for (int i = 0; i < 3; ++i) {
		state.remove(point_id(1, i, 0));
		added_to(state, instance_at(i, 5.0));
	}
	state.restore(point_id(1, 0, 0));
	state.remove(state.added_ids().front());
	const StateBytes diff = diff_of(state, 0);
	DiffLimits limits;
	limits.max_changes = 6;
	CHECK(is_applied({}, diff, limits));
	limits.max_changes = 5;
	check_refused({}, diff, limits, "changes must be at most 5");
	StateRecord record;
	REQUIRE(read(diff, record).ok());
	StateBytes previous;
	write(record, previous, nullptr, former_state_format);
	check_refused({}, previous, limits, "changes must be at most 5");
}

TEST_CASE("diff limits: the total number of changes after a diff is limited") {
	InstanceState state;
	for (int i = 0; i < 10; ++i) {
		state.remove(point_id(1, 0, i));
	}
	DiffLimits limits;
	limits.max_total_changes = 12;
	CHECK(is_applied(state, diff_of_removals(12), limits)); // Ten of them have already been removed.
	check_refused(state, diff_of_removals(13), limits,
			"total changes must be at most 12 (max_total_changes of diff_limits), got 13");
	// A state that already exceeds the limit still accepts diffs that add no changes.
	limits.max_total_changes = 5;
	CHECK(is_applied(state, diff_of_removals(10), limits));
	check_refused(state, diff_of_removals(11), limits, "total changes must be at most 5");
	InstanceState placer;
	for (int i = 0; i < 4; ++i) {
		added_to(placer, instance_at(i, 5.0));
	}
	limits = {};
	limits.max_added = 4;
	CHECK(is_applied(state, diff_of(placer, 0), limits));
	limits.max_added = 3;
	check_refused(state, diff_of(placer, 0), limits,
			"hand-placed instances must be at most 3 (max_added of diff_limits), got 4");
}

TEST_CASE("diff limits: data that is too large is rejected") {
	InstanceState writer;
	REQUIRE(writer.set_data(point_id(1, 1, 1), StateBytes(100, 3)).ok());
	DiffLimits limits;
	limits.max_data_size = 100;
	CHECK(is_applied({}, diff_of(writer, 0), limits));
	limits.max_data_size = 99;
	check_refused({}, diff_of(writer, 0), limits, "data must be at most 99 (max_data_size of diff_limits), got 100");
}

TEST_CASE("diff limits: the area also applies to layers on surfaces, whose IDs divide a cell") {
	DiffLimits limits;
	limits.area = {{0.0, 0.0}, {100.0, 50.0}};
	const auto applies = [&](int x) {
		InstanceState applied_to;
		REQUIRE(applied_to.claim(1, 7, 1.0, 8).ok());
		Changes changes;
		return applied_to.apply(diff_of_removals(1, x), changes, limits).ok();
	};
	CHECK(applies(5));
	CHECK(applies(101)); // The cell of this point reaches from 96 to 104 m.
	CHECK_FALSE(applies(104));
	CHECK_FALSE(applies(-9));
	InstanceState queued;
	REQUIRE(queued.claim(1, 7, 1.0, 8).ok());
	const StateBytes diff = diff_of_removals(1, 101);
	std::shared_ptr<PendingDiff> pending;
	REQUIRE(queued.queue_diff(diff, pending, limits).ok());
	REQUIRE(queued.claim(1, 7, 1.0, 8).ok()); // The claim is repeated on the copy.
	pending->work();
	StateChanges reported;
	CHECK(queued.finish_pending_diff(reported).ok());
}

TEST_CASE("diff limits: changes outside the permitted area are rejected") {
	DiffLimits limits;
	limits.area = {{0.0, 0.0}, {100.0, 50.0}}; // Cells are 10 m wide.
	CHECK(is_applied({}, diff_of_removals(5, 9), limits));
	check_refused({}, diff_of_removals(5, 11), limits, "x must be between 0 and 100 (area of diff_limits), got 115");
	check_refused({}, diff_of_removals(8, 1), limits, "z must be between 0 and 50 (area of diff_limits), got 65");
	InstanceState other_state;
	other_state.remove(point_id(2, 1, 1));
	check_refused({}, diff_of(other_state, 0), limits, "the position of points of a layer is missing. Assign");
	// The positions of hand-placed instances are known without cells. The limits forbid moving or
	// removing one that is outside the area.
	InstanceState sender;
	const std::uint64_t id = added_to(sender, instance_at(500.0, 10.0));
	check_refused({}, diff_of(sender, 0), limits, "x must be between 0 and 100 (area of diff_limits), got 500");
	InstanceState receiver = copy_of(sender);
	Changes changes;
	std::uint64_t moved_id = 0;
	const std::uint64_t known_revision = receiver.revision();
	REQUIRE(receiver.move(id, instance_at(50.0, 10.0), moved_id, changes).ok());
	CHECK(is_applied({}, diff_of(receiver, known_revision), limits));
	check_refused(sender, diff_of(receiver, known_revision), limits, "x must be between");
	receiver.remove(id);
	InstanceState holder = copy_of(sender);
	CHECK_FALSE(holder.apply(diff_of(receiver, known_revision), changes, limits).ok());
	CHECK(holder.merge_diff(diff_of(receiver, known_revision), changes, limits).ok() == false);
}

TEST_CASE("diff limits: replacing the whole state can be forbidden") {
	InstanceState state;
	state.remove(point_id(1, 1, 1));
	DiffLimits limits;
	limits.allow_replacement = false;
	check_refused(state, bytes_of(some_state(3, 20)), limits,
			"replaces_everything must be 0 (allow_replacement of diff_limits), got 1");
	// Merging replaces nothing, so this limit does not apply.
	Changes changes;
	REQUIRE(state.merge_diff(diff_of_removals(3), changes, limits).ok());
	InstanceState other;
	other.remove(point_id(1, 7, 7));
	REQUIRE(state.merge_diff(bytes_of(other), changes, limits).ok());
	CHECK(state.removed(point_id(1, 1, 1)));
	CHECK(state.removed(point_id(1, 7, 7)));
}

TEST_CASE("diff limits: a foreign clock moves this one within the limit and restores no instance early") {
	for (const std::uint32_t format : {former_state_format, state_format}) {
		const StateBytes poisoned = diff_with_count(0, format, 1e12);
		InstanceState state;
		state.remove(point_id(1, 1, 1), 100.0);
		Changes changes;
		DiffLimits limits;
		limits.max_clock_advance = 0.0;
		StateBytes diff = poisoned;
		if (format == state_format) {
			InstanceState sender;
			REQUIRE(sender.advance(1e12, changes).ok());
			diff = diff_of(sender, 0);
			CHECK(diff.size() < 51);
		} else {
			diff = diff_with_count(1, format, 1e12);
		}
		REQUIRE(state.apply(diff, changes, limits).ok());
		CHECK(state.time() == 0.0);
		REQUIRE(state.merge_diff(diff, changes, limits).ok());
		CHECK(state.time() == 0.0);
		REQUIRE(state.apply(diff, changes).ok());
		CHECK(state.time() == 60.0);
		REQUIRE(state.advance(1.0, changes).ok());
		CHECK(state.removed(point_id(1, 1, 1)));
		REQUIRE(state.advance(39.0, changes).ok());
		CHECK_FALSE(state.removed(point_id(1, 1, 1)));
		state.remove(point_id(1, 1, 1), 300.0);
		REQUIRE(state.advance(200.0, changes).ok());
		CHECK_FALSE(state.removed(point_id(1, 1, 1))); // The instance has regrown on time.
	}
	// A diff that replaces everything also sets the clock.
	InstanceState owner;
	Changes changes;
	REQUIRE(owner.advance(5.0, changes).ok());
	InstanceState follower;
	REQUIRE(follower.advance(900.0, changes).ok());
	REQUIRE(follower.apply(bytes_of(owner), changes).ok());
	CHECK(follower.time() == 5.0);
}

TEST_CASE("diff summary: a summary lists a diff's IDs by layer and area") {
	InstanceState sender;
	sender.set_origin(99);
	sender.remove(point_id(1, 3, 4));
	sender.remove(point_id(1, 5, 9));
	sender.remove(point_id(1, 0, 0));
	sender.restore(point_id(1, 0, 0));
	REQUIRE(sender.set_data(point_id(1, 3, 4), StateBytes(5, 1)).ok());
	added_to(sender, instance_at(-7.0, 8.0, 2));
	sender.remove(added_to(sender, instance_at(1.0, 8.0, 2)));
	sender.remove(point_id(3, 1, 1));
	Changes changes;
	REQUIRE(sender.advance(2.0, changes).ok());
	InstanceState receiver;
	REQUIRE(receiver.claim(1, 7, 10.0).ok());
	DiffSummary summary;
	REQUIRE(receiver.inspect(diff_of(sender, 0), summary).ok());
	CHECK_FALSE(summary.replaces_everything);
	CHECK(summary.origin == StateOrigin{99, 0, sender.revision()});
	CHECK(summary.time == 2.0);
	CHECK(summary.changes == 6);
	REQUIRE(summary.layers.size() == 3);
	const DiffSummary::Layer &oaks = summary.layers.at(1);
	CHECK(oaks.removed == 2);
	CHECK(oaks.present == 1);
	CHECK(oaks.with_data == 1);
	CHECK(oaks.data_bytes == 5);
	CHECK(oaks.bounds.min == glm::dvec2(0.0, 0.0));
	CHECK(oaks.bounds.max == glm::dvec2(60.0, 100.0));
	CHECK(oaks.has_all_bounds);
	const DiffSummary::Layer &placed_layer = summary.layers.at(2);
	CHECK(placed_layer.added == 1);
	CHECK(placed_layer.removed_placed == 1);
	CHECK(placed_layer.bounds.min == glm::dvec2(-7.0, 8.0));
	CHECK_FALSE(summary.layers.at(3).has_bounds);
	CHECK_FALSE(summary.layers.at(3).has_all_bounds);
	CHECK(receiver.revision() == 0);
	// If a diff exceeds the limits, only its header is read, which contains the number of changes.
	DiffLimits limits;
	limits.max_changes = 5;
	CHECK(receiver.inspect(diff_of(sender, 0), summary, limits).code == ErrorCode::not_allowed);
	CHECK(summary.changes == 6);
	CHECK(summary.layers.empty());
	REQUIRE(receiver.inspect(bytes_of(sender), summary).ok());
	CHECK(summary.replaces_everything);
	CHECK(receiver.inspect(StateBytes{1, 2, 3}, summary).code == ErrorCode::corrupt);
}
