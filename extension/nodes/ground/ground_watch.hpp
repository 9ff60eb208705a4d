#pragma once

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

/// False if any of its numbers is NAN or infinite.
bool is_finite(const godot::Transform3D &p_transform);

/// The parts of a ground node's state that can be checked without reading its triangles.
struct GroundSight {
	godot::Transform3D frame;  ///< In the engine's space.
	std::uint64_t source = 0;  ///< The ID of the object with the shape, for example a mesh; 0 if there is no ground.
	std::uint64_t version = 0; ///< The source's version, which increases with each change that it reports.

	/// Without ground, compares nothing else. Frames that are not finite count as equal, because NAN differs from
	/// itself: the node would count as changed forever.
	bool operator==(const GroundSight &other) const {
		const bool alike = frame == other.frame || !(is_finite(frame) || is_finite(other.frame));
		return source == other.source && (source == 0 || (version == other.version && alike));
	}
};

/// True if both sights are of the same ground in the world. Each has its own offset of the engine's origin. Compares
/// within the engine's precision, because moving a scene loses some bits.
bool same_in_world(const GroundSight &a, glm::dvec3 offset_a, const GroundSight &b, glm::dvec3 offset_b);

/// Finds nodes whose ground has changed, by checking some of the nodes in each frame, in turn. The engine emits no
/// usable signal when another node moves. The work per frame does not grow with the number of nodes. Main thread only.
class GroundWatch {
public:
	/// Returns the node's current state except for the version. Sets `r_source` to its source as an object, or to null.
	using Look = std::function<GroundSight(const godot::Variant &p_node, godot::Object *&r_source)>;

	/// Connects to sources. Each `changed` calls `p_method` of `p_owner` with the source's ID, and the owner passes the
	/// ID to `source_changed`.
	GroundWatch(godot::Object *p_owner, const godot::StringName &p_method) : owner_(p_owner), method_(p_method) {}

	/// Watches a node from now on. If `changed` is true, its ground counts as changed. Does nothing if the node is
	/// already watched.
	void add(std::uint64_t id, const godot::Variant &p_node, const Look &look, bool changed);

	/// Stops watching a node. If it provided ground, it counts as changed: see `take_changed`.
	void remove(std::uint64_t id);

	/// Forgets everything and disconnects from all sources.
	void clear();

	bool has(std::uint64_t id) const { return entries_.contains(id); }
	const godot::Variant *node(std::uint64_t id) const; ///< Null for a node that is not watched.
	std::vector<std::uint64_t> ids() const;
	std::size_t size() const { return entries_.size(); }

	/// Checks the next nodes, at most nodes_per_frame. Returns the number of checked nodes.
	std::size_t look(const Look &look);

	/// Records that a source has changed. The nodes that use it count as changed when they are checked. Does nothing
	/// for an unused source.
	void source_changed(std::uint64_t source);
	std::uint64_t version(std::uint64_t source) const;

	/// Marks all nodes as changed; if `distrust`, all sources too.
	void touch_all(bool distrust);

	/// True while some nodes have changed.
	bool restless() const { return !changed_.empty(); }

	/// True once the changed nodes are at rest, or have waited for long. So the ground follows a node that is being
	/// dragged, but not in each frame.
	bool due() const;

	/// The nodes that have changed since the last call, including removed nodes. A node that is still moving is
	/// returned again once it is at rest.
	std::set<std::uint64_t> take_changed();

	/// Treats the current state as known.
	void forget_changes() { changed_.clear(); }

	static constexpr std::size_t nodes_per_frame = 64;

private:
	using Clock = std::chrono::steady_clock;

	struct Entry {
		godot::Variant node;
		GroundSight seen;
	};

	struct Source {
		godot::Variant object;
		std::uint64_t version = 0;
		std::size_t users = 0;
	};

	bool rests() const;
	void use(std::uint64_t id, godot::Object *p_source);
	void drop(std::uint64_t id);
	void touch(std::uint64_t id);

	godot::Object *owner_;
	godot::StringName method_;
	std::map<std::uint64_t, Entry> entries_; ///< By the nodes' IDs.
	std::map<std::uint64_t, Source> sources_;
	std::set<std::uint64_t> changed_;
	std::uint64_t next_ = 0;         ///< The next ID to check, or the smallest larger one.
	std::uint64_t versions_ = 0;     ///< The number of versions given to sources until now.
	std::size_t quiet_looks_ = 0;    ///< Checks since the last detected change.
	std::uint64_t change_frame_ = 0; ///< The engine's physics frame of the last change.
	Clock::time_point first_change_;
	Clock::time_point last_change_;
};

} // namespace thicket
