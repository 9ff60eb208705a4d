#pragma once

#include "core/state/instance_state.hpp"
#include "core/state/state_changes.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/common/renames.hpp"
#include "nodes/gameplay/diff_task.hpp"
#include "nodes/gameplay/scatter_diff_limits.hpp"
#include "nodes/layer/layer_reference.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The changes that one call made.
using SharedChanges = std::shared_ptr<const StateChanges>;

class ScatterState;

/// A value for `until` parameters: the removed instance grows again after its layer's regrowth
/// time. All other values are times on the state's clock, or 0 for never.
constexpr double regrowth_of_layer = -1.0;

/// A node that uses a ScatterState. The state notifies the node of every change and delegates
/// changes to instances whose layers the node displays.
class StateListener {
public:
	virtual ~StateListener() = default;

	/// Returns true if the node displays the layer of this instance. The state then delegates
	/// changes to the instance to the node, which can check whether the instance exists.
	virtual bool displays(std::uint64_t id) const = 0;

	// These methods do the same as the node's public methods. They return true if anything changed.
	// `state` must be the node's state. They may run user scripts.
	virtual bool remove_from(const ScatterState *state, std::uint64_t id, double until) = 0;
	virtual bool restore_in(const ScatterState *state, std::uint64_t id) = 0;
	virtual bool set_data_in(const ScatterState *state, std::uint64_t id, const godot::Variant &p_data) = 0;

	/// Returns the node's current layers.
	virtual SharedLayers layers() const = 0;

	/// Updates the node after `changes`. The state calls this before the call that made the changes
	/// returns. Runs no scripts.
	virtual void state_changed(const SharedChanges &changes) = 0;

	/// Notifies scripts of `changes`. The state calls this after all earlier changes have been
	/// reported and their signal handlers have returned. Scripts may change or free anything.
	virtual void notify_changes(const SharedChanges &changes) = 0;

protected:
	StateListener() = default;
	StateListener(const StateListener &) = default;
	StateListener &operator=(const StateListener &) = default;
};

/// An instance to remove, and the time when it grows again (0 for never).
struct Removal {
	std::uint64_t id = 0;
	double until = 0.0;
};

/// A game's changes to a scattered world: removed and hand-placed instances, and instance data. Can
/// be saved as a resource or file and sent to peers as bytes.
class ScatterState : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterState, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// Assigns a random, unique origin ID. Other states that apply diffs of this state identify it
	/// by that ID.
	ScatterState();
	~ScatterState() override;

	// These methods change an instance. If a node in the tree displays the instance's layer, the
	// node makes the change as if one of its methods were called. Otherwise the state records the
	// change for the ID, even if no such instance exists.

	/// Removes an instance; see InstanceState::remove. `until` is the time in seconds when the
	/// instance grows again, on the clock of get_time, 0 to max_state_time; 0 means never. Without
	/// a node, regrowth_of_layer means never as well. Returns false for an ID of 0.
	bool remove(int64_t p_id, double p_until = regrowth_of_layer);
	bool restore(int64_t p_id);

	/// Sets the data of an instance: any Variant except an object, of at most max_instance_data
	/// bytes. Null deletes the data. Objects inside the value become numbers. If the data are
	/// invalid, prints an error and returns false.
	bool set_instance_data(int64_t p_id, const godot::Variant &p_data);

	bool is_removed(int64_t p_id) const;
	godot::Variant get_instance_data(int64_t p_id) const;

	/// Returns the IDs of removed instances in ascending order. For `p_layers`, see find_layers.
	/// Names refer to the layers of nodes that use the state.
	godot::PackedInt64Array get_removed(const godot::Variant &p_layers) const;
	godot::PackedInt64Array get_added(const godot::Variant &p_layers) const;
	int64_t get_removed_count() const;
	int64_t get_added_count() const;

	/// Replaces all content with bytes from to_bytes. On failure, prints an error and leaves the
	/// state unchanged.
	godot::Error from_bytes(const godot::PackedByteArray &p_bytes);
	godot::PackedByteArray to_bytes() const;

	/// Saves the result of to_bytes to a file (see replace_file). On failure, prints an error and
	/// leaves the old file unchanged.
	godot::Error save_to_file(const godot::String &p_path) const;

	/// Replaces all content with a file from save_to_file. On failure, prints an error and leaves
	/// the state unchanged.
	godot::Error load_from_file(const godot::String &p_path);

	/// Creates a diff for a peer whose copy of this state has the revision `p_revision`. Set
	/// `p_ordered` to false if the diff is for a saved game instead.
	godot::PackedByteArray diff_since(int64_t p_revision, bool p_ordered = true) const;

	/// Creates a diff that restores the current changes of some instances.
	godot::PackedByteArray diff_of(const godot::PackedInt64Array &p_ids) const;
	godot::Error apply_diff(const godot::PackedByteArray &p_diff);

	/// Applies a diff on a thread, with the same result as an immediate call (see
	/// InstanceState::queue_diff). The callback receives the error. Calls that may replace or merge
	/// a large amount of content wait for all diffs in progress.
	void apply_diff_async(const godot::PackedByteArray &p_diff, const godot::Callable &p_callback = godot::Callable());
	godot::Error merge(const godot::Ref<ScatterState> &p_other);
	godot::Error merge_diff(const godot::PackedByteArray &p_diff);
	void clear();

	/// Sets the limits for apply_diff, apply_diff_async and merge_diff. Null selects the defaults
	/// of DiffLimits, which suit a client of a server.
	void set_diff_limits(const godot::Ref<ScatterDiffLimits> &p_limits);
	godot::Ref<ScatterDiffLimits> get_diff_limits() const { return diff_limits_; }

	/// Describes a diff without applying it; see InstanceState::inspect. The result includes the
	/// error that apply_diff would return.
	godot::Dictionary inspect_diff(const godot::PackedByteArray &p_diff) const;

	/// These methods return the IDs by which diffs identify states; see InstanceState::origin and
	/// known_revision.
	int64_t get_origin() const;
	int64_t get_known_revision(int64_t p_origin) const;

	/// Returns the revision to pass to the sender's diff_since if diffs before this one are
	/// missing; otherwise -1.
	int64_t get_missing_since(const godot::PackedByteArray &p_diff) const;

	int64_t get_revision() const;
	int64_t get_digest() const;

	/// Returns the state's clock in seconds, by which removed instances grow again. A
	/// TerrainScatter3D advances the clock.
	double get_time() const;
	void advance(double p_seconds);

	/// Advances the clock by `seconds`, but only once per `frame`, so that several nodes can share
	/// the state.
	void advance_in_frame(double seconds, std::uint64_t frame);

	/// Sets the content in the form in which the resource's file stores it. The array is empty if
	/// there are no changes.
	void set_data(const godot::PackedByteArray &p_bytes);
	godot::PackedByteArray get_data() const;

	/// Sets whether a running game changes a copy of the state. True for a state that was authored
	/// in the editor.
	void set_copy_at_runtime(bool p_copy_at_runtime) { copy_at_runtime_ = p_copy_at_runtime; }
	bool is_copied_at_runtime() const { return copy_at_runtime_; }

	/// Warns once if `load()` would return this object from the cache. A game that reloads it would
	/// get its unsaved progress instead of the saved state.
	void warn_if_cached();

	/// Returns a state with the same content and limits, but without a file and without the flag
	/// copy_at_runtime.
	godot::Ref<ScatterState> copy() const;

	void _reset_state() override { clear(); }

	// Only nodes call the following functions, after they have checked that the instance exists.
	bool restore_by_id(std::uint64_t id);
	bool set_data_by_id(std::uint64_t id, const godot::Variant &p_data);
	const InstanceState &state() const { return state_; }

	/// Returns a copy that shares unchanged content; see InstanceState::share.
	InstanceState share() { return state_.share(); }
	Status add(const AddedInstance &instance, std::uint64_t &r_id);

	/// Adds hand-placed instances; see InstanceState::add_all. Reports the changes after all
	/// instances have been placed.
	Status add_all(std::span<const AddedInstance> instances, std::vector<std::uint64_t> &r_ids);

	/// Moves an instance; see InstanceState::move.
	Status move(std::uint64_t id, const AddedInstance &instance, std::uint64_t &r_id);

	/// Removes all instances, then reports the changes. Returns the IDs of the instances that had
	/// not been removed already.
	std::vector<std::uint64_t> remove_all(std::span<const Removal> removals);
	Status claim(std::uint16_t layer, std::uint64_t stamp, double cell_side, std::int32_t cells_together) {
		return state_.claim(layer, stamp, cell_side, cells_together);
	}
	void add_listener(const std::shared_ptr<StateListener> &listener);
	void remove_listener(const StateListener *listener);

protected:
	static void _bind_methods();
	bool _set(const godot::StringName &p_name, const godot::Variant &p_value) {
		return set_renamed(this, p_name, p_value);
	}

private:
	/// Returns the limits for diffs from peers.
	DiffLimits limits() const { return diff_limits_.is_valid() ? diff_limits_->limits() : DiffLimits(); }

	/// Changes that listeners have applied but scripts have not been notified of yet.
	struct UnreportedChanges {
		SharedChanges changes; ///< The changes; null if there are none.
		/// The diff that made the changes. Null for changes that were made immediately.
		std::shared_ptr<DiffTask> diff;
		godot::Error error = godot::OK; ///< The argument of the diff's callback.
	};

	/// Updates the listeners, lets them notify scripts, and emits `instances_changed(ids)` and
	/// `changed`. Changes that signal handlers make are queued and reported afterward, in order, to
	/// avoid recursion.
	void notify(std::vector<InstanceChange> changes);
	void update_listeners(UnreportedChanges unreported);
	void notify_scripts();
	void report_now(const UnreportedChanges &unreported);
	std::vector<std::shared_ptr<StateListener>> listeners() const;

	/// Returns the node that makes changes to an instance for this state; null if there is none.
	std::shared_ptr<StateListener> node_for(std::uint64_t id) const;

	godot::PackedInt64Array ids_of(const char *p_method, const godot::Variant &p_layers,
			std::vector<std::uint64_t> (InstanceState::*list_ids)(int) const) const;

	/// Finds the IDs of layers, in ascending order; empty for all layers. If the value refers to no
	/// layer, prints an error and returns false.
	bool find_layer_ids(const char *p_method, const godot::Variant &p_layers, std::vector<int> &r_ids) const;
	godot::Ref<ScatterLayer> layer_with_id(std::uint16_t layer_id) const;
	godot::TypedArray<ScatterLayer> layers_of_nodes() const;

	/// Starts processing the first diff in the queue, if there is one. If it cannot be processed,
	/// schedules `finish_diffs`, which reports its error.
	void start_diff();
	void finish_first_diff();

	/// Applies the first diff in the queue if its processing is done, starts the next one, and
	/// notifies scripts.
	void finish_diffs();

	/// Waits for all diffs and applies them. The next call to `notify` notifies scripts of the
	/// changes.
	void wait_for_diffs();

	InstanceState state_;
	godot::Ref<ScatterDiffLimits> diff_limits_;
	std::vector<std::weak_ptr<StateListener>> listeners_;
	std::deque<UnreportedChanges> unreported_;
	/// The diffs whose callbacks have not been called yet, in the order in which they were queued.
	/// Only the first is in progress.
	std::deque<std::shared_ptr<DiffTask>> diffs_;
	DeferredFree deferred_free_;
	bool notifying_ = false;
	bool copy_at_runtime_ = false;
	bool has_warned_ = false; ///< True once warn_if_cached has printed its warning.
	/// The signal's name, which is stored because creating a StringName costs as much as removing
	/// an instance.
	const godot::StringName instances_changed_ = "instances_changed";
	/// The last frame that advanced the clock.
	std::uint64_t frame_ = std::numeric_limits<std::uint64_t>::max();
};

} // namespace thicket
