#pragma once

#include "nodes/common/convert.hpp"

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <glm/vec3.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <vector>

namespace thicket {

/// The part of a ground node's state that can be checked without reading triangles.
struct GroundNodeState {
	godot::Transform3D frame; ///< The global transform.
	/// The ID of the object that defines the shape, such as a mesh; 0 if the node is not ground.
	std::uint64_t source = 0;
	/// The source's version, which increases with each change that the source reports.
	std::uint64_t version = 0;

	/// If neither node is ground, ignores the other members. Treats transforms that are not finite
	/// as equal; otherwise such a node would always seem changed, because NAN differs from itself.
	bool operator==(const GroundNodeState &other) const {
		const bool same_frame = frame == other.frame || !(is_finite(frame) || is_finite(other.frame));
		return source == other.source && (source == 0 || (version == other.version && same_frame));
	}
};

/// Returns true if both states describe the same ground in world space. Each state has its own
/// world position of the engine's origin. Tolerates the rounding errors that moving a scene causes.
bool same_in_world(const GroundNodeState &a, glm::dvec3 offset_a, const GroundNodeState &b, glm::dvec3 offset_b);

/// Detects nodes whose ground has changed by polling a limited number of them per frame, one after
/// another. Polling is necessary because the engine emits no usable signal when another node moves.
/// Use it only on the main thread.
class GroundWatch {
public:
	/// Returns a node's current state without the version. Sets `r_source` to the source, or leaves
	/// it null.
	using ReadState = std::function<GroundNodeState(const godot::Variant &p_node, godot::Object *&r_source)>;

	/// Connects the `changed` signal of each source to `p_method` of `p_owner`, with the source's
	/// ID as an argument. The owner must pass that ID to `source_changed`.
	GroundWatch(godot::Object *p_owner, const godot::StringName &p_method) : owner_(p_owner), method_(p_method) {}

	/// Starts watching a node. If `as_changed` is true, marks it as changed. Does nothing if the node
	/// is already watched.
	void add(std::uint64_t id, const godot::Variant &p_node, const ReadState &read_state, bool as_changed);

	/// Stops watching a node. If it was ground, marks it as changed; see `take_changed`.
	void remove(std::uint64_t id);

	/// Stops watching all nodes and disconnects from all sources.
	void clear();

	bool has(std::uint64_t id) const { return entries_.contains(id); }
	const godot::Variant *node(std::uint64_t id) const; ///< Returns null if the node is not watched.
	std::vector<std::uint64_t> ids() const;
	std::size_t size() const { return entries_.size(); }

	/// Checks the next nodes, up to nodes_per_frame. Returns their number.
	std::size_t check_next(const ReadState &read_state);

	/// Records that a source has changed. Nodes with this source are marked as changed at their
	/// next check. Ignores unknown sources.
	void source_changed(std::uint64_t source);
	std::uint64_t version(std::uint64_t source) const;

	/// Marks all nodes as changed. If `include_sources` is true, also marks all sources as changed.
	void mark_all_changed(bool include_sources);

	/// Returns true if any node has changed since the last `take_changed`.
	bool has_changes() const { return !changes_.empty(); }

	/// Returns the changed nodes that are due, including removed ones. Added and removed nodes are
	/// due after two physics frames. A node that was moved or reshaped is due once it is at rest,
	/// or after a maximum delay. The ground is therefore updated while a node is being dragged, but
	/// not in every frame. Such a node is returned again later.
	std::set<std::uint64_t> take_changed();

	/// Discards all detected changes.
	void forget_changes() { changes_.clear(); }

	static constexpr std::size_t nodes_per_frame = 64;

private:
	using Clock = std::chrono::steady_clock;

	struct Entry {
		godot::Variant node;
		GroundNodeState state;
	};

	struct Source {
		godot::Variant object;
		std::uint64_t version = 0;
		std::size_t users = 0;
	};

	/// A change to a node that `take_changed` must still return.
	struct Change {
		Clock::time_point first;
		Clock::time_point last;
		std::uint64_t frame = 0; ///< The physics frame of the last change.
		bool may_move = false;   ///< True if the node may keep changing; false if it was added or removed.
		bool is_at_rest = false; ///< True if the last check has found no change for `rest_time`.
	};

	/// Counts the nodes that use a source, which is watched while there are any.
	void use(std::uint64_t id, godot::Object *p_source);
	void drop(std::uint64_t id);
	void mark_changed(std::uint64_t id, bool may_move);
	void record_rest(std::uint64_t id);

	godot::Object *owner_;
	godot::StringName method_;
	std::map<std::uint64_t, Entry> entries_; ///< The watched nodes, keyed by their IDs.
	std::map<std::uint64_t, Source> sources_;
	std::map<std::uint64_t, Change> changes_;
	std::uint64_t next_id_ = 0;      ///< Checks continue at this ID or at the next larger one.
	std::uint64_t last_version_ = 0; ///< The last version that was assigned to a source.
};

} // namespace thicket
