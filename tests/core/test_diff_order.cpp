// Tests that the diffs of a state with an origin are applied in order, even if they arrive out of
// order.

#include "core/state/diff_limits.hpp"
#include "core/state/known_revisions.hpp"
#include "pending_diff_fixture.hpp"

#include <array>
#include <string>
#include <utility>

using namespace thicket;
using namespace thicket::test;

namespace {

constexpr std::uint64_t owner_name = 77;

/// An owner that has removed three instances, and one diff per removal.
struct ThreeRemovals {
	InstanceState owner;
	std::vector<StateBytes> diffs;

	ThreeRemovals() {
		owner.set_origin(owner_name);
		for (int x = 0; x < 3; ++x) {
			const std::uint64_t known_revision = owner.revision();
			owner.remove(point_id(1, x, 0));
			diffs.push_back(diff_of(owner, known_revision));
		}
	}
};

/// Delivers messages out of order. Some are lost, and some are duplicated.
class Channel {
public:
	explicit Channel(StateRandom &random) : random_(random) {}

	void send(const StateBytes &message) {
		for (auto copies = random_() % 5; copies < 4; copies += 3) { // Sends no copy, one, or two.
			messages_.push_back(message);
		}
	}

	bool take(StateBytes &r_message) {
		if (messages_.empty()) {
			return false;
		}
		std::swap(messages_[random_() % messages_.size()], messages_.back());
		r_message = std::move(messages_.back());
		messages_.pop_back();
		return true;
	}

private:
	StateRandom &random_;
	std::vector<StateBytes> messages_;
};

struct Receiver {
	InstanceState state;
	std::uint64_t sent = 0; ///< The owner has sent all changes up to this revision.
};

/// Applies a message. Returns true if an earlier one is missing. `r_since` is then the revision
/// from which to request a diff.
bool receive(InstanceState &r_state, const StateBytes &message, std::uint64_t &r_since) {
	Changes changes;
	const std::uint64_t before = r_state.revision();
	const Status status = r_state.apply(message, changes);
	bool missing = false;
	if (status.ok()) {
		return false;
	}
	REQUIRE(status.code == ErrorCode::out_of_order);
	REQUIRE(r_state.revision() == before);
	REQUIRE(changes.empty());
	REQUIRE(r_state.missing_before(message, missing, r_since).ok());
	REQUIRE(missing);
	return true;
}

} // namespace

TEST_CASE("diff order: repeated and late diffs have no effect") {
	const ThreeRemovals three;
	InstanceState peer;
	Changes changes;
	REQUIRE(peer.apply(three.diffs[0], changes).ok());
	REQUIRE(peer.apply(three.diffs[1], changes).ok());
	CHECK(peer.known_revision(owner_name) == 2);
	peer.restore(point_id(1, 0, 0));
	const StateBytes before = bytes_of(peer);
	const std::uint64_t revision = peer.revision();
	changes.clear();
	for (const std::size_t late : {0U, 1U}) {
		bool missing = true;
		std::uint64_t base_revision = 0;
		REQUIRE(peer.missing_before(three.diffs[late], missing, base_revision).ok());
		CHECK_FALSE(missing);
		CHECK(peer.apply(three.diffs[late], changes).ok());
	}
	CHECK(changes.empty());
	CHECK(peer.revision() == revision);
	CHECK(bytes_of(peer) == before);
}

TEST_CASE("diff order: a diff after a lost one is rejected, and the error names the missing revision") {
	ThreeRemovals three;
	InstanceState peer;
	Changes changes;
	REQUIRE(peer.apply(three.diffs[0], changes).ok());
	changes.clear();
	const Status status = peer.apply(three.diffs[2], changes);
	CHECK(status.code == ErrorCode::out_of_order);
	CHECK(describe(status).starts_with(
			"base_revision must be at most 1 (the last revision received from its sender), got 2. Request"));
	CHECK(changes.empty());
	CHECK(peer.removed_count() == 1);
	bool missing = false;
	std::uint64_t base_revision = 0;
	REQUIRE(peer.missing_before(three.diffs[2], missing, base_revision).ok());
	CHECK(missing);
	CHECK(base_revision == 1);
	REQUIRE(peer.apply(diff_of(three.owner, base_revision), changes).ok());
	CHECK(peer.digest() == three.owner.digest());
	CHECK(peer.known_revision(owner_name) == 3);
}

TEST_CASE("diff order: a diff that starts before the known revision is applied") {
	const ThreeRemovals three;
	InstanceState peer;
	Changes changes;
	REQUIRE(peer.apply(three.diffs[0], changes).ok());
	REQUIRE(peer.apply(diff_of(three.owner, 0), changes).ok());
	CHECK(peer.digest() == three.owner.digest());
}

TEST_CASE("diff order: undo steps, saved changes and diffs of unnamed states have no order") {
	ThreeRemovals three;
	InstanceState peer;
	Changes changes;
	StateBytes bytes;
	const std::uint64_t ids[] = {point_id(1, 2, 0)};
	REQUIRE(three.owner.diff_of(ids, bytes).ok());
	REQUIRE(peer.apply(bytes, changes).ok());
	CHECK(peer.removed(ids[0]));
	REQUIRE(three.owner.diff_since(1, bytes, false).ok());
	REQUIRE(peer.apply(bytes, changes).ok());
	CHECK(peer.removed_count() == 2);
	CHECK(peer.known_revision(owner_name) == 0);
}

TEST_CASE("diff order: a loaded, cleared or replaced state needs a complete diff") {
	const ThreeRemovals three;
	const StateBytes saved_bytes = bytes_of(three.owner);
	const auto is_forgotten = [&](auto forget) {
		InstanceState peer;
		Changes changes;
		REQUIRE(peer.apply(three.diffs[0], changes).ok());
		forget(peer, changes);
		return peer.known_revision(owner_name) == 0 &&
				peer.apply(three.diffs[1], changes).code == ErrorCode::out_of_order;
	};
	CHECK(is_forgotten(
			[&](InstanceState &r_peer, Changes &r_changes) { CHECK(r_peer.load(saved_bytes, r_changes).ok()); }));
	CHECK(is_forgotten(
			[&](InstanceState &r_peer, Changes &r_changes) { CHECK(r_peer.apply(saved_bytes, r_changes).ok()); }));
	CHECK(is_forgotten([&](InstanceState &r_peer, Changes &r_changes) { CHECK(r_peer.clear(r_changes).ok()); }));
	// A complete diff replaces all earlier diffs.
	InstanceState owner;
	owner.set_origin(owner_name);
	Changes changes;
	REQUIRE(owner.load(saved_bytes, changes).ok());
	InstanceState peer;
	REQUIRE(peer.apply(diff_of(owner, 0), changes).ok());
	CHECK(peer.known_revision(owner_name) == owner.revision());
}

TEST_CASE("diff order: diffs that another thread applies are also ordered") {
	const ThreeRemovals three;
	InstanceState peer;
	queue(peer, three.diffs[0]);
	queue(peer, three.diffs[1]);
	StateChanges changes;
	finish(peer, changes);
	finish(peer, changes);
	CHECK(peer.known_revision(owner_name) == 2);
	queue(peer, three.diffs[0]);
	peer.restore(point_id(1, 0, 0));
	finish(peer, changes);
	CHECK(peer.removed_count() == 1);
	InstanceState other;
	queue(other, three.diffs[1]);
	other.pending_diff()->work();
	CHECK(other.finish_pending_diff(changes).code == ErrorCode::out_of_order);
}

TEST_CASE("diff order: unknown senders take a bounded amount of memory") {
	KnownRevisions known_revisions;
	for (std::uint64_t name = 1; name <= 1000; ++name) {
		known_revisions.reserve_entry();
		known_revisions.set(name, name + 5);
		known_revisions.set(1, 6); // A sender that sends repeatedly is not forgotten.
	}
	CHECK(known_revisions.of(1000) == 1005);
	CHECK(known_revisions.of(1) == 6);
	CHECK(known_revisions.of(1000 - KnownRevisions::capacity) == 0);
}

TEST_CASE("diff order: receivers converge over a channel that reorders, loses and repeats") {
	StateRandom random(31);
	int requests = 0;
	for (int run = 0; run < 20; ++run) {
		InstanceState owner;
		owner.set_origin(owner_name);
		std::array<Receiver, 3> receivers;
		std::vector<Channel> channels(receivers.size(), Channel(random));
		for (int round = 0; round < 500; ++round) {
			change_at_random(owner, random, 1 + static_cast<int>(random() % 3));
			if (random() % 200 == 0) {
				Changes changes;
				REQUIRE(owner.load(bytes_of(owner), changes).ok());
			}
			for (std::size_t i = 0; i < receivers.size(); ++i) {
				if (random() % 2 == 0) {
					channels[i].send(diff_of(owner, receivers[i].sent));
					receivers[i].sent = owner.revision();
				}
				StateBytes message;
				std::uint64_t base_revision = 0;
				if (random() % 3 != 0 && channels[i].take(message) &&
						receive(receivers[i].state, message, base_revision)) {
					channels[i].send(diff_of(owner, base_revision));
					++requests;
				}
			}
		}
		for (Receiver &receiver : receivers) {
			Changes changes;
			REQUIRE(receiver.state.apply(diff_of(owner, receiver.state.known_revision(owner_name)), changes).ok());
			REQUIRE(receiver.state.digest() == owner.digest());
		}
	}
	CHECK(requests > 1000);
}
