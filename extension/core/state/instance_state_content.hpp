#pragma once

// The content of an InstanceState. Only the sources of InstanceState include this file.

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

	/// The stamp of a layer, and its number of entries of each kind.
	struct Layer {
		std::uint64_t stamp = 0;
		bool claimed = false;
		double cell_side = 0.0;          ///< The width of the cells in meters; 0 if the layer was claimed without it.
		std::int32_t cells_together = 1; ///< Cells that belong together; see InstanceState::claim.
		std::size_t removed = 0;
		std::size_t added = 0;
		std::size_t with_data = 0; ///< Number of points with data, removed or not.
		double max_scale = 0.0;    ///< Largest scale of a hand-placed instance since the layer last had none.

		bool has_points() const { return removed + with_data > 0; }
		bool has_entries() const { return has_points() || added > 0; }
		bool is_foreign(std::uint64_t new_stamp) const { return has_points() && stamp != 0 && stamp != new_stamp; }
	};

	/// A removed point that will grow again, and the clock time of its regrowth.
	struct Due {
		double time;
		std::uint64_t id;

		friend bool operator>(const Due &left, const Due &right) {
			return left.time != right.time ? left.time > right.time : left.id > right.id;
		}
	};

	/// A hand-placed instance, and the clock time when it was placed or last moved.
	struct Placed {
		AddedInstance instance;
		double at = 0.0;
	};

	/// Data of an instance, at least one byte, and the clock time when it was set.
	struct Data {
		Bytes bytes;
		double at = 0.0;
	};

	using SharedInstance = std::shared_ptr<const Placed>;
	using SharedData = std::shared_ptr<const Data>;

	std::map<std::uint16_t, Layer> layers;
	IdTable<double> removed; ///< The values are the times at which points grow again; 0 for never.
	IdTable<SharedInstance> added;
	IdTable<SharedData> data;
	AddedGrid grid; ///< Spatial index of `added`.
	/// A heap with the earliest regrowth on top. Entries may be outdated; the time in `removed` is
	/// authoritative.
	std::vector<Due> due;
	ChangeLog log;
	std::uint64_t revision = 0;
	std::uint64_t origin = 0; ///< The name of this state; 0 if it has none.
	KnownRevisions known;     ///< Last known revisions of other states.
	bool logging = true;      ///< False while changes are made that the log will not keep.
	double time = 0.0;
	bool is_completed = true; ///< False from `share` until `complete`.
	/// Once the flag is set, no more changes are made, because the result will be discarded. May be
	/// null.
	const std::atomic<bool> *cancel = nullptr;

	std::size_t size() const { return removed.size() + added.size() + data.size(); }

	Entry entry(std::uint64_t id) const;
	std::span<const std::uint8_t> bytes_of(std::uint64_t id) const;
	const AddedInstance *instance_of(std::uint64_t id) const;

	/// Returns the entry of `id` after `instance` is placed now. Keeps the instance's data.
	Entry placed_as(std::uint64_t id, const AddedInstance &instance) const;

	/// Returns the time to record for a write that replaces one made at the time `former`. The
	/// result is the clock time or, unless that is later than `former`, a time slightly after
	/// `former`.
	double time_of_write(double former) const;

	/// Returns a copy that shares memory with this content. Takes microseconds. Both contents copy
	/// memory before they change it. The copy's log is empty. The copy is incomplete until
	/// `complete` is called, which may happen on another thread.
	std::unique_ptr<Content> share();

	/// Builds the parts that `share` does not copy. Throws std::bad_alloc.
	void complete();

	/// Takes over the log and the revision of `other`, from which this content was copied. The
	/// changes recorded here after the revision `first_note` then follow all changes of `other`.
	/// `r_log` is the log of `other` up to the revision `at`; the call consumes it.
	void take_history(const Content &other, ChangeLog &r_log, std::uint64_t at, std::uint64_t first_note) noexcept;

	/// The number of new IDs in each table.
	struct NewIds {
		IdTable<double>::NewIds removed;
		IdTable<SharedInstance>::NewIds added;
		IdTable<SharedData>::NewIds data;
	};

	/// The memory that a batch of changes needs. It is allocated before the first change, so that
	/// no change can fail.
	struct ReservedMemory {
		std::map<std::uint64_t, SharedInstance> added;
		std::map<std::uint64_t, SharedData> data;
		AddedGrid grid;
		std::size_t changes = 0;   ///< Number of changes to report.
		std::size_t due = 0;       ///< Number of points that will grow again.
		NewIds *new_ids = nullptr; ///< Number of new IDs in each table; null for a single ID.
	};

	/// Sets IDs to the given entries and appends the resulting changes. If memory runs out, throws
	/// std::bad_alloc and leaves the content unchanged. `each(use)` must call `use(id, entry)` once
	/// for every ID. `each` is called twice: first to determine the memory needed, then to make the
	/// changes. The second call must not allocate memory.
	template <typename Each>
	void change_all(const Each &visit_entries, std::vector<InstanceChange> &r_changes) {
		NewIds new_ids;
		ReservedMemory reserved;
		reserved.new_ids = &new_ids;
		visit_entries([&](std::uint64_t id, const Entry &target) {
			if (!is_cancelled(cancel)) {
				plan(id, target, reserved);
			}
		});
		reserve(reserved, r_changes);
		visit_entries([&](std::uint64_t id, const Entry &target) {
			if (!is_cancelled(cancel)) {
				change(id, target, reserved, r_changes);
			}
		});
		shrink();
	}

	/// Sets a single ID to an entry. `asked_for` and `value` are the name and the size that an
	/// out-of-memory error reports.
	StateChange change_one(std::uint64_t id, const Entry &target, const char *asked_for, double value);

	/// Calls `use(id)` for the entries of `due` up to the time `until`, in the subtree of the heap
	/// at index `at`. The search stops at later entries, because a child is never earlier than its
	/// parent.
	template <typename Use>
	void for_each_due(double until, const Use &use, std::size_t at = 0) const {
		if (at < due.size() && due[at].time <= until) {
			use(due[at].id);
			for_each_due(until, use, 2 * at + 1);
			for_each_due(until, use, 2 * at + 2);
		}
	}

	/// Moves the clock to a later time and restores the points due by then. If memory runs out,
	/// throws std::bad_alloc and leaves the content unchanged.
	void move_clock(double new_time, std::vector<InstanceChange> &r_changes);

	/// Returns an error that names `layer` for a record whose points have a different stamp than
	/// this state's layer. The claimed layers are checked and, unless everything is `replaced`, the
	/// layers that have points.
	Status check_stamps(const StateRecord &record, bool replaced) const;

	/// Returns all IDs with any content, in ascending order.
	std::vector<std::uint64_t> all_ids() const;

	/// Returns a record with the content of `ids`. If `is_complete` is true, these must be all IDs.
	StateRecord record_of(std::vector<std::uint64_t> ids, bool is_complete) const;
	StateRecord complete_record() const { return record_of(all_ids(), true); }

	/// Finds the cell of a point, in world meters. Returns false if the cell size of its layer is
	/// unknown.
	bool find_cell(std::uint64_t id, Rect &r_cell) const;

	/// Merges a record; see InstanceState::merge. If `clock` is later than the state's clock, the
	/// state's clock advances to it. If memory runs out, throws std::bad_alloc and leaves the
	/// content unchanged.
	Status take_in(
			const StateRecord &record, double clock, const DiffLimits &limits, std::vector<InstanceChange> &r_changes);

	/// Returns an error for changes from a record that exceed the limits for positions or for the
	/// amount of content after the changes. `each` is as in change_all.
	template <typename Each>
	Status check_changes(const StateRecord &record, const Each &visit_entries, const DiffLimits &limits) const {
		if (limits.area.empty() && size() + record.size() + record.with_data.size() <= limits.max_total_changes &&
				added.size() + record.added.size() <= limits.max_added) {
			// Even if the complete record is new, it stays within the limits.
			return {};
		}
		std::size_t held = size();
		std::size_t placed = added.size();
		Status status;
		visit_entries([&](std::uint64_t id, const Entry &target) {
			const bool was_placed = added.contains(id);
			const bool is_placed = target.instance != nullptr;
			held += std::size_t{target.removed} + std::size_t{is_placed} + std::size_t{!target.data.empty()};
			held -= std::size_t{removed.contains(id)} + std::size_t{was_placed} + std::size_t{data.contains(id)};
			placed += std::size_t{is_placed} - std::size_t{was_placed};
			if (status.ok() && !limits.area.empty()) {
				status = check_place(id, target, limits);
			}
		});
		return status.ok() ? check_held(held, placed, limits) : status;
	}

	/// Takes over the content and the stamps of a record. A whole record replaces everything except
	/// the clock. Content that exceeds the limits is an error. If memory runs out, throws
	/// std::bad_alloc and leaves the content unchanged.
	Status follow(const StateRecord &record, const DiffLimits &limits, std::vector<InstanceChange> &r_changes);

	/// Takes over a whole record without limits, along with its clock, and clears the log. The
	/// revision increases even if nothing differs. Lack of memory is handled as in `follow`.
	void start_from(const StateRecord &record, std::vector<InstanceChange> &r_changes);

	void reserve_stamps(const StateRecord &record);
	void take_stamps(const StateRecord &record);

private:
	Entry joined(std::uint64_t id, const Entry &theirs, double clock) const;
	Status check_place(std::uint64_t id, const Entry &target, const DiffLimits &limits) const;
	Status check_held(std::size_t held, std::size_t placed, const DiffLimits &limits) const;
	void shrink() noexcept;
	void plan(std::uint64_t id, const Entry &target, ReservedMemory &r_reserved);
	void plan_removed(std::uint64_t id, const Entry &target, ReservedMemory &r_reserved);
	bool plan_added(std::uint64_t id, const Entry &target, ReservedMemory &r_reserved);
	void reserve(const ReservedMemory &reserved, std::vector<InstanceChange> &r_changes);

	// Call the functions below only after all memory has been allocated.
	void change(std::uint64_t id, const Entry &target, ReservedMemory &r_reserved,
			std::vector<InstanceChange> &r_changes) noexcept;
	void change_removed(std::uint64_t id, const Entry &target, std::vector<InstanceChange> &r_changes);
	void change_added(
			std::uint64_t id, const Entry &target, ReservedMemory &r_reserved, std::vector<InstanceChange> &r_changes);
	void change_data(
			std::uint64_t id, const Entry &target, ReservedMemory &r_reserved, std::vector<InstanceChange> &r_changes);
	void place(std::uint64_t id, ReservedMemory &r_reserved);
	AddedInstance take_away(std::uint64_t id);
	void plan_return(std::uint64_t id, double until);
	void gather_due();
	void record(std::uint64_t id);
	void add_to(StateRecord &r_record, std::uint64_t code) const;
};

} // namespace thicket
