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

/// False if any number of it is NAN or infinite.
bool is_finite(const godot::Transform3D &p_transform);

/// What can be seen of a node that gives ground without reading its triangles.
struct GroundSight {
	godot::Transform3D frame;  ///< In the engine's space.
	std::uint64_t source = 0;  ///< The object whose shape it is, a mesh for example, by its id; 0: no ground.
	std::uint64_t version = 0; ///< Of the source: another one after each change that it tells.

	/// Where there is no ground, nothing else counts. Frames that are not finite are alike: NAN differs from itself, and such a node would
	/// never come to rest.
	bool operator==(const GroundSight &other) const {
		const bool alike = frame == other.frame || !(is_finite(frame) || is_finite(other.frame));
		return source == other.source && (source == 0 || (version == other.version && alike));
	}
};

/// Whether two sights are of the same ground in the world, of which the engine's origin is at another offset for each; as far as the
/// engine's numbers tell, which lose some bits when a scene is moved.
bool same_in_world(const GroundSight &a, glm::dvec3 offset_a, const GroundSight &b, glm::dvec3 offset_b);

/// Looks at nodes that give ground, some in each frame in turn, and tells which of them are not as they were. The engine tells nobody
/// that a node of somebody else has moved, so there is no other way; the work of a frame does not grow with the nodes. Main thread only.
class GroundWatch {
public:
	/// What a node looks like now, but for the version. `r_source` becomes its source as an object, null for none.
	using Look = std::function<GroundSight(const godot::Variant &p_node, godot::Object *&r_source)>;

	/// Sources are heard: each `changed` calls `p_method` of `p_owner` with the source's id, which hands it to `source_changed`.
	GroundWatch(godot::Object *p_owner, const godot::StringName &p_method) : owner_(p_owner), method_(p_method) {}

	/// Watches a node from now on. `changed`: what it gives has to be read. Nothing happens if it is watched already.
	void add(std::uint64_t id, const godot::Variant &p_node, const Look &look, bool changed);

	/// No longer watches a node. Those that gave ground count as changed: see `take_changed`.
	void remove(std::uint64_t id);

	/// Forgets everything, and no longer listens.
	void clear();

	bool has(std::uint64_t id) const { return entries_.contains(id); }
	const godot::Variant *node(std::uint64_t id) const; ///< Null for one that is not watched.
	std::vector<std::uint64_t> ids() const;
	std::size_t size() const { return entries_.size(); }

	/// Looks at the next nodes, at most nodes_per_frame. Returns at how many.
	std::size_t look(const Look &look);

	/// A source has told of a change; those that use it follow when they are looked at. Nothing for one that none uses.
	void source_changed(std::uint64_t source);
	std::uint64_t version(std::uint64_t source) const;

	/// All nodes count as changed, however they look; `distrust`: and all sources.
	void touch_all(bool distrust);

	/// True while some have changed.
	bool restless() const { return !changed_.empty(); }

	/// True once what has changed is at rest, or has been waiting for long: a node that is dragged is followed, but not in each frame.
	bool due() const;

	/// Those that have changed since the last call, gone ones included. What is not at rest comes once more when it is.
	std::set<std::uint64_t> take_changed();

	/// All is known as it is now.
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
	std::map<std::uint64_t, Entry> entries_; ///< By the nodes' ids.
	std::map<std::uint64_t, Source> sources_;
	std::set<std::uint64_t> changed_;
	std::uint64_t next_ = 0;         ///< The id to look at next, or the next larger one.
	std::uint64_t versions_ = 0;     ///< So many were given to sources.
	std::size_t quiet_looks_ = 0;    ///< Since the last change that was seen.
	std::uint64_t change_frame_ = 0; ///< The engine's physics frame of the last change.
	Clock::time_point first_change_;
	Clock::time_point last_change_;
};

} // namespace thicket
