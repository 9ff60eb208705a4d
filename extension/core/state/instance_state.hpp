#pragma once

#include "core/base/instance_id.hpp"
#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/sampling/point_set.hpp"
#include "core/state/diff_limits.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Identifies a point set, without its layer, by a hash of seed, radius and levels: the same for equal sets, different for all others as
/// far as 64 bits allow. Never 0.
std::uint64_t stamp_of(const PointSet &set);

/// True for the id of a hand-placed instance. Such an id has the highest bit set, so it is negative in a script. The 15 bits of the layer
/// follow at the same position as in a packed InstanceId, so layers with changeable instances are limited to max_state_layer. No instance
/// has the id of all ones.
constexpr bool is_added(std::uint64_t id) { return id >> 63 != 0; }

/// The layer of an id, hand-placed or not.
constexpr std::uint16_t layer_of(std::uint64_t id) { return static_cast<std::uint16_t>(id >> id_layer_shift & 0x7fff); }

inline constexpr std::uint16_t max_state_layer = 0x7fff;
inline constexpr double max_state_time = 1e12; ///< Seconds.

/// An instance that was placed by hand. Its zeros have no sign.
struct AddedInstance {
	std::uint16_t layer = 0;  ///< 0 to max_state_layer.
	std::uint8_t mesh = 0;    ///< Index in the layer's meshes. Beyond the last one, the first mesh is drawn.
	glm::dvec3 position{0.0}; ///< World meters, finite, |x|, |y| and |z| at most max_added_coordinate.
	glm::mat3 basis{1.0f};    ///< Rotation and scale, finite; columns as in GLM.

	friend bool operator==(const AddedInstance &, const AddedInstance &) = default;
};

inline constexpr double max_added_coordinate = 1e9;

/// How an instance has changed.
enum class InstanceChangeKind : std::uint8_t {
	removed,  ///< A point of the set, or a hand-placed instance; `added` then holds its former content.
	restored, ///< A point of the set is placed again, as far as its layer's rules permit.
	added,    ///< Placed by hand.
	left,     ///< A hand-placed instance is about to move. `added` is its former content. Its `moved` is next.
	moved,    ///< The same instance has moved and now matches `added`.
	data,     ///< The data of the instance has changed.
};

class PendingDiff;
struct DiffSummary;
struct StateChanges;
struct StateStep;

struct InstanceChange {
	std::uint64_t id = 0;
	InstanceChangeKind kind = InstanceChangeKind::removed;
	AddedInstance added; ///< For a hand-placed instance.
};

/// The result of changing one instance: whether anything has changed. Also false if memory did not suffice. In that case `status` reports
/// it and nothing has changed.
struct StateChange {
	Status status;
	bool changed = false;

	operator bool() const { return changed; } // NOLINT: most callers need only this.
};

/// The differences from the generated world: removed ids, hand-placed instances, and data of either. The state also has
/// a clock, by which removed points may grow again. Nothing else is stored, so a world with a million felled trees
/// takes a few megabytes.
///
/// Every change has a number, its revision, so that peers can be sent only the changes that are new to them. Revisions
/// belong to this object and are not saved. The state of an id before the state was loaded or cleared is not
/// remembered. If ids are added and removed endlessly, only the last changes are remembered (at least as many as the
/// state has entries, and at least 65536). A peer that requests older changes receives the whole state. Not thread
/// safe.
///
/// Layers are stamped with a number that identifies their point set (see `claim`), because ids of points mean nothing in a different set.
/// Hand-placed instances are valid in any set.
///
/// A state's clock belongs to its owner: diffs of some ids only move it forward, and no further than the receiver's limits permit.
///
/// There are two ways to transfer changes between states. A state that follows an authority applies the authority's diffs in order
/// (`apply`). States without an authority are joined (`merge`, `merge_diff`), in any order.
///
/// If memory does not suffice, a call reports it in its status and leaves the state bit for bit unchanged, along with the lists that it
/// would append to. Output bytes are then empty. Only the log of changes may be discarded, as if it were too long.
///
/// A million removed points take about 35 MB of memory, 20 MB if they were loaded, and 17 MB more if they grow again.
class InstanceState {
public:
	InstanceState();
	~InstanceState();
	InstanceState(InstanceState &&) noexcept;
	InstanceState &operator=(InstanceState &&) noexcept;

	/// Whether a point of the set is removed. O(1), about 50 ns; for a layer without removed points, false immediately.
	bool removed(std::uint64_t id) const;

	/// The hand-placed instance with this id. Null if there is none.
	const AddedInstance *added(std::uint64_t id) const;

	/// The data of an instance, removed or not. Empty if there is none.
	std::span<const std::uint8_t> data(std::uint64_t id) const;

	/// Appends the ids of all hand-placed instances of a layer in the half-open `rect` (world meters), in ascending order. The cost
	/// depends on the instances nearby, not on those in the whole world.
	Status added_in(std::uint16_t layer, const Rect &rect, std::vector<std::uint64_t> &r_ids) const;

	/// An upper bound for the length of the basis columns of the layer's hand-placed instances. The bound determines
	/// how far away to search for instances that reach a position. 0 if there are no such instances. May stay too large
	/// after instances are removed. O(1).
	double max_added_scale(std::uint16_t layer) const;

	/// In ascending order, of one layer or of all.
	std::vector<std::uint64_t> removed_ids(int layer = -1) const;
	std::vector<std::uint64_t> added_ids(int layer = -1) const;
	std::vector<std::uint64_t> data_ids(int layer = -1) const;

	std::size_t removed_count() const;
	std::size_t added_count() const;
	std::size_t data_count() const;
	bool any_removed(std::uint16_t layer) const;

	/// The number of the last change. Rises by at least 1 with each change. 0 for a new state.
	std::uint64_t revision() const;

	/// Seconds on the state's own clock.
	double time() const;

	/// Sets the name by which this state, during its lifetime, is known to states that apply its diffs. The name should be a random
	/// number, different for every state. 0, the default, is no name: diffs then have no order. Copies and loaded bytes do not keep it.
	void set_origin(std::uint64_t name);
	std::uint64_t origin() const;

	/// The last revision known here, from its diffs, of the state with that name. 0 if there is none. `load` and `clear` forget it. Of
	/// more than 256 states, those that sent nothing for the longest time are forgotten.
	std::uint64_t known_revision(std::uint64_t origin) const;

	/// Stamps a layer with a number that identifies its point set (see stamp_of). Refuses, as `layer`, a layer above
	/// max_state_layer and a layer that already has points with a different stamp. From then on, points with a
	/// different stamp are refused for this layer. `cell_side` is the width of the set's cells in meters, so that
	/// limits and summaries of diffs know the positions of its points; 0 if unknown.
	Status claim(std::uint16_t layer, std::uint64_t stamp, double cell_side = 0.0);

	/// Keeps only the stamps of layers with content, so that a state without a world accepts any other stamp.
	void release_claims();

	/// The stamp of a layer. 0 if there is none.
	std::uint64_t stamp(std::uint16_t layer) const;

	/// True if the state has points of a layer with a different stamp, so that `claim` would refuse this stamp.
	bool is_foreign(std::uint16_t layer, std::uint64_t stamp) const;

	/// Removes an instance, permanently or until the clock reaches `until` (above 0, at most max_state_time). A hand-placed instance is
	/// deleted along with its data, and `until` is ignored. Returns false if it was already removed (a new `until` is still applied) or
	/// was never placed.
	StateChange remove(std::uint64_t id, double until = 0.0);

	/// Undoes the removal of a point of the set. Returns false if it was not removed.
	StateChange restore(std::uint64_t id);

	/// Places an instance by hand. Its id is a function of the instance, so that peers that place the same instance get the same id. If
	/// the id is taken, the next free id is used (see free_id). Refuses invalid fields of AddedInstance, and reports the field; the state
	/// is then unchanged.
	Status add(const AddedInstance &instance, std::uint64_t &r_id);

	/// Places many instances, with the same ids as `add` one by one; all of them or none. Replaces `r_ids` with the ids in the order of
	/// the instances. After a refusal, `r_ids` has the ids of the instances before the refused one, so its size is the index of the
	/// refused instance. None of them was placed. Appends the changes.
	Status add_all(std::span<const AddedInstance> instances, std::vector<std::uint64_t> &r_ids,
			std::vector<InstanceChange> &r_changes);

	/// Moves an instance, along with its data, to the position and basis of `instance`. A hand-placed instance keeps its id. A point of
	/// the set is removed permanently and replaced by a hand-placed instance. `r_id` becomes the id after the move. Refuses the same
	/// values as `add` and, as `id`, an instance of a different layer, a hand-placed instance that does not exist, and a removed point.
	/// The state is then unchanged. Appends the changes.
	Status move(std::uint64_t id, const AddedInstance &instance, std::uint64_t &r_id,
			std::vector<InstanceChange> &r_changes);

	/// Replaces the data of an instance; an empty span removes them. Refuses more than max_instance_data bytes as `data`, and a
	/// hand-placed instance that does not exist as `id`.
	Status set_data(std::uint64_t id, std::span<const std::uint8_t> bytes);

	/// Advances the clock by `seconds`, to at most max_state_time, and restores the points that are due. Does nothing if `seconds` is not
	/// above 0. Appends the changes.
	Status advance(double seconds, std::vector<InstanceChange> &r_changes);

	/// Forgets everything but the claims and the revision, which rises. Appends the changes.
	Status clear(std::vector<InstanceChange> &r_changes);

	/// Replaces `r_bytes` with the whole state: versioned, checksummed, the same bytes for the same content on every machine. A million
	/// removed points of a layer take less than 4 MB however they are spread, and far less if they are close together.
	Status save(std::vector<std::uint8_t> &r_bytes) const;

	/// Replaces the content of this state with the output of `save`. Refuses truncated or damaged bytes and a different kind or version
	/// with ErrorCode::corrupt, and stamps that contradict those of this state's layers as `layer`. Nothing has changed then. Appends the
	/// changes.
	Status load(std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes);

	/// Replaces `r_bytes` with the changes since a revision of this state, including restored ids, for `apply`. The diff contains this
	/// state's name and both revisions, if it has a name and `ordered` is true.
	Status diff_since(std::uint64_t revision, std::vector<std::uint8_t> &r_bytes, bool ordered = true) const;

	/// Replaces `r_bytes` with the current state of some ids. `apply` restores that state later: for undo steps.
	Status diff_of(std::span<const std::uint64_t> ids, std::vector<std::uint8_t> &r_bytes) const;

	/// Applies the output of a different state's `diff_since`: the ids in it take over the content that they have in
	/// that state; all other ids are unchanged. A diff that contains the whole state, and the output of `save`, replace
	/// everything, including the clock. Refuses the same input as `load`, and diffs that exceed the limits
	/// (ErrorCode::not_allowed).
	///
	/// Diffs of a named state are applied in order. A diff that ends at a known revision is late or repeated and changes nothing. A diff
	/// that begins after the last known revision is refused (ErrorCode::out_of_order), because diffs before it are missing.
	Status apply(
			std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes, const DiffLimits &limits = {});

	/// Checks whether diffs before this one are missing. If so, `r_missing` is true and `r_since` is the revision for the sender's
	/// `diff_since`. Reads only the front of the bytes. Refuses bytes that do not begin like a diff.
	Status missing_before(std::span<const std::uint8_t> bytes, bool &r_missing, std::uint64_t &r_since) const;

	/// Summarizes a diff without changing anything. Refuses diffs that `apply` refuses for their size, and bytes that are not a diff.
	/// `r_summary` then has the content of the front of the bytes.
	Status inspect(std::span<const std::uint8_t> bytes, DiffSummary &r_summary, const DiffLimits &limits = {}) const;

	/// Queues a diff, in microseconds, so that a different thread can apply it: this is `apply` in three parts. `bytes`
	/// must live as long as `r_diff`. Until a queued diff is finished, all queries return results as if there were
	/// none. The final result is the same as if `apply` had been called when the diff was queued: later changes are
	/// repeated after it. Ids of hand-placed instances are unchanged. While any diff is pending, do not call `apply`,
	/// `merge`, `merge_diff`, `load` or `clear`.
	Status queue_diff(
			std::span<const std::uint8_t> bytes, std::shared_ptr<PendingDiff> &r_diff, const DiffLimits &limits = {});

	/// The first queued diff that is not finished, for which PendingDiff::work can be called. Null if there is none.
	std::shared_ptr<PendingDiff> pending_diff() const;

	/// Takes over the result of PendingDiff::work for the first queued diff. The cost depends on the changes since it was queued, not on
	/// the size of the diff. Replaces `r_changes`. Refuses the same diffs as `apply`, and a diff that contradicts a stamp claimed since;
	/// the diff has then changed nothing. Requires a pending diff.
	Status finish_pending_diff(StateChanges &r_changes);

	/// Joins the content of a different state to this one. An instance that either state has removed is removed, for
	/// the longer time. An instance that either state has placed is placed. If the data, or the content of one
	/// hand-placed id, differ, the last write wins, by the clock of the state that wrote it. At equal times, the
	/// greater bytes or numbers win. The later of the two clocks is kept, and points that are due by then are restored.
	/// The order and number of joins do not matter: states that were joined in any way have the same content. An undone
	/// change therefore returns from a state that still contains it: the removal of a restored point, a hand-placed
	/// instance that was removed, erased data. Refuses stamps that contradict this state's as `layer`.
	Status merge(const InstanceState &other, std::vector<InstanceChange> &r_changes);

	/// Joins the content of a diff or a saved state, in any order, despite losses and repetitions. Restored points and deleted
	/// hand-placed instances change nothing. The clock moves by at most the limit. Refuses the same input as `apply`, except that a whole
	/// state is joined and replaces nothing.
	Status merge_diff(
			std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes, const DiffLimits &limits = {});

	/// A copy that shares this state's memory, created in microseconds. Each of the two copies the parts that it changes, so a different
	/// thread may read the copy. The copy remembers no changes. Call `complete` on it, on any thread, before `added_in` and before any
	/// change.
	InstanceState share();
	Status complete();

	/// FNV-1a hash of the content as release 0.2.0 saved it, with a clock and stamps of 0: equal for equal content, on every machine and
	/// in every version.
	std::uint64_t digest() const;

private:
	friend class PendingDiff;
	struct Content;
	struct Journal;

	explicit InstanceState(std::unique_ptr<Content> content);

	Status take_over(PendingDiff &diff, StateChanges &r_changes);
	void pass_over(PendingDiff &diff);
	Status repeat(const StateStep &step, std::vector<InstanceChange> &r_changes);
	StateChange put(std::uint64_t id, const AddedInstance &instance);
	void put_for(
			std::uint64_t id, std::uint64_t to, const AddedInstance &instance, std::vector<InstanceChange> &r_changes);

	std::unique_ptr<Content> content_;
	std::unique_ptr<Journal> journal_; ///< Null if no diff is pending.
};

} // namespace thicket
