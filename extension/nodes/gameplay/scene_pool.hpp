#pragma once

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/classes/packed_scene.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// A node that scripts may free at any time.
class NodeHandle {
public:
	NodeHandle() = default;
	explicit NodeHandle(const godot::Node3D *node) : node_(node) {}

	/// Null once the node was freed.
	godot::Node3D *get() const { return godot::Object::cast_to<godot::Node3D>(node_.get_validated_object()); }

private:
	godot::Variant node_;
};

/// Instances of scenes that nobody needs for now. They are kept outside of the tree: there, whatever is in a scene, nothing of it is
/// seen, heard, hit or processed. Main thread only.
class ScenePool {
public:
	ScenePool() = default;
	~ScenePool() { clear(); }
	ScenePool(const ScenePool &) = delete;
	ScenePool &operator=(const ScenePool &) = delete;

	/// An instance outside of the tree, the caller's: one that was given back, or a new one. Null if the scene is empty or its root is
	/// no Node3D. Making one runs scripts.
	godot::Node3D *take(const godot::Ref<godot::PackedScene> &scene);

	/// Takes an instance of the scene in, out of the tree by now; discards it where there are `max_idle` of that scene already.
	void give(const godot::Ref<godot::PackedScene> &scene, godot::Node3D *node);

	/// Takes a node in that is never used again; `free_some` frees it.
	void discard(godot::Node3D *node);

	/// Frees at most `freed_per_frame` discarded nodes. To be called once a frame: the engine frees them at its end, when no clock of ours
	/// runs.
	void free_some();
	static constexpr int freed_per_frame = 4;

	/// Frees a node at the end of the frame, not at once: a script of it may be on the stack.
	static void dispose(const NodeHandle &handle);

	/// Discards the instances of all other scenes.
	void keep_only(std::span<const godot::Ref<godot::PackedScene>> scenes);

	/// Frees all nodes at the end of this frame.
	void clear();

	/// Instances that wait, of all scenes. Those that a script has freed count until they are met.
	std::size_t idle_count() const;

	/// The most instances of a scene that wait to be used again.
	static constexpr std::size_t max_idle = 64;

private:
	struct Idle {
		godot::Ref<godot::PackedScene> scene;
		std::vector<NodeHandle> nodes;
	};

	std::vector<Idle> idle_; ///< As many as there are scenes: a few.
	std::vector<NodeHandle> discarded_;
};

} // namespace thicket
