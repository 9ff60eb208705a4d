#pragma once

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

/// Names a point set but for its layer, by a hash of seed, radius and levels: the same for equal sets, another for others as far as
/// 64 bits go. Never 0.
std::uint64_t stamp_of(const PointSet &set);

/// True for the id of a hand-placed instance, which has the highest bit set: negative, in a script. The 15 bits of layer after it
/// lie where they lie in a packed InstanceId, so layers of instances that can be changed go to max_state_layer. No instance has the id of all ones.
constexpr bool is_added(std::uint64_t id) { return id >> 63 != 0; }

/// The layer that an id names, hand-placed or not.
constexpr std::uint16_t layer_of(std::uint64_t id) { return static_cast<std::uint16_t>(id >> 48 & 0x7fff); }

inline constexpr std::uint16_t max_state_layer = 0x7fff;
inline constexpr double max_state_time = 1e12; ///< Seconds.

/// An instance that was placed by hand. A zero has no sign.
struct AddedInstance {
	std::uint16_t layer = 0;  ///< 0 to max_state_layer.
	std::uint8_t mesh = 0;    ///< Of the layer's meshes; beyond the last one, the first is drawn.
	glm::dvec3 position{0.0}; ///< World meters, finite, |x|, |y| and |z| at most max_added_coordinate.
	glm::mat3 basis{1.0f};    ///< Rotation and scale, columns as in GLM; finite.

	friend bool operator==(const AddedInstance &, const AddedInstance &) = default;
};

inline constexpr double max_added_coordinate = 1e9;

/// What has happened to an instance.
enum class InstanceChangeKind : std::uint8_t {
	removed,  ///< A point of the set, or a hand-placed one: then `added` holds what it was.
	restored, ///< A point of the set stands again, as far as its layer's rules let it.
	added,    ///< Placed by hand.
	left,     ///< Hand-placed, and about to stand elsewhere: `added` holds what it was. The next change is its `moved`.
	moved,    ///< The same one stands as `added` says.
	data,     ///< Its data have changed.
};

class PendingDiff;
struct DiffSummary;
struct StateChanges;
struct StateStep;

struct InstanceChange {
	std::uint64_t id = 0;
	InstanceChangeKind kind = InstanceChangeKind::removed;
	AddedInstance added; ///< Of a hand-placed one.
};

/// What came of a change of one instance: whether anything is another now. False as well where memory did not suffice, and
/// then `status` says so and nothing has changed.
struct StateChange {
	Status status;
	bool changed = false;

	operator bool() const { return changed; } // NOLINT: most callers want to know no more.
};

/// What differs from the world as it was generated: removed ids, hand-placed instances, and data of either; and a clock, by which
/// what is removed may grow again. Nothing else is kept, so a world of a million felled trees is a few megabytes.
///
/// Every change has a number, its revision, so that peers can be sent what is new to them. It is a number of this object: it is not
/// saved. What an id was before the state was loaded or cleared is not remembered, nor more than the last changes where ids come and go
/// for ever (as many as the state holds, and 65536): a peer that asks for older ones gets all there is. Not thread safe.
///
/// Layers are stamped with what names their point set (see `claim`), because ids of points mean nothing in another set; what is placed by
/// hand stands in any.
///
/// A state's clock belongs to its owner: diffs of some ids move it forward only, and no further than the receiver's limits allow.
///
/// Two ways lead from one state to another. A state that follows an authority applies that state's diffs in their order (`apply`). States
/// without an authority are joined (`merge`, `merge_diff`), in any order.
///
/// Where memory does not suffice, a call says so by its status and leaves the state as it was, to the bit, and the lists that it
/// would add to; bytes that it would write are none then. Only the log of changes may be given up, as if they were too many.
///
/// A million removed points take about 35 MB of memory, 20 MB if they were loaded, and 17 MB more where they grow again.
class InstanceState {
public:
	InstanceState();
	~InstanceState();
	InstanceState(InstanceState &&) noexcept;
	InstanceState &operator=(InstanceState &&) noexcept;

	/// Whether a point of the set is removed. O(1), about 50 ns; false at once for a layer without any.
	bool removed(std::uint64_t id) const;

	/// The hand-placed instance of that id; null for none.
	const AddedInstance *added(std::uint64_t id) const;

	/// The data of an instance, removed or not; empty for none.
	std::span<const std::uint8_t> data(std::uint64_t id) const;

	/// Adds the ids of all hand-placed instances of a layer that stand in the half-open `rect` (world meters), ascending. Costs what
	/// stands near by, not what stands in the world.
	Status added_in(std::uint16_t layer, const Rect &rect, std::vector<std::uint64_t> &r_ids) const;

	/// No column of the basis of a hand-placed instance of the layer is longer: how far off one must look for those that reach a
	/// place. 0 for none; may stay larger than it has to be after some are removed. O(1).
	double max_added_scale(std::uint16_t layer) const;

	/// Ascending, of one layer or of all.
	std::vector<std::uint64_t> removed_ids(int layer = -1) const;
	std::vector<std::uint64_t> added_ids(int layer = -1) const;
	std::vector<std::uint64_t> data_ids(int layer = -1) const;

	std::size_t removed_count() const;
	std::size_t added_count() const;
	std::size_t data_count() const;
	bool any_removed(std::uint16_t layer) const;

	/// The number of the last change; rises by at least 1 with each. 0 for a new state.
	std::uint64_t revision() const;

	/// Seconds on the state's own clock.
	double time() const;

	/// Names this state, as long as it lives, to states that apply its diffs: a random number, another for every state. 0 for no name, as
	/// at first: then diffs have no order. Copies and loaded bytes have none of it.
	void set_origin(std::uint64_t name);
	std::uint64_t origin() const;

	/// The last revision of a state of that name that is known here by its diffs; 0 for none. `load` and `clear` forget it, and of more
	/// than 256 states those that sent nothing for the longest time.
	std::uint64_t known_revision(std::uint64_t origin) const;

	/// Stamps a layer with a number that names its point set (see stamp_of). Refuses, as `layer`, a layer above max_state_layer, and one
	/// of which points are held under another stamp. From then on no points of another stamp are taken in for it. `cell_side` says how
	/// many meters the set's cells are wide, so that limits and summaries of diffs know where its points stand; 0 for unknown.
	Status claim(std::uint16_t layer, std::uint64_t stamp, double cell_side = 0.0);

	/// Keeps stamps only of layers of which something is held, so that a state without a world takes in any other.
	void release_claims();

	/// The stamp of a layer; 0 for none.
	std::uint64_t stamp(std::uint16_t layer) const;

	/// Whether points of a layer are held under a stamp that is not this one, as `claim` would say.
	bool is_foreign(std::uint16_t layer, std::uint64_t stamp) const;

	/// Removes an instance, for ever or (`until` above 0, at most max_state_time) until the clock reaches that time. A hand-placed one is
	/// gone with its data, and `until` does not count. False if it was removed before (a new `until` is taken over) or was never placed.
	StateChange remove(std::uint64_t id, double until = 0.0);

	/// Undoes the removal of a point of the set. False if it was not removed.
	StateChange restore(std::uint64_t id);

	/// Places an instance by hand. Its id is a function of the instance, so that peers who place the same get the same id; one that
	/// is taken gives the next free id (see free_id). Refuses what AddedInstance refuses, naming it, and leaves everything as it was.
	Status add(const AddedInstance &instance, std::uint64_t &r_id);

	/// Places many instances, as `add` would one after the other, with the same ids; all of them, or none. Replaces `r_ids` by the ids
	/// in the order of the instances. After a refusal it holds those of the instances before the one that was refused, which were not
	/// placed either: their number is its index. Adds the changes.
	Status add_all(std::span<const AddedInstance> instances, std::vector<std::uint64_t> &r_ids,
			std::vector<InstanceChange> &r_changes);

	/// Moves an instance to where `instance` stands, with its data. A hand-placed one keeps its id; a point of the set is removed for
	/// ever, and a hand-placed one is there for it. `r_id` becomes the id it has then. Refuses what `add` refuses, and as `id` an instance
	/// of another layer, a hand-placed one that there is not and a point that is removed; then everything is as it was. Adds the changes.
	Status move(std::uint64_t id, const AddedInstance &instance, std::uint64_t &r_id,
			std::vector<InstanceChange> &r_changes);

	/// Replaces the data of an instance; no bytes for none. Refuses more than max_instance_data bytes as `data`, and a hand-placed
	/// instance that there is not as `id`.
	Status set_data(std::uint64_t id, std::span<const std::uint8_t> bytes);

	/// Moves the clock on by `seconds`, to max_state_time at most, and restores what is due. Nothing for what is not above 0. Adds the
	/// changes.
	Status advance(double seconds, std::vector<InstanceChange> &r_changes);

	/// Forgets everything but the revision, which rises, and the claims. Adds the changes.
	Status clear(std::vector<InstanceChange> &r_changes);

	/// Replaces `r_bytes` by the whole state: versioned, checksummed, the same bytes for the same content on every machine. A million
	/// removed points of a layer take less than 4 MB however they are spread, and far less where they stand close.
	Status save(std::vector<std::uint8_t> &r_bytes) const;

	/// Replaces the content of this state by what `save` wrote. Refuses what is truncated, damaged, of another kind or version with
	/// ErrorCode::corrupt, and stamps that contradict those of this state's layers as `layer`; then nothing has changed. Adds the changes.
	Status load(std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes);

	/// Replaces `r_bytes` by what has changed since a revision of this state, restored ids included, for `apply`. The diff carries this
	/// state's name and both revisions, if it has a name and `ordered` is true.
	Status diff_since(std::uint64_t revision, std::vector<std::uint8_t> &r_bytes, bool ordered = true) const;

	/// Replaces `r_bytes` by what is held of some ids now, for `apply`, which makes them again what they were: for steps of undo.
	Status diff_of(std::span<const std::uint64_t> ids, std::vector<std::uint8_t> &r_bytes) const;

	/// Takes over what `diff_since` of another state gave: those ids become what they are there, all others stay. A diff that had to give
	/// all there is, and what `save` gave, replaces everything, the clock too. Refuses as `load` does, and what the limits forbid
	/// (ErrorCode::not_allowed).
	///
	/// Diffs of a state with a name are applied in order: a diff that ends at a known revision is late or repeated and changes nothing; one that
	/// begins after the last known revision is refused (ErrorCode::out_of_order): diffs are missing before it.
	Status apply(
			std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes, const DiffLimits &limits = {});

	/// Finds out whether diffs are missing before this one: `r_missing`, and then `r_since` is the revision for the sender's `diff_since`.
	/// Reads the front of the bytes alone. Refuses what begins as no diff.
	Status missing_before(std::span<const std::uint8_t> bytes, bool &r_missing, std::uint64_t &r_since) const;

	/// Finds out what a diff names, and changes nothing. Refuses what `apply` refuses for its size, and what is no diff; then `r_summary` has
	/// what the front of the bytes says.
	Status inspect(std::span<const std::uint8_t> bytes, DiffSummary &r_summary, const DiffLimits &limits = {}) const;

	/// Queues a diff that another thread applies meanwhile, for some microseconds here: `apply` in three parts. `bytes` stay as long as
	/// `r_diff` does.
	/// Until a queued diff is finished, all that is asked here is as if there was none. What comes of it in the end is the same as if
	/// `apply` had been called when it was queued: what was done since is done again after it. Hand-placed ids stay what they were.
	/// While any diff is pending, `apply`, `merge`, `merge_diff`, `load` and `clear` are not to be called.
	Status queue_diff(
			std::span<const std::uint8_t> bytes, std::shared_ptr<PendingDiff> &r_diff, const DiffLimits &limits = {});

	/// The first that was queued and is not finished, on which PendingDiff::work can be called; null for none.
	std::shared_ptr<PendingDiff> pending_diff() const;

	/// Takes over what PendingDiff::work has done for the first that was queued. Costs what was done since, not what the diff holds.
	/// Replaces `r_changes`. Refuses what `apply` refuses, and a diff that contradicts a stamp that was claimed since; then the diff has
	/// changed nothing. One is pending.
	Status finish_pending_diff(StateChanges &r_changes);

	/// Joins the content of another state to this one. Removed by either is removed, for the longer time; placed by either is placed. For two
	/// different data, and two different places of one hand-placed id, the last write wins, by the clock of the state that wrote it; at the
	/// same time, the greater bytes or numbers win. The clock becomes the later one, and points that are due by then stand. The order and
	/// number of joins do not matter: states that have met in any way hold the same. So what was undone comes back from a state that still
	/// holds it: a restored point, a hand-placed instance that was removed, erased data. Refuses stamps that contradict this state's as
	/// `layer`.
	Status merge(const InstanceState &other, std::vector<InstanceChange> &r_changes);

	/// Joins the content of a diff or a saved state, in any order, with losses and repetitions. Restored points and hand-placed instances
	/// that are gone change nothing. The clock moves by at most what the limits allow. Refuses as `apply` does, except that a whole state is
	/// joined, and replaces nothing.
	Status merge_diff(
			std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes, const DiffLimits &limits = {});

	/// A copy that shares this state's memory, for some microseconds: each copies what it changes, so another thread may read the copy. It
	/// remembers no changes. `complete` is called on it, on any thread, before `added_in` and before anything changes it.
	InstanceState share();
	Status complete();

	/// FNV-1a of what release 0.2.0 saved, with a clock and stamps of 0: equal for equal content, on every machine and in every version.
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
	std::unique_ptr<Journal> journal_; ///< Null while no diff is pending.
};

} // namespace thicket
