// This file contains the part of SceneRing that manages the nodes. After every call that may run a
// script, it checks that the ring still exists.

#include "nodes/gameplay/scene_ring.hpp"

#include "nodes/common/convert.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

bool SceneRing::is_own_scene(const DisplayedScene &displayed_scene) const {
	const Node3D *node = displayed_scene.node.get();
	return node != nullptr && node->get_parent() == host_.parent;
}

Transform3D SceneRing::transform_of(const PlacedInstance &instance) const {
	return to_engine(instance.basis, instance.position, frame_);
}

void SceneRing::move_node(const DisplayedScene &displayed_scene) const {
	if (Node3D *node = displayed_scene.node.get(); node != nullptr && node->is_inside_tree()) {
		node->set_global_transform(transform_of(displayed_scene.instance));
		node->reset_physics_interpolation();
	}
}

void SceneRing::reject(Layer &layer) {
	layer.is_rejected = true;
	update_distances();
	const String path = layer.settings.scene->get_path();
	ERR_PRINT(vformat("TerrainScatter3D: the root of the scene %s of layer \"%s\" is not a Node3D. The layer's meshes "
					  "are drawn instead.",
			path.is_empty() ? String("(built in)") : path, layer.settings.name));
}

void SceneRing::show(const PlacedInstance &instance, const Ref<PackedScene> &scene, Node3D *node) {
	const DisplayedScene displayed_scene{instance, scene, NodeHandle(node), node->is_set_as_top_level()};
	displayed_scenes_.insert_or_assign({instance.id, instance.layer}, displayed_scene);
	host_.hide_mesh(instance, true);
	// Instances are in world space, independent of their TerrainScatter3D's transform.
	node->set_as_top_level(true);
	node->set_transform(transform_of(instance));
	const std::weak_ptr<const void> alive = life_;
	moving_child_ = true;
	child_changes_ = 0;
	host_.parent->add_child(node, false, Node::INTERNAL_MODE_BACK);
	if (alive.expired()) {
		return;
	}
	moving_child_ = false;
	if (child_changes_ != 1 || !is_own_scene(displayed_scene)) {
		children_changed(); // A script has also changed children.
	}
	const auto entry = displayed_scenes_.find({instance.id, instance.layer});
	if (entry != displayed_scenes_.end() && is_own_scene(displayed_scene)) {
		// Adding the node to the tree has moved it, if the transform of its parent is not the
		// identity.
		move_node(displayed_scene);
	}
	if (is_own_scene(displayed_scene)) {
		notify(SceneEvent::shown, displayed_scene);
	}
}

void SceneRing::move(const PlacedInstance &instance) {
	const auto entry = displayed_scenes_.find({instance.id, instance.layer});
	if (entry == displayed_scenes_.end()) {
		return;
	}
	DisplayedScene &displayed_scene = entry->second;
	host_.hide_mesh(displayed_scene.instance, false);
	displayed_scene.instance = instance;
	host_.hide_mesh(displayed_scene.instance, true);
	move_node(displayed_scene);
}

void SceneRing::notify(SceneEvent event, const DisplayedScene &displayed_scene) {
	const std::weak_ptr<const void> alive = life_;
	const auto listener = host_.notify; // Use a copy, because the call may free the ring.
	const auto id = static_cast<int64_t>(displayed_scene.instance.id);
	Node3D *node = displayed_scene.node.get();
	if (event == SceneEvent::hidden && node != nullptr && node->has_method("_scatter_hidden")) {
		node->call("_scatter_hidden");
	} else if (event == SceneEvent::shown && node != nullptr && node->has_method("_scatter_shown")) {
		const Variant data = host_.data_of(displayed_scene.instance.id);
		node->call("_scatter_shown", id, host_.layer_at(displayed_scene.instance.layer), data);
	}
	if (alive.expired()) {
		return;
	}
	if (node = displayed_scene.node.get(); node != nullptr) {
		listener(event, displayed_scene.instance.id, node);
	}
}

/// Takes a node out of the tree if it is a child of the host. Runs scripts.
void SceneRing::remove_from_tree(Node3D *node) {
	if (node->get_parent() != host_.parent) {
		return;
	}
	const std::weak_ptr<const void> alive = life_;
	moving_child_ = true;
	child_changes_ = 0;
	host_.parent->remove_child(node);
	if (alive.expired()) {
		return;
	}
	moving_child_ = false;
	if (child_changes_ != 1) {
		children_changed();
	}
}

/// Notifies the last scene of `leaving_scenes_` that it is hidden. Then returns the scene to the pool,
/// unless a script has taken it. Runs scripts.
void SceneRing::return_last_to_pool() {
	const std::weak_ptr<const void> alive = life_;
	const DisplayedScene displayed_scene = leaving_scenes_.back();
	if (is_own_scene(displayed_scene)) {
		notify(SceneEvent::hidden, displayed_scene);
	}
	if (alive.expired()) {
		return;
	}
	const Node3D *node = displayed_scene.node.get();
	const auto entry = std::find_if(leaving_scenes_.begin(), leaving_scenes_.end(),
			[node](const DisplayedScene &other) { return node != nullptr && other.node.get() == node; });
	if (entry == leaving_scenes_.end()) {
		std::erase_if(leaving_scenes_, [](const DisplayedScene &other) { return other.node.get() == nullptr; });
		return;
	}
	leaving_scenes_.erase(entry);
	if (!is_own_scene(displayed_scene)) {
		return;
	}
	remove_from_tree(displayed_scene.node.get());
	Node3D *removed_node = displayed_scene.node.get();
	if (alive.expired() || removed_node == nullptr) {
		return;
	}
	removed_node->set_as_top_level(displayed_scene.top_level);
	const bool is_in_use = std::ranges::any_of(
			layers_, [&displayed_scene](const Layer &layer) { return layer.settings.scene == displayed_scene.scene; });
	if (removed_node->get_parent() == host_.parent) {
		// The tree was busy, so the node is still in it and cannot be reused.
		ScenePool::dispose(displayed_scene.node);
	} else if (is_in_use) {
		pool_->give(displayed_scene.scene, removed_node);
	} else {
		pool_->discard(removed_node);
	}
}

void SceneRing::recycle() {
	recycle_due_ = false;
	const std::weak_ptr<const void> alive = life_;
	for (int count = 0; count < recycled_at_once && !alive.expired() && !leaving_scenes_.empty(); ++count) {
		return_last_to_pool();
	}
}

void SceneRing::drop(std::uint64_t id) {
	queue_.release(id);
	auto entry = displayed_scenes_.lower_bound({id, 0});
	while (entry != displayed_scenes_.end() && entry->first.id == id) {
		host_.hide_mesh(entry->second.instance, false);
		leaving_scenes_.push_back(std::move(entry->second));
		entry = displayed_scenes_.erase(entry);
		if (!std::exchange(recycle_due_, true)) {
			host_.recycle_later();
		}
	}
}

void SceneRing::drop_if(const std::function<bool(std::uint64_t id)> &is_gone) {
	std::vector<std::uint64_t> dropped_ids;
	for (const auto &[key, displayed_scene] : displayed_scenes_) {
		if (is_gone(key.id)) {
			dropped_ids.push_back(key.id);
		}
	}
	for (const std::uint64_t id : dropped_ids) {
		drop(id);
	}
}

void SceneRing::children_changed() {
	if (moving_child_) {
		++child_changes_;
		return;
	}
	std::erase_if(displayed_scenes_, [this](const auto &entry) {
		const DisplayedScene &displayed_scene = entry.second;
		if (is_own_scene(displayed_scene)) {
			return false;
		}
		if (Node3D *node = displayed_scene.node.get()) {
			node->set_as_top_level(displayed_scene.top_level);
		}
		host_.hide_mesh(displayed_scene.instance, false);
		return true;
	});
	std::erase_if(
			leaving_scenes_, [this](const DisplayedScene &displayed_scene) { return !is_own_scene(displayed_scene); });
}

Node3D *SceneRing::find(std::uint64_t id) const {
	const auto entry = displayed_scenes_.lower_bound({id, 0});
	return entry != displayed_scenes_.end() && entry->first.id == id ? entry->second.node.get() : nullptr;
}

Node3D *SceneRing::take(std::uint64_t id) {
	DisplayedScene taken_scene;
	const auto entry = displayed_scenes_.lower_bound({id, 0});
	const auto leaving_scene = std::find_if(leaving_scenes_.begin(), leaving_scenes_.end(),
			[id](const DisplayedScene &displayed_scene) { return displayed_scene.instance.id == id; });
	if (entry != displayed_scenes_.end() && entry->first.id == id) {
		taken_scene = std::move(entry->second);
		displayed_scenes_.erase(entry);
		host_.hide_mesh(taken_scene.instance, false);
	} else if (leaving_scene != leaving_scenes_.end()) {
		taken_scene = std::move(*leaving_scene);
		leaving_scenes_.erase(leaving_scene);
	}
	Node3D *node = taken_scene.node.get();
	if (node != nullptr) {
		node->set_as_top_level(taken_scene.top_level);
	}
	return node;
}

void SceneRing::set_world_frame(const WorldFrame &frame) {
	frame_ = frame;
	for (const auto &[key, displayed_scene] : displayed_scenes_) {
		move_node(displayed_scene);
	}
	for (const DisplayedScene &displayed_scene : leaving_scenes_) {
		move_node(displayed_scene);
	}
}

void SceneRing::clear() {
	++epoch_;
	queue_.forget_world();
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		queue_.release_layer(layer);
	}
	std::vector<DisplayedScene> scenes_to_free = std::exchange(leaving_scenes_, {});
	for (auto &[key, displayed_scene] : std::exchange(displayed_scenes_, {})) {
		host_.hide_mesh(displayed_scene.instance, false);
		scenes_to_free.push_back(std::move(displayed_scene));
	}
	pool_->clear();
	const std::weak_ptr<const void> alive = life_;
	for (const DisplayedScene &displayed_scene : scenes_to_free) {
		if (!alive.expired() && is_own_scene(displayed_scene)) {
			remove_from_tree(displayed_scene.node.get());
			ScenePool::dispose(displayed_scene.node);
		}
	}
}

} // namespace thicket
