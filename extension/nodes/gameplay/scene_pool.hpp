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

/// Instances of scenes that are currently not needed. They are kept outside of the tree, so no part of a scene is
/// drawn, heard, hit or processed. Main thread only.
class ScenePool {
public:
	ScenePool() = default;
	~ScenePool() { clear(); }
	ScenePool(const ScenePool &) = delete;
	ScenePool &operator=(const ScenePool &) = delete;

	/// Returns an instance outside of the tree, pooled or new, which the caller owns. Null if the scene is empty or its
	/// root is not a Node3D. Creating an instance runs scripts.
	godot::Node3D *take(const godot::Ref<godot::PackedScene> &scene);

	/// Returns an instance of the scene to the pool. It must already be out of the tree. If the pool has `max_idle`
	/// instances of that scene, discards it.
	void give(const godot::Ref<godot::PackedScene> &scene, godot::Node3D *node);

	/// Takes a node that is never used again; `free_some` frees it.
	void discard(godot::Node3D *node);

	/// Frees at most `freed_per_frame` discarded nodes. Call it once per frame. The engine frees them at the end of the
	/// frame, which our time measurements do not include.
	void free_some();
	static constexpr int freed_per_frame = 4;

	/// Frees a node at the end of the frame, not immediately, because one of its scripts may be on the stack.
	static void dispose(const NodeHandle &handle);

	/// Discards the instances of all other scenes.
	void keep_only(std::span<const godot::Ref<godot::PackedScene>> scenes);

	/// Frees all nodes at the end of this frame.
	void clear();

	/// The number of idle instances of all scenes. Instances that a script has freed count until the pool notices.
	std::size_t idle_count() const;

	/// The largest number of idle instances of a scene.
	static constexpr std::size_t max_idle = 64;

private:
	struct Idle {
		godot::Ref<godot::PackedScene> scene;
		std::vector<NodeHandle> nodes;
	};

	std::vector<Idle> idle_; ///< One entry per scene, so only a few.
	std::vector<NodeHandle> discarded_;
};

} // namespace thicket
