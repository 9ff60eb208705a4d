#pragma once

#include "core/state/instance_state.hpp"
#include "core/state/state_changes.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/common/renames.hpp"
#include "nodes/gameplay/diff_task.hpp"
#include "nodes/gameplay/scatter_diff_limits.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The changes of one call.
using SharedChanges = std::shared_ptr<const StateChanges>;

/// Hears of every change of a ScatterState.
class StateListener {
public:
	virtual ~StateListener() = default;

	/// Before the call returns that has made the changes. Runs no script.
	virtual void state_changed(const SharedChanges &changes) = 0;

	/// Once all changes before these were told, and the scripts that heard of them have returned: to tell scripts, which may
	/// change or free anything.
	virtual void tell_changes(const SharedChanges &changes) = 0;

protected:
	StateListener() = default;
	StateListener(const StateListener &) = default;
	StateListener &operator=(const StateListener &) = default;
};

/// A point of a set to remove, and when it grows again (0 for never).
struct Removal {
	std::uint64_t id = 0;
	double until = 0.0;
};

/// What a game has changed about a scattered world: removed and hand-placed instances, and data. A resource to save, and bytes to send.
class ScatterState : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterState, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// Names itself to states that will apply its diffs, by a number that no other state has.
	ScatterState();
	~ScatterState() override;

	/// See InstanceState::remove. `until` is in seconds of get_time, 0 to max_state_time; 0 for ever. False for an id of 0.
	bool remove(int64_t p_id, double p_until = 0.0);
	bool restore(int64_t p_id);
	bool is_removed(int64_t p_id) const;

	/// Any Variant but an object, at most max_instance_data as bytes; null to forget. An object within it becomes a number. False, with
	/// an error, for anything else.
	bool set_instance_data(int64_t p_id, const godot::Variant &p_data);
	godot::Variant get_instance_data(int64_t p_id) const;

	/// Ascending; of one layer_id or, for -1, of all.
	godot::PackedInt64Array get_removed(int64_t p_layer_id = -1) const;
	godot::PackedInt64Array get_added(int64_t p_layer_id = -1) const;
	int64_t get_removed_count() const;
	int64_t get_added_count() const;

	/// What to_bytes wrote, in place of all that is here. After an error nothing has changed.
	godot::Error from_bytes(const godot::PackedByteArray &p_bytes);
	godot::PackedByteArray to_bytes() const;

	/// What to_bytes returns, as a file: see replace_file. An error is printed, and leaves the old file as it was.
	godot::Error save_to_file(const godot::String &p_path) const;

	/// What save_to_file wrote, in place of all that is here. After an error, which is printed, nothing has changed.
	godot::Error load_from_file(const godot::String &p_path);

	/// For a peer that knows this state as it was at `revision`, or for a save if not ordered.
	godot::PackedByteArray diff_since(int64_t p_revision, bool p_ordered = true) const;

	/// What is held of some instances now, as a diff that makes them so again.
	godot::PackedByteArray diff_of(const godot::PackedInt64Array &p_ids) const;
	godot::Error apply_diff(const godot::PackedByteArray &p_diff);

	/// The same on a thread, as if at once: see InstanceState::queue_diff. The callback gets the error. What else would replace or
	/// merge very much waits for all diffs that are under way.
	void apply_diff_async(const godot::PackedByteArray &p_diff, const godot::Callable &p_callback = godot::Callable());
	godot::Error merge(const godot::Ref<ScatterState> &p_other);
	godot::Error merge_diff(const godot::PackedByteArray &p_diff);
	void clear();

	/// Bounds apply_diff, apply_diff_async and merge_diff; null for bounds that suit a client of a server (see DiffLimits).
	void set_diff_limits(const godot::Ref<ScatterDiffLimits> &p_limits);
	godot::Ref<ScatterDiffLimits> get_diff_limits() const { return diff_limits_; }

	/// See InstanceState::inspect; with the error of apply_diff for it.
	godot::Dictionary inspect_diff(const godot::PackedByteArray &p_diff) const;

	/// See InstanceState::origin, and known_revision.
	int64_t get_origin() const;
	int64_t get_known_revision(int64_t p_origin) const;

	/// The revision for the sender's diff_since if diffs are missing before this one, otherwise -1.
	int64_t get_missing_since(const godot::PackedByteArray &p_diff) const;

	int64_t get_revision() const;
	int64_t get_digest() const;

	/// Seconds of play, by which what is removed grows again. A TerrainScatter3D moves it on.
	double get_time() const;
	void advance(double p_seconds);

	/// The same for nodes: of all that share the state, only one moves it on in a frame.
	void advance_in_frame(double seconds, std::uint64_t frame);

	/// The stored form, empty where there is nothing: a property that only the resource's file has.
	void set_data(const godot::PackedByteArray &p_bytes);
	godot::PackedByteArray get_data() const;

	/// Whether a designer has made it, so that a running game changes a copy.
	void set_copy_at_runtime(bool p_copy_at_runtime) { copy_at_runtime_ = p_copy_at_runtime; }
	bool is_copied_at_runtime() const { return copy_at_runtime_; }

	/// Warns, once, where `load()` would return this same object: a game that loads what it has saved gets what it has played since.
	void warn_if_cached();

	/// The same content, of no file and not a designer's.
	godot::Ref<ScatterState> copy() const;

	void _reset_state() override { clear(); }

	// For nodes.
	const InstanceState &state() const { return state_; }

	/// See InstanceState::share.
	InstanceState share() { return state_.share(); }
	Status add(const AddedInstance &instance, std::uint64_t &r_id);

	/// See InstanceState::add_all. Tells of all of them after that.
	Status add_all(std::span<const AddedInstance> instances, std::vector<std::uint64_t> &r_ids);

	/// See InstanceState::move.
	Status move(std::uint64_t id, const AddedInstance &instance, std::uint64_t &r_id);

	/// Removes all of them, then tells of all of them. The ids of those that stood.
	std::vector<std::uint64_t> remove_all(std::span<const Removal> removals);
	Status claim(std::uint16_t layer, std::uint64_t stamp, double cell_side) {
		return state_.claim(layer, stamp, cell_side);
	}
	void add_listener(const std::shared_ptr<StateListener> &listener);
	void remove_listener(const StateListener *listener);

protected:
	static void _bind_methods();
	bool _set(const godot::StringName &p_name, const godot::Variant &p_value) {
		return set_renamed(this, p_name, p_value);
	}

private:
	/// For diffs of others.
	DiffLimits limits() const { return diff_limits_.is_valid() ? diff_limits_->limits() : DiffLimits(); }

	/// What listeners have followed, and scripts have not heard of.
	struct Untold {
		SharedChanges changes;          ///< Null for none.
		std::shared_ptr<DiffTask> diff; ///< Null for what was done at once.
		godot::Error error = godot::OK; ///< For the diff's callback.
	};

	/// Lets the listeners follow, then has them tell, and emits `instances_changed(ids)` and `changed`. What handlers change in turn
	/// is told after that, in order: the stack does not grow.
	void tell(std::vector<InstanceChange> changes);
	void follow(Untold untold);
	void tell_untold();
	void tell_now(const Untold &untold);
	std::vector<std::shared_ptr<StateListener>> listeners() const;

	/// Goes on with the first diff, if it is not under way.
	void start_diff();
	void finish_first_diff();

	/// Takes over all diffs that are done: scripts hear of it.
	void finish_diffs();

	/// Waits for all of them and takes them over. Scripts hear of it with what is told next.
	void wait_for_diffs();

	InstanceState state_;
	godot::Ref<ScatterDiffLimits> diff_limits_;
	std::vector<std::weak_ptr<StateListener>> listeners_;
	std::deque<Untold> untold_;
	std::deque<std::shared_ptr<DiffTask>> diffs_; ///< In the order of the calls. The first is under way.
	Leavings leavings_;
	bool telling_ = false;
	bool copy_at_runtime_ = false;
	bool warned_ = false; ///< See warn_if_cached.
	const godot::StringName instances_changed_ =
			"instances_changed"; ///< The signal: making a name costs as much as a removal.
	std::uint64_t frame_ = std::numeric_limits<std::uint64_t>::max(); ///< The last in which a node moved the clock on.
};

} // namespace thicket
