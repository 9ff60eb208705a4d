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

/// Returns a 64-bit hash of a point set's seed, radius and levels, without its layer. The hash,
/// called the stamp, identifies the set: equal sets have the same stamp, and different sets
/// practically never do. A stamp is never 0.
std::uint64_t stamp_of(const PointSet &set);

/// Returns true for the ID of a hand-placed instance. Such an ID has the highest bit set, so it is
/// negative in a script. The next 15 bits are the layer, at the same position as in a packed
/// InstanceId, so layers in a state are limited to max_state_layer. An ID with all bits set is
/// invalid.
constexpr bool is_added(std::uint64_t id) { return id >> 63 != 0; }

/// Returns the layer of any ID, hand-placed or not.
constexpr std::uint16_t layer_of(std::uint64_t id) { return static_cast<std::uint16_t>(id >> id_layer_shift & 0x7fff); }

inline constexpr std::uint16_t max_state_layer = 0x7fff;
inline constexpr double max_state_time = 1e12; ///< Maximum of the clock in seconds.

/// An instance that was placed by hand. A state replaces each -0 in it with 0.
struct AddedInstance {
	std::uint16_t layer = 0;  ///< Layer of the instance, 0 to max_state_layer.
	std::uint8_t mesh = 0;    ///< Index in the layer's meshes. If it is out of range, the first mesh is drawn.
	glm::dvec3 position{0.0}; ///< World meters, finite; |x|, |y| and |z| at most max_added_coordinate.
	glm::mat3 basis{1.0f};    ///< Rotation and scale, finite, column-major as in GLM.

	friend bool operator==(const AddedInstance &, const AddedInstance &) = default;
};

inline constexpr double max_added_coordinate = 1e9;

/// How an instance has changed.
enum class InstanceChangeKind : std::uint8_t {
	/// A point of the set or a hand-placed instance was removed. For a hand-placed instance,
	/// `added` is its former content.
	removed,
	restored, ///< The removal of a point of the set was undone. The layer's rules may still exclude it.
	added,    ///< An instance was placed by hand.
	/// A hand-placed instance left its position; `added` is its former content. The next change is
	/// its `moved` change.
	left,
	moved, ///< The instance of the previous `left` change has moved; `added` is its new content.
	data,  ///< The data of the instance has changed.
};

class PendingDiff;
struct DiffSummary;
struct StateChanges;
struct StateStep;

struct InstanceChange {
	std::uint64_t id = 0;
	InstanceChangeKind kind = InstanceChangeKind::removed;
	AddedInstance added; ///< Known only for hand-placed instances.
};

/// The result of changing one instance. `changed` is true if anything changed. If memory runs out,
/// `status` reports it and nothing has changed.
struct StateChange {
	Status status;
	bool changed = false;

	operator bool() const { return changed; } // NOLINT: most callers need only this.
};

/// The differences from the generated world: removed IDs, hand-placed instances, and data attached
/// to either. A clock lets removed points grow again later. Only these differences are saved, so a
/// world with a million felled trees takes a few megabytes.
///
/// Every change has a revision number, so that a peer needs to receive only the changes that it
/// lacks. Revisions belong to this object and are not saved. Changes before the last `load` or
/// `clear` are forgotten. The log keeps only the latest changes: at least as many as the state has
/// entries, and at least 65536. A peer that requests older changes receives the whole state. Use a
/// state on one thread only.
///
/// Each layer has a stamp that identifies its point set (see `claim`), because IDs of points are
/// meaningless in any other set. Hand-placed instances are valid with any set.
///
/// Other states have limited control of the clock: a partial diff can only advance it, by at most
/// DiffLimits::max_clock_advance.
///
/// There are two ways to transfer changes between states. A state with an authority applies the
/// authority's diffs in order (`apply`). States without an authority are merged in any order
/// (`merge`, `merge_diff`).
///
/// If memory runs out, a call reports it in its status. The state and the lists that the call
/// appends to are then bit for bit unchanged, and output bytes are empty. Only the log of changes
/// may be discarded.
///
/// A million removed points take about 35 MB of memory, or 20 MB after loading, and 17 MB more if
/// they grow again.
class InstanceState {
public:
	InstanceState();
	~InstanceState();
	InstanceState(InstanceState &&) noexcept;
	InstanceState &operator=(InstanceState &&) noexcept;

	/// Returns true if a point of the set is removed. Takes O(1) time, about 50 ns; less for a
	/// layer without removed points.
	bool removed(std::uint64_t id) const;

	/// Returns the hand-placed instance with this ID, or null if there is none. The pointer is
	/// valid until the next change.
	const AddedInstance *added(std::uint64_t id) const;

	/// Returns the data of an instance, removed or not, or an empty span if it has none. The span
	/// is valid until the next change.
	std::span<const std::uint8_t> data(std::uint64_t id) const;

	/// Appends the IDs of all hand-placed instances of a layer in the half-open `rect` (world
	/// meters), in ascending order. The cost depends only on the number of instances nearby.
	Status added_in(std::uint16_t layer, const Rect &rect, std::vector<std::uint64_t> &r_ids) const;

	/// Returns an upper bound for the length of the basis columns of the layer's hand-placed
	/// instances, or 0 if there are none. It determines the search radius for instances that reach
	/// a position. It may be too large after instances were removed. Takes O(1) time.
	double max_added_scale(std::uint16_t layer) const;

	/// These methods return IDs in ascending order, of one layer, or of all layers if `layer` is
	/// negative.
	std::vector<std::uint64_t> removed_ids(int layer = -1) const;
	std::vector<std::uint64_t> added_ids(int layer = -1) const;
	std::vector<std::uint64_t> data_ids(int layer = -1) const;

	std::size_t removed_count() const;
	std::size_t added_count() const;
	std::size_t data_count() const;
	bool any_removed(std::uint16_t layer) const;

	/// Returns the revision of the last change, or 0 for a new state. It increases by at least 1
	/// with each change.
	std::uint64_t revision() const;

	/// Returns the state's clock in seconds.
	double time() const;

	/// Sets the number, called the name, that identifies this state to the states that apply its
	/// diffs. It should be random and different for every state. 0, the default, means no name:
	/// diffs are then unordered. The name is not saved.
	void set_origin(std::uint64_t name);
	std::uint64_t origin() const;

	/// Returns the last revision received from the state with the name `origin`, or 0 if there is
	/// none. `load` and `clear` reset it to 0. Only the 256 states that sent diffs most recently
	/// are remembered.
	std::uint64_t known_revision(std::uint64_t origin) const;

	/// Sets the stamp of a layer, which identifies its point set (see stamp_of). From then on,
	/// points with a different stamp are rejected for this layer. A layer above max_state_layer,
	/// and a layer that already has points with a different stamp, are errors that name `layer`.
	/// `cell_side` is the width in meters of the cells that IDs contain, or 0 if unknown. Limits
	/// and summaries of diffs need it to locate points. On each axis, `cells_together` consecutive
	/// cells, a power of two, denote the same position (see id_cell_side for surfaces).
	Status claim(std::uint16_t layer, std::uint64_t stamp, double cell_side = 0.0, std::int32_t cells_together = 1);

	/// Releases all claims. Layers without content lose their stamps, so that the state accepts
	/// another world.
	void release_claims();

	/// Returns the stamp of a layer, or 0 if it has none.
	std::uint64_t stamp(std::uint16_t layer) const;

	/// Returns true if `claim` would reject this stamp because the layer has points with a
	/// different one.
	bool is_foreign(std::uint16_t layer, std::uint64_t stamp) const;

	/// Removes an instance, permanently or, if `until` is above 0 and at most max_state_time, until
	/// the clock reaches it. A hand-placed instance is deleted along with its data, and `until` is
	/// ignored. Returns false if the instance does not exist or has already been removed; a new
	/// `until` is still applied.
	StateChange remove(std::uint64_t id, double until = 0.0);

	/// Undoes the removal of a point of the set. Has no effect if the point is not removed.
	StateChange restore(std::uint64_t id);

	/// Places an instance by hand. Its ID is a function of its content, so that peers that place
	/// the same instance get the same ID. If that ID is taken, the instance gets a free one (see
	/// free_id). A field outside the ranges of AddedInstance is an error that names the field; the
	/// state is then unchanged.
	Status add(const AddedInstance &instance, std::uint64_t &r_id);

	/// Places all of the instances or, if one is invalid, none. The IDs are the same as with
	/// repeated calls to `add`. Replaces `r_ids` with the IDs, in the order of the instances. If an
	/// instance is invalid, the size of `r_ids` is its index. The changes are appended to
	/// `r_changes`.
	Status add_all(std::span<const AddedInstance> instances, std::vector<std::uint64_t> &r_ids,
			std::vector<InstanceChange> &r_changes);

	/// Replaces an instance with `instance`, usually at a new position, and keeps its data. A
	/// hand-placed instance keeps its ID. A point of the set is removed permanently and replaced by
	/// a hand-placed instance. `r_id` becomes the ID after the move. The same values as in `add`
	/// are errors. An ID of another layer, a hand-placed instance that does not exist, and a
	/// removed point are errors that name `id`. After an error, the state is unchanged. The changes
	/// are appended to `r_changes`.
	Status move(std::uint64_t id, const AddedInstance &instance, std::uint64_t &r_id,
			std::vector<InstanceChange> &r_changes);

	/// Replaces the data of an instance with a copy of `bytes`; an empty span removes the data.
	/// More than max_instance_data bytes are an error that names `data`. A hand-placed instance
	/// that does not exist is an error that names `id`.
	Status set_data(std::uint64_t id, std::span<const std::uint8_t> bytes);

	/// Advances the clock by `seconds`, to at most max_state_time, and restores the points that are
	/// due by then. Has no effect if `seconds` is 0 or less. The changes are appended to
	/// `r_changes`.
	Status advance(double seconds, std::vector<InstanceChange> &r_changes);

	/// Clears everything except the claims and this state's name. The revision increases. The
	/// changes are appended to `r_changes`.
	Status clear(std::vector<InstanceChange> &r_changes);

	/// Replaces `r_bytes` with the serialized state, with a version and a checksum. The same
	/// content produces the same bytes on every machine. A million removed points of a layer take
	/// less than 4 MB, and far less if they are close together.
	Status save(std::vector<std::uint8_t> &r_bytes) const;

	/// Replaces the content of this state with the output of `save`. Truncated or damaged bytes,
	/// diffs and later versions are errors. Stamps that differ from those of claimed layers are
	/// errors that name `layer`. After an error, the state is unchanged. The changes are appended
	/// to `r_changes`.
	Status load(std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes);

	/// Replaces `r_bytes` with a diff for `apply`: the changes since a revision of this state,
	/// including restored IDs. If the log does not reach back that far, the diff contains the whole
	/// state. If this state has a name and `ordered` is true, the diff contains the name and both
	/// revisions.
	Status diff_since(std::uint64_t revision, std::vector<std::uint8_t> &r_bytes, bool ordered = true) const;

	/// Replaces `r_bytes` with a diff of the current content of some IDs. Applying the diff later
	/// restores that content, which makes undo steps possible.
	Status diff_of(std::span<const std::uint64_t> ids, std::vector<std::uint8_t> &r_bytes) const;

	/// Applies the output of another state's `diff_since`. The IDs in the diff take over their
	/// content from that state; all other IDs are unchanged. A diff that contains the whole state,
	/// and the output of `save`, replace everything, including the clock. Damaged bytes and foreign
	/// stamps are errors, as in `load`. Diffs that exceed the limits return ErrorCode::not_allowed.
	///
	/// Diffs of a named state are applied in order. A diff that ends at or before the last known
	/// revision is late or repeated and has no effect. A diff that begins after the last known
	/// revision is rejected (ErrorCode::out_of_order), because earlier diffs are missing.
	Status apply(
			std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes, const DiffLimits &limits = {});

	/// Checks whether diffs before this one are missing. If so, sets `r_missing` to true and
	/// `r_since` to the revision to pass to the sender's `diff_since`. The check reads only the
	/// header. Bytes without a valid header are an error.
	Status missing_before(std::span<const std::uint8_t> bytes, bool &r_missing, std::uint64_t &r_since) const;

	/// Summarizes a diff without changing the state. Bytes that are not a diff, and diffs that are
	/// too large for `limits`, are errors. After an error, `r_summary` contains only the numbers
	/// from the header.
	Status inspect(std::span<const std::uint8_t> bytes, DiffSummary &r_summary, const DiffLimits &limits = {}) const;

	/// Begins to apply a diff in three steps, so that a worker thread can do the slow part:
	/// queue_diff, PendingDiff::work and finish_pending_diff. The first step takes microseconds.
	/// `bytes` must outlive `r_diff`. Until a diff is finished, it has no effect on any query. The
	/// final result is the same as if `apply` had been called when the diff was queued: changes
	/// made in between are repeated after it. Hand-placed instances keep their IDs. While any diff
	/// is pending, do not call `apply`, `merge`, `merge_diff`, `load` or `clear`.
	Status queue_diff(
			std::span<const std::uint8_t> bytes, std::shared_ptr<PendingDiff> &r_diff, const DiffLimits &limits = {});

	/// Returns the first queued diff that is not finished, or null if there is none. It is the only
	/// diff for which PendingDiff::work may be called.
	std::shared_ptr<PendingDiff> pending_diff() const;

	/// Takes over the result of PendingDiff::work for the first queued diff, which must exist. The
	/// cost depends on the changes made since it was queued, not on the size of the diff. Replaces
	/// `r_changes`. The same diffs as in `apply` are errors, and so is a diff that contradicts a
	/// stamp claimed since it was queued. After an error, the diff has no effect.
	Status finish_pending_diff(StateChanges &r_changes);

	/// Merges the content of another state into this one. A point that either state has removed is
	/// removed, for the longer time. A hand-placed instance in either state is kept. If the data or
	/// content of an instance differ, the last write wins, according to the clock of the state that
	/// wrote it. At equal times, the greater bytes or numbers win. The later of the two clocks is
	/// kept, and points that are due by then are restored.
	///
	/// The order and number of merges do not matter: states that merged the same changes have the
	/// same content. Merging therefore restores an undone change from a state that still contains
	/// it: the removal of a restored point, a deleted hand-placed instance, or deleted data. Stamps
	/// that differ from this state's are errors that name `layer`.
	Status merge(const InstanceState &other, std::vector<InstanceChange> &r_changes);

	/// Merges the content of a diff or a saved state. Diffs may arrive in any order, repeatedly, or
	/// not at all. Restored points and deleted hand-placed instances in them have no effect. The
	/// clock advances by at most the limit. Damaged bytes, foreign stamps and diffs that exceed the
	/// limits are errors, as in `apply`. A whole state is merged, too, instead of replacing
	/// everything.
	Status merge_diff(
			std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes, const DiffLimits &limits = {});

	/// Returns a copy that shares this state's memory. Takes microseconds. Both states copy memory
	/// before they change it, so another thread may read the copy. The copy has no log of earlier
	/// changes. Call `complete` on it, on any thread, before `added_in` and before any change.
	InstanceState share();
	Status complete();

	/// Returns a hash of the content: FNV-1a of its bytes in the format of release 0.2.0, with the
	/// clock and stamps set to 0. Equal content has equal hashes, on every machine and in every
	/// version.
	std::uint64_t digest() const;

private:
	friend class PendingDiff;
	struct Content;
	struct Journal;

	explicit InstanceState(std::unique_ptr<Content> content);

	Status take_over(PendingDiff &diff, StateChanges &r_changes);
	void discard_first(PendingDiff &diff);
	Status repeat(const StateStep &step, std::vector<InstanceChange> &r_changes);
	StateChange put(std::uint64_t id, const AddedInstance &instance);
	void put_for(std::uint64_t id, std::uint64_t new_id, const AddedInstance &instance,
			std::vector<InstanceChange> &r_changes);

	std::unique_ptr<Content> content_;
	std::unique_ptr<Journal> journal_; ///< Null if no diff is pending.
};

} // namespace thicket
