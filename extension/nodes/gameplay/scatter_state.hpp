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

/// The changes of one call.
using SharedChanges = std::shared_ptr<const StateChanges>;

class ScatterState;

/// Passed as the time at which a removed point grows again, in place of a time of the state (from 0, never, on): the
/// layer's own regrowth time.
constexpr double regrowth_of_layer = -1.0;

/// A node that uses a ScatterState. The state notifies it of every change. The node itself makes the changes of
/// instances whose layers it displays.
class StateListener {
public:
	virtual ~StateListener() = default;

	/// True if the node displays the layer of this instance. The node then makes the changes of the instance, because
	/// it knows whether the instance exists.
	virtual bool displays(std::uint64_t id) const = 0;

	// Makes a change by the rules of the node's own methods. Runs scripts.
	virtual bool remove_from(const ScatterState *state, std::uint64_t id, double until) = 0;
	virtual bool restore_in(const ScatterState *state, std::uint64_t id) = 0;
	virtual bool set_data_in(const ScatterState *state, std::uint64_t id, const godot::Variant &p_data) = 0;

	/// The node's layers at present.
	virtual SharedLayers layers() const = 0;

	/// Called before the call that made the changes returns. Runs no script.
	virtual void state_changed(const SharedChanges &changes) = 0;

	/// Called after all earlier changes have been reported and their handlers have returned. Notifies scripts, which
	/// may change or free anything.
	virtual void tell_changes(const SharedChanges &changes) = 0;

protected:
	StateListener() = default;
	StateListener(const StateListener &) = default;
	StateListener &operator=(const StateListener &) = default;
};

/// A point of a set to remove, and the time when it grows again (0 for never).
struct Removal {
	std::uint64_t id = 0;
	double until = 0.0;
};

/// A game's changes of a scattered world: removed and hand-placed instances, and data. A resource to save, and bytes to send.
class ScatterState : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterState, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// Assigns a random origin number to the state, so that no other state has it. States that apply its diffs identify
	/// it by this number.
	ScatterState();
	~ScatterState() override;

	// Changes of an instance. If a node in the tree displays the instance's layer, the node makes the change by the
	// rules of its own methods. Otherwise the change is recorded for the ID alone, whether such an instance exists or
	// not.

	/// See InstanceState::remove. `until` is a time of get_time in seconds, 0 to max_state_time. 0 means forever;
	/// regrowth_of_layer also means forever if there is no node. Returns false for an ID of 0.
	bool remove(int64_t p_id, double p_until = regrowth_of_layer);
	bool restore(int64_t p_id);

	/// Sets any Variant but an object, of at most max_instance_data bytes; null deletes the data. Objects inside the
	/// value become numbers. Returns false, with an error, for anything else.
	bool set_instance_data(int64_t p_id, const godot::Variant &p_data);

	bool is_removed(int64_t p_id) const;
	godot::Variant get_instance_data(int64_t p_id) const;

	/// Ascending. `p_layers` is as in find_layers; names refer to the layers of nodes that use the state.
	godot::PackedInt64Array get_removed(const godot::Variant &p_layers) const;
	godot::PackedInt64Array get_added(const godot::Variant &p_layers) const;
	int64_t get_removed_count() const;
	int64_t get_added_count() const;

	/// Replaces all content with bytes from to_bytes. On failure, changes nothing.
	godot::Error from_bytes(const godot::PackedByteArray &p_bytes);
	godot::PackedByteArray to_bytes() const;

	/// Saves the result of to_bytes to a file: see replace_file. On failure, prints an error and leaves the old file unchanged.
	godot::Error save_to_file(const godot::String &p_path) const;

	/// Replaces all content with a file from save_to_file. On failure, prints an error and changes nothing.
	godot::Error load_from_file(const godot::String &p_path);

	/// Creates a diff for a peer that has this state as of `revision`; if `p_ordered` is false, for a save.
	godot::PackedByteArray diff_since(int64_t p_revision, bool p_ordered = true) const;

	/// The current changes of some instances, as a diff that restores them.
	godot::PackedByteArray diff_of(const godot::PackedInt64Array &p_ids) const;
	godot::Error apply_diff(const godot::PackedByteArray &p_diff);

	/// Applies a diff on a thread, with the same result as an immediate call: see InstanceState::queue_diff. The
	/// callback gets the error. Calls that would replace or merge a large amount of content wait for all diffs in
	/// progress.
	void apply_diff_async(const godot::PackedByteArray &p_diff, const godot::Callable &p_callback = godot::Callable());
	godot::Error merge(const godot::Ref<ScatterState> &p_other);
	godot::Error merge_diff(const godot::PackedByteArray &p_diff);
	void clear();

	/// Sets the limits for apply_diff, apply_diff_async and merge_diff. Null for the limits that suit a client of a
	/// server (see DiffLimits).
	void set_diff_limits(const godot::Ref<ScatterDiffLimits> &p_limits);
	godot::Ref<ScatterDiffLimits> get_diff_limits() const { return diff_limits_; }

	/// See InstanceState::inspect. Includes the error that apply_diff would return.
	godot::Dictionary inspect_diff(const godot::PackedByteArray &p_diff) const;

	/// See InstanceState::origin and known_revision.
	int64_t get_origin() const;
	int64_t get_known_revision(int64_t p_origin) const;

	/// If diffs before this one are missing, returns the revision to pass to the sender's diff_since; otherwise -1.
	int64_t get_missing_since(const godot::PackedByteArray &p_diff) const;

	int64_t get_revision() const;
	int64_t get_digest() const;

	/// Seconds of play. Removed instances grow again at times on this clock. A TerrainScatter3D advances it.
	double get_time() const;
	void advance(double p_seconds);

	/// Advances the time for nodes: if several nodes share the state, only one of them advances it in each frame.
	void advance_in_frame(double seconds, std::uint64_t frame);

	/// The stored form; empty if there are no changes. Only the resource's file has this property.
	void set_data(const godot::PackedByteArray &p_bytes);
	godot::PackedByteArray get_data() const;

	/// True if a designer created the state, so that a running game changes a copy.
	void set_copy_at_runtime(bool p_copy_at_runtime) { copy_at_runtime_ = p_copy_at_runtime; }
	bool is_copied_at_runtime() const { return copy_at_runtime_; }

	/// Warns once if `load()` would return this same object. A game would then get its unsaved progress instead of the
	/// saved state.
	void warn_if_cached();

	/// Returns a state with this content, but without a file and without the flag copy_at_runtime.
	godot::Ref<ScatterState> copy() const;

	void _reset_state() override { clear(); }

	// For nodes, which have made sure that the instance exists.
	bool restore_by_id(std::uint64_t id);
	bool set_data_by_id(std::uint64_t id, const godot::Variant &p_data);
	const InstanceState &state() const { return state_; }

	/// See InstanceState::share.
	InstanceState share() { return state_.share(); }
	Status add(const AddedInstance &instance, std::uint64_t &r_id);

	/// See InstanceState::add_all. Reports all instances after that.
	Status add_all(std::span<const AddedInstance> instances, std::vector<std::uint64_t> &r_ids);

	/// See InstanceState::move.
	Status move(std::uint64_t id, const AddedInstance &instance, std::uint64_t &r_id);

	/// Removes all instances, then reports all of them. Returns the IDs of those that existed.
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
	/// Limits for diffs from others.
	DiffLimits limits() const { return diff_limits_.is_valid() ? diff_limits_->limits() : DiffLimits(); }

	/// The changes that listeners have applied and that scripts have not been notified of.
	struct Untold {
		SharedChanges changes;          ///< Null if there are none.
		std::shared_ptr<DiffTask> diff; ///< Null for a change that was made immediately.
		godot::Error error = godot::OK; ///< For the diff's callback.
	};

	/// Updates the listeners, lets them notify scripts, and emits `instances_changed(ids)` and `changed`. Changes that
	/// handlers make are reported afterwards, in order, so that the stack does not grow.
	void tell(std::vector<InstanceChange> changes);
	void follow(Untold untold);
	void tell_untold();
	void tell_now(const Untold &untold);
	std::vector<std::shared_ptr<StateListener>> listeners() const;

	/// The node that makes changes of an instance; null if there is none.
	std::shared_ptr<StateListener> node_for(std::uint64_t id) const;

	godot::PackedInt64Array ids_of(const char *p_method, const godot::Variant &p_layers,
			std::vector<std::uint64_t> (InstanceState::*ids)(int) const) const;

	/// Finds the IDs of layers, ascending; empty for all layers. Returns false, with an error, for a value that refers
	/// to no layer.
	bool find_layer_ids(const char *p_method, const godot::Variant &p_layers, std::vector<int> &r_ids) const;
	godot::Ref<ScatterLayer> layer_with_id(std::uint16_t layer_id) const;
	godot::TypedArray<ScatterLayer> layers_of_nodes() const;

	/// Starts the first diff, if it is not in progress.
	void start_diff();
	void finish_first_diff();

	/// Applies all diffs that are done, and notifies scripts.
	void finish_diffs();

	/// Waits for all diffs and applies them. Scripts are notified together with the next report.
	void wait_for_diffs();

	InstanceState state_;
	godot::Ref<ScatterDiffLimits> diff_limits_;
	std::vector<std::weak_ptr<StateListener>> listeners_;
	std::deque<Untold> untold_;
	std::deque<std::shared_ptr<DiffTask>> diffs_; ///< In the order of the calls. The first is in progress.
	Leavings leavings_;
	bool telling_ = false;
	bool copy_at_runtime_ = false;
	bool warned_ = false; ///< See warn_if_cached.
	const godot::StringName instances_changed_ =
			"instances_changed"; ///< The signal. The name is stored, because creating one costs as much as a removal.
	std::uint64_t frame_ = std::numeric_limits<std::uint64_t>::max(); ///< The last frame that advanced the clock.
};

} // namespace thicket
