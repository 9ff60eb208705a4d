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

/// A reference to a node that scripts may free at any time.
class NodeHandle {
public:
	NodeHandle() = default;
	explicit NodeHandle(const godot::Node3D *node) : node_(node) {}

	/// Returns null once the node is freed.
	godot::Node3D *get() const { return godot::Object::cast_to<godot::Node3D>(node_.get_validated_object()); }

private:
	godot::Variant node_;
};

/// A pool of scene instances that are currently not needed. They are outside the tree, so they are
/// not drawn, heard, hit or processed. Use it only on the main thread.
class ScenePool {
public:
	ScenePool() = default;
	~ScenePool() { clear(); }
	ScenePool(const ScenePool &) = delete;
	ScenePool &operator=(const ScenePool &) = delete;

	/// Returns a pooled or new instance outside the tree, which the caller owns. Returns null if
	/// the scene is empty or its root is not a Node3D. Instantiating a scene runs scripts.
	godot::Node3D *take(const godot::Ref<godot::PackedScene> &scene);

	/// Returns an instance of the scene, which must already be outside the tree, to the pool. If
	/// the pool already has `max_idle` instances of that scene, discards the node.
	void give(const godot::Ref<godot::PackedScene> &scene, godot::Node3D *node);

	/// Takes ownership of a node that will not be reused; `free_some` frees it.
	void discard(godot::Node3D *node);

	/// Frees at most `freed_per_frame` discarded nodes. Call it once per frame. The limit is needed
	/// because the engine frees nodes at the end of the frame, which our time budget does not
	/// cover.
	void free_some();
	static constexpr int freed_per_frame = 4;

	/// Frees a node at the end of the frame. Freeing it immediately would be unsafe, because one of
	/// its scripts may be running.
	static void dispose(const NodeHandle &handle);

	/// Discards the idle instances of all scenes that are not in the list.
	void keep_only(std::span<const godot::Ref<godot::PackedScene>> scenes);

	/// Frees all nodes at the end of this frame.
	void clear();

	/// Returns the number of idle instances of all scenes. May include instances that a script has
	/// freed.
	std::size_t idle_count() const;

	/// The maximum number of idle instances per scene.
	static constexpr std::size_t max_idle = 64;

private:
	struct IdleScene {
		godot::Ref<godot::PackedScene> scene;
		std::vector<NodeHandle> nodes;
	};

	std::vector<IdleScene> idle_scenes_; ///< One entry per scene. There are only a few scenes.
	std::vector<NodeHandle> discarded_;
};

} // namespace thicket
