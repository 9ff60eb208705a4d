// Loads random bytes as a state or a diff, and makes random changes to a state. Each must either be
// rejected or leave a consistent state within the limits.

#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz_main.hpp"

#include "core/base/bytes.hpp"
#include "core/base/instance_id.hpp"
#include "core/state/diff_summary.hpp"
#include "core/state/instance_state.hpp"
#include "core/state/state_format.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace {

using namespace thicket;
using fuzz::Bytes;
using fuzz::require;

using Stored = std::vector<std::uint8_t>;
using Changes = std::vector<InstanceChange>;

Stored saved(const InstanceState &state) {
	Stored bytes;
	require(state.save(bytes).ok(), "a state is saved");
	return bytes;
}

Stored diff(const InstanceState &state, std::uint64_t revision) {
	Stored bytes;
	require(state.diff_since(revision, bytes).ok(), "a diff can be written");
	return bytes;
}

InstanceState copy_of(const InstanceState &state) {
	InstanceState copy;
	Changes changes;
	require(copy.load(saved(state), changes).ok() && saved(copy) == saved(state),
			"a loaded state equals the saved one");
	require(changes.size() >= state.removed_count() + state.added_count(), "loading reports every instance");
	return copy;
}

/// Returns one of few IDs in most cases, so that several calls often use the same ID.
std::uint64_t read_id(Bytes &r_bytes, const InstanceState &state) {
	if (r_bytes.chance(8)) {
		return r_bytes.raw<std::uint64_t>();
	}
	const std::vector<std::uint64_t> added = state.added_ids();
	if (!added.empty() && r_bytes.chance(3)) {
		return added[r_bytes.below(static_cast<std::uint32_t>(added.size()))];
	}
	const auto near_coordinate = [&r_bytes] {
		return static_cast<int>(r_bytes.below(8)) - 4;
	};
	InstanceId id{static_cast<std::uint16_t>(r_bytes.chance(4) ? max_state_layer : 1), {near_coordinate(), 0}};
	id.cell.y = near_coordinate();
	return pack(id);
}

AddedInstance read_instance(Bytes &r_bytes) {
	AddedInstance instance;
	instance.layer = static_cast<std::uint16_t>(r_bytes.chance(24) ? r_bytes.raw<std::uint16_t>() : r_bytes.below(3));
	instance.mesh = r_bytes.raw<std::uint8_t>();
	for (int axis = 0; axis < 3; ++axis) {
		instance.position[axis] = r_bytes.number(-200.0, 200.0);
	}
	instance.basis[1][2] = static_cast<float>(r_bytes.number(-2.0, 2.0));
	return instance;
}

void check_placed(const InstanceState &state, std::uint64_t id) {
	const AddedInstance *added = state.added(id);
	require(added != nullptr && is_added(id) && layer_of(id) == added->layer, "a placed instance exists");
	const glm::dvec2 position(added->position.x, added->position.z);
	std::vector<std::uint64_t> results;
	require(state.added_in(added->layer, {position - 1.0, position + 1.0}, results).ok(),
			"instances in an area can be listed");
	require(std::ranges::is_sorted(results) && std::ranges::binary_search(results, id),
			"an instance is found at its position");
}

void change(InstanceState &r_state, Bytes &r_bytes) {
	const std::uint64_t revision = r_state.revision();
	const std::uint64_t id = read_id(r_bytes, r_state);
	switch (r_bytes.below(6)) {
		case 0: {
			const bool was_removed = is_added(id) ? r_state.added(id) == nullptr : r_state.removed(id);
			require(r_state.remove(id, r_bytes.number(0.0, 50.0)) != was_removed,
					"the first removal of an instance succeeds");
			require(is_added(id) ? r_state.added(id) == nullptr : r_state.removed(id),
					"a removed instance stays removed");
			break;
		}
		case 1: {
			const bool was_removed = r_state.removed(id);
			require(r_state.restore(id) == was_removed && !r_state.removed(id), "a restored instance is not removed");
			break;
		}
		case 2: {
			std::uint64_t added_id = 0;
			const Status status = r_state.add(read_instance(r_bytes), added_id);
			if (status.ok()) {
				check_placed(r_state, added_id);
			} else {
				require(r_state.revision() == revision, "a rejected instance has no effect");
				require(describe(status).find(status.property) == 0, "an error names the property");
			}
			break;
		}
		case 3: {
			const Stored data(r_bytes.chance(16) ? max_instance_data + r_bytes.below(2) : r_bytes.below(4), 7);
			if (r_state.set_data(id, data).ok()) {
				require(std::ranges::equal(r_state.data(id), data), "the stored data are those that were set");
			}
			break;
		}
		case 4: static_cast<void>(r_state.claim(layer_of(id), r_bytes.below(3))); break;
		default: {
			Changes changes;
			const double time = r_state.time();
			require(r_state.advance(r_bytes.number(0.0, 20.0), changes).ok(), "the clock advances");
			require(r_state.time() >= time && r_state.time() <= max_state_time, "the clock never goes back");
		}
	}
	require(r_state.revision() >= revision, "revisions rise");
}

/// Damages stored bytes at a few positions. In most cases, the checksum is valid afterward.
void damage(Stored &r_stored, Bytes &r_bytes) {
	for (std::uint32_t changes = r_bytes.below(4); changes > 0 && !r_stored.empty(); --changes) {
		const auto size = static_cast<std::uint32_t>(r_stored.size());
		const std::uint32_t position = r_bytes.below(r_bytes.chance(2) ? size : std::min(size, 60U));
		switch (r_bytes.below(4)) {
			case 0: r_stored.resize(position); break;
			case 1:
				r_stored.insert(r_stored.begin() + position, 1 + r_bytes.below(20), r_bytes.raw<std::uint8_t>());
				break;
			case 2:
				r_stored.erase(r_stored.begin() + position, r_stored.begin() + std::min(size, position + 10));
				break;
			default: r_stored[position] = r_bytes.raw<std::uint8_t>(); break;
		}
	}
	if (r_stored.size() >= 8 && !r_bytes.chance(3)) {
		r_stored.resize(r_stored.size() - 8);
		append(r_stored, checksum(r_stored));
	}
}

/// Returns random limits, which many diffs satisfy, but not all.
DiffLimits read_limits(Bytes &r_bytes) {
	DiffLimits limits;
	if (r_bytes.chance(2)) {
		limits.max_changes = r_bytes.below(200);
		limits.max_total_changes = r_bytes.below(400);
		limits.max_added = r_bytes.below(100);
		limits.max_data_size = r_bytes.below(10);
		limits.allow_replacement = r_bytes.chance(2);
		limits.max_clock_advance = static_cast<double>(r_bytes.below(100));
	}
	if (r_bytes.chance(4)) {
		const double side = static_cast<double>(1 + r_bytes.below(300));
		limits.area = {{-side, -side}, {side, side}};
	}
	return limits;
}

/// Applies and merges a diff with limits. A rejected diff must change nothing. An accepted diff must
/// respect the limits, and applying it again must have no effect.
void feed_within(const InstanceState &state, const Stored &stored, const DiffLimits &limits) {
	for (const bool joining : {false, true}) {
		InstanceState fed = copy_of(state);
		const auto give = [&](Changes &r_changes) {
			return joining ? fed.merge_diff(stored, r_changes, limits) : fed.apply(stored, r_changes, limits);
		};
		Changes changes;
		DiffSummary summary;
		const bool is_readable = fed.inspect(stored, summary, limits).ok();
		if (!give(changes).ok()) {
			require(saved(fed) == saved(state) && changes.empty(), "a rejected diff has no effect");
			continue;
		}
		require(is_readable && summary.changes <= limits.max_changes, "an accepted diff can be inspected");
		require(fed.added_count() <= std::max<std::size_t>(limits.max_added, state.added_count()),
				"instances are placed up to the limit");
		require(joining || summary.replaces_everything || fed.time() <= state.time() + limits.max_clock_advance,
				"the clock advances up to the limit");
		const Stored after = saved(copy_of(fed));
		const double time = fed.time();
		changes.clear();
		require(give(changes).ok() && (changes.empty() || fed.time() > time), "a repeated diff has no effect");
		require(limits.max_clock_advance > 0.0 || saved(fed) == after, "a repeated diff leaves equal bytes");
	}
}

/// Loads the bytes into a state and applies them. Rejected bytes must change nothing. A state that
/// loads must be saved identically.
void feed(const InstanceState &state, const Stored &stored) {
	InstanceState fed = copy_of(state);
	Changes changes;
	StateHeader header;
	if (fed.load(stored, changes).ok()) {
		require(read_header(stored, header).ok() && header.is_complete, "accepted bytes have a header");
		const bool is_as_saved = header.format == state_format && header.origin.name == 0;
		require(!is_as_saved || saved(fed) == stored, "loaded bytes are written back identically");
		copy_of(fed);
	} else {
		require(saved(fed) == saved(state) && changes.empty(), "a rejected state has no effect");
	}
	fed = copy_of(state);
	changes.clear();
	if (fed.apply(stored, changes).ok()) {
		const Stored after = saved(copy_of(fed));
		changes.clear();
		require(fed.apply(stored, changes).ok() && changes.empty() && saved(fed) == after,
				"a repeated diff has no effect");
	} else {
		require(saved(fed) == saved(state) && changes.empty(), "a rejected diff has no effect");
	}
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
	feed(InstanceState(), Stored(data, data + size));
	Bytes bytes(data, size);
	InstanceState state;
	const std::uint32_t steps = bytes.below(40);
	for (std::uint32_t step = 0; step < steps; ++step) {
		change(state, bytes);
	}
	InstanceState peer = copy_of(state);
	state.set_origin(bytes.chance(2) ? 7 : 0);
	const std::uint64_t known_revision = state.revision();
	for (std::uint32_t step = bytes.below(20); step > 0; --step) {
		change(state, bytes);
	}
	Stored later_diff = diff(state, known_revision);
	Changes changes;
	Stored missing = state.origin() != 0 ? diff(state, 0) : later_diff;
	const Status status = peer.apply(later_diff, changes);
	require(status.ok() || status.code == ErrorCode::out_of_order || status.code == ErrorCode::foreign,
			"a diff is accepted, or an earlier one is missing");
	if (status.ok() || peer.apply(missing, changes).ok()) {
		require(peer.digest() == state.digest(), "a peer that receives the diff has the same content");
	}
	const DiffLimits limits = read_limits(bytes);
	Stored all = saved(state);
	damage(bytes.chance(2) ? later_diff : all, bytes);
	feed(state, later_diff);
	feed(state, all);
	feed_within(peer, later_diff, limits);
	feed_within(peer, all, limits);
	return 0;
}
