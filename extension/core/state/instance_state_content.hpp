#pragma once

// The content of an InstanceState. Included only by its own sources.

#include "core/base/progress.hpp"
#include "core/state/added_grid.hpp"
#include "core/state/change_log.hpp"
#include "core/state/id_table.hpp"
#include "core/state/instance_state.hpp"
#include "core/state/known_revisions.hpp"
#include "core/state/state_record.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

struct InstanceState::Content {
	using Bytes = std::vector<std::uint8_t>;
	using Entry = StateRecord::Entry;

	/// The state of a layer.
	struct Layer {
		std::uint64_t stamp = 0;
		bool claimed = false;
		double cell_side = 0.0; ///< Meters; 0 if the layer was claimed without it.
		std::size_t removed = 0;
		std::size_t added = 0;
		std::size_t with_data = 0; ///< Points that have data, removed or not.
		double max_scale = 0.0;    ///< Largest of the hand-placed ones since there were none.

		bool holds_points() const { return removed + with_data > 0; }
		bool holds_any() const { return holds_points() || added > 0; }
		bool is_foreign(std::uint64_t to) const { return holds_points() && stamp != 0 && stamp != to; }
	};

	/// A point of a set that will grow again.
	struct Due {
		double time;
		std::uint64_t id;

		friend bool operator>(const Due &left, const Due &right) {
			return left.time != right.time ? left.time > right.time : left.id > right.id;
		}
	};

	/// A hand-placed instance, and the clock when it was placed or moved.
	struct Placed {
		AddedInstance instance;
		double at = 0.0;
	};

	/// Data of an instance, at least one byte, and the clock when they were set.
	struct Data {
		Bytes bytes;
		double at = 0.0;
	};

	using SharedInstance = std::shared_ptr<const Placed>;
	using SharedData = std::shared_ptr<const Data>;

	std::map<std::uint16_t, Layer> layers;
	IdTable<double> removed; ///< With the times at which points grow again.
	IdTable<SharedInstance> added;
	IdTable<SharedData> data;
	AddedGrid grid;       ///< Of `added`.
	std::vector<Due> due; ///< A heap, earliest on top. Entries may be outdated; `removed` has the valid time.
	ChangeLog log;
	std::uint64_t revision = 0;
	std::uint64_t origin = 0; ///< The name of this state for others; 0 if it has none.
	KnownRevisions known;     ///< Revisions of other states.
	bool logging = true;      ///< Off where changes will be forgotten anyway.
	double time = 0.0;
	bool whole = true; ///< False between `share` and `complete`.
	const std::atomic<bool> *cancel =
			nullptr; ///< Once it is true, no further changes are made, because the result is no longer needed.

	std::size_t size() const { return removed.size() + added.size() + data.size(); }

	Entry entry(std::uint64_t id) const;
	std::span<const std::uint8_t> bytes_of(std::uint64_t id) const;
	const AddedInstance *instance_of(std::uint64_t id) const;

	/// An entry with an instance placed now, and the current data of the id.
	Entry placed_as(std::uint64_t id, const AddedInstance &instance) const;

	/// The time of a write that replaces a write of time `former`: the clock or, if `former` is ahead of the clock, a
	/// time after `former`.
	double time_of_write(double former) const;

	/// A copy with the same memory, created in microseconds. Each of the two copies the parts that it changes. The copy
	/// has no log of changes. It is incomplete until `complete` is called, which may happen on a different thread.
	std::unique_ptr<Content> share();

	/// Builds the parts that `share` leaves out. Throws std::bad_alloc.
	void complete();

	/// Takes over the log and the revision of a different content. This content was copied from it and has recorded changes after
	/// `first_note` since, which follow all of the other's changes. `r_log` is the other's log up to the revision `at`.
	void take_history(const Content &other, ChangeLog &r_log, std::uint64_t at, std::uint64_t first_note) noexcept;

	/// The number of new ids in the tables.
	struct NewIds {
		IdTable<double>::NewIds removed;
		IdTable<SharedInstance>::NewIds added;
		IdTable<SharedData>::NewIds data;
	};

	/// The memory that changes need. All of it is allocated before the first change, so that no change fails.
	struct Room {
		std::map<std::uint64_t, SharedInstance> added;
		std::map<std::uint64_t, SharedData> data;
		AddedGrid grid;
		std::size_t changes = 0;   ///< Changes to report.
		std::size_t due = 0;       ///< Points that will grow again.
		NewIds *new_ids = nullptr; ///< Null for a single id.
	};

	/// Sets ids to the given entries and appends the resulting changes, or throws std::bad_alloc and changes nothing.
	/// `each(use)` calls `use(id, entry)` for every id once. `each` is called twice: first to determine the memory
	/// needed, then to make the changes. The second call must not allocate memory.
	template <typename Each>
	void change_all(const Each &each, std::vector<InstanceChange> &r_changes) {
		NewIds new_ids;
		Room room;
		room.new_ids = &new_ids;
		each([&](std::uint64_t id, const Entry &to) {
			if (!is_cancelled(cancel)) {
				plan(id, to, room);
			}
		});
		make_room(room, r_changes);
		each([&](std::uint64_t id, const Entry &to) {
			if (!is_cancelled(cancel)) {
				change(id, to, room, r_changes);
			}
		});
		shrink();
	}

	/// Sets a single id to an entry. `asked_for` is the name of the allocation in the error, `value` its size.
	StateChange change_one(std::uint64_t id, const Entry &to, const char *asked_for, double value);

	/// Calls `use(id)` for the entries due by a time, in the part of the heap below index `at`. A child is never earlier than its parent.
	template <typename Use>
	void for_each_due(double until, const Use &use, std::size_t at = 0) const {
		if (at < due.size() && due[at].time <= until) {
			use(due[at].id);
			for_each_due(until, use, 2 * at + 1);
			for_each_due(until, use, 2 * at + 2);
		}
	}

	/// Moves the clock to a later time and restores the points due by then, or throws std::bad_alloc and changes nothing.
	void move_clock(double to, std::vector<InstanceChange> &r_changes);

	/// Refuses, as `layer`, stamps of points that differ from those of this state's layers. Checks the layers that are claimed or, unless
	/// everything is replaced, hold points.
	Status check_stamps(const StateRecord &record, bool replaced) const;

	/// All ids with any content here, ascending.
	std::vector<std::uint64_t> all_ids() const;

	/// The content of some ids, or of all for a whole record.
	StateRecord record_of(std::vector<std::uint64_t> ids, bool whole) const;
	StateRecord whole_record() const { return record_of(all_ids(), true); }

	/// The cell of a point in world meters. Returns false for a layer whose cells are unknown.
	bool find_cell(std::uint64_t id, Rect &r_cell) const;

	/// See InstanceState::merge. The clock moves to `clock` if that is later. Throws std::bad_alloc and changes nothing.
	Status take_in(
			const StateRecord &record, double clock, const DiffLimits &limits, std::vector<InstanceChange> &r_changes);

	/// Refuses the changes of `each` (see change_all), which come from a record, if they exceed limits: the amount of content after them,
	/// and the positions.
	template <typename Each>
	Status check_changes(const StateRecord &record, const Each &each, const DiffLimits &limits) const {
		if (limits.area.empty() && size() + record.size() + record.with_data.size() <= limits.max_total_changes &&
				added.size() + record.added.size() <= limits.max_added) {
			// Even if all of it is new, it does not exceed the limits.
			return {};
		}
		std::size_t held = size();
		std::size_t placed = added.size();
		Status status;
		each([&](std::uint64_t id, const Entry &to) {
			const bool was_placed = added.contains(id);
			const bool is_placed = to.instance != nullptr;
			held += std::size_t{to.removed} + std::size_t{is_placed} + std::size_t{!to.data.empty()};
			held -= std::size_t{removed.contains(id)} + std::size_t{was_placed} + std::size_t{data.contains(id)};
			placed += std::size_t{is_placed} - std::size_t{was_placed};
			if (status.ok() && !limits.area.empty()) {
				status = check_place(id, to, limits);
			}
		});
		return status.ok() ? check_held(held, placed, limits) : status;
	}

	/// Takes over the content of a record, and its stamps. A whole record replaces everything but the clock. Refuses content that exceeds
	/// the limits. Throws std::bad_alloc and changes nothing, as does the next function.
	Status follow(const StateRecord &record, const DiffLimits &limits, std::vector<InstanceChange> &r_changes);

	/// Takes over a record without limits, and forgets the changes that led here. Counts as a change even if nothing differs.
	void start_from(const StateRecord &record, std::vector<InstanceChange> &r_changes);

	void make_room_for_stamps(const StateRecord &record);
	void take_stamps(const StateRecord &record);

private:
	Entry joined(std::uint64_t id, const Entry &theirs, double clock) const;
	Status check_place(std::uint64_t id, const Entry &to, const DiffLimits &limits) const;
	Status check_held(std::size_t held, std::size_t placed, const DiffLimits &limits) const;
	void shrink() noexcept;
	void plan(std::uint64_t id, const Entry &to, Room &r_room);
	void plan_removed(std::uint64_t id, const Entry &to, Room &r_room);
	bool plan_added(std::uint64_t id, const Entry &to, Room &r_room);
	void make_room(const Room &room, std::vector<InstanceChange> &r_changes);

	// From here on, all memory is already allocated.
	void change(std::uint64_t id, const Entry &to, Room &r_room, std::vector<InstanceChange> &r_changes) noexcept;
	void change_removed(std::uint64_t id, const Entry &to, std::vector<InstanceChange> &r_changes);
	void change_added(std::uint64_t id, const Entry &to, Room &r_room, std::vector<InstanceChange> &r_changes);
	void change_data(std::uint64_t id, const Entry &to, Room &r_room, std::vector<InstanceChange> &r_changes);
	void place(std::uint64_t id, Room &r_room);
	AddedInstance take_away(std::uint64_t id);
	void plan_return(std::uint64_t id, double until);
	void gather_due();
	void note(std::uint64_t id);
	void add_to(StateRecord &r_record, std::uint64_t code) const;
};

} // namespace thicket
