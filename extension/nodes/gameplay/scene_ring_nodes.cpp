// This file contains the part of SceneRing that manages the nodes. After every call that may run a
// script, it checks that the ring still exists.

#include "nodes/gameplay/scene_ring.hpp"

#include "nodes/common/convert.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

bool SceneRing::is_own_scene(const DisplayedScene &displayed) const {
	const Node3D *node = displayed.node.get();
	return node != nullptr && node->get_parent() == host_.parent;
}

Transform3D SceneRing::transform_of(const PlacedInstance &instance) const {
	return to_engine(instance.basis, instance.position, frame_);
}

void SceneRing::move_node(const DisplayedScene &displayed) const {
	if (Node3D *node = displayed.node.get(); node != nullptr && node->is_inside_tree()) {
		node->set_global_transform(transform_of(displayed.instance));
		node->reset_physics_interpolation();
	}
}

void SceneRing::refuse(Layer &layer) {
	layer.refused = true;
	update_distances();
	const String path = layer.is.scene->get_path();
	ERR_PRINT(vformat("TerrainScatter3D: the root of the scene %s of layer \"%s\" is not a Node3D. The layer's meshes "
					  "are drawn instead.",
			path.is_empty() ? String("(built in)") : path, layer.is.name));
}

void SceneRing::show(const PlacedInstance &instance, const Ref<PackedScene> &scene, Node3D *node) {
	const DisplayedScene displayed{instance, scene, NodeHandle(node), node->is_set_as_top_level()};
	displayed_.insert_or_assign({instance.id, instance.layer}, displayed);
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
	if (child_changes_ != 1 || !is_own_scene(displayed)) {
		children_changed(); // A script has also changed children.
	}
	const auto found = displayed_.find({instance.id, instance.layer});
	if (found != displayed_.end() && is_own_scene(displayed)) {
		// Adding the node to the tree has moved it, if the transform of its parent is not the
		// identity.
		move_node(displayed);
	}
	if (is_own_scene(displayed)) {
		notify(SceneEvent::shown, displayed);
	}
}

void SceneRing::move(const PlacedInstance &instance) {
	const auto found = displayed_.find({instance.id, instance.layer});
	if (found == displayed_.end()) {
		return;
	}
	DisplayedScene &displayed = found->second;
	host_.hide_mesh(displayed.instance, false);
	displayed.instance = instance;
	host_.hide_mesh(displayed.instance, true);
	move_node(displayed);
}

void SceneRing::notify(SceneEvent event, const DisplayedScene &displayed) {
	const std::weak_ptr<const void> alive = life_;
	const auto listener = host_.notify; // Use a copy, because the call may free the ring.
	const auto id = static_cast<int64_t>(displayed.instance.id);
	Node3D *node = displayed.node.get();
	if (event == SceneEvent::hidden && node != nullptr && node->has_method("_scatter_hidden")) {
		node->call("_scatter_hidden");
	} else if (event == SceneEvent::shown && node != nullptr && node->has_method("_scatter_shown")) {
		const Variant data = host_.data_of(displayed.instance.id);
		node->call("_scatter_shown", id, host_.layer_at(displayed.instance.layer), data);
	}
	if (alive.expired()) {
		return;
	}
	if (node = displayed.node.get(); node != nullptr) {
		listener(event, displayed.instance.id, node);
	}
}

/// Takes a node out of the tree if it is a child of the host. Runs scripts.
void SceneRing::take_out(Node3D *node) {
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

/// Notifies the last scene of `leaving_` that it is hidden. Then returns the scene to the pool,
/// unless a script has taken it. Runs scripts.
void SceneRing::put_last_back() {
	const std::weak_ptr<const void> alive = life_;
	const DisplayedScene displayed = leaving_.back();
	if (is_own_scene(displayed)) {
		notify(SceneEvent::hidden, displayed);
	}
	if (alive.expired()) {
		return;
	}
	const Node3D *node = displayed.node.get();
	const auto found = std::find_if(leaving_.begin(), leaving_.end(),
			[node](const DisplayedScene &other) { return node != nullptr && other.node.get() == node; });
	if (found == leaving_.end()) {
		std::erase_if(leaving_, [](const DisplayedScene &other) { return other.node.get() == nullptr; });
		return;
	}
	leaving_.erase(found);
	if (!is_own_scene(displayed)) {
		return;
	}
	take_out(displayed.node.get());
	Node3D *left = displayed.node.get();
	if (alive.expired() || left == nullptr) {
		return;
	}
	left->set_as_top_level(displayed.top_level);
	const bool wanted = std::ranges::any_of(
			layers_, [&displayed](const Layer &layer) { return layer.is.scene == displayed.scene; });
	if (left->get_parent() == host_.parent) {
		// The tree was busy, so the node is still in it and cannot be reused.
		ScenePool::dispose(displayed.node);
	} else if (wanted) {
		pool_->give(displayed.scene, left);
	} else {
		pool_->discard(left);
	}
}

void SceneRing::recycle() {
	recycle_due_ = false;
	const std::weak_ptr<const void> alive = life_;
	for (int count = 0; count < recycled_at_once && !alive.expired() && !leaving_.empty(); ++count) {
		put_last_back();
	}
}

void SceneRing::drop(std::uint64_t id) {
	queue_.release(id);
	auto found = displayed_.lower_bound({id, 0});
	while (found != displayed_.end() && found->first.id == id) {
		host_.hide_mesh(found->second.instance, false);
		leaving_.push_back(std::move(found->second));
		found = displayed_.erase(found);
		if (!std::exchange(recycle_due_, true)) {
			host_.recycle_later();
		}
	}
}

void SceneRing::drop_if(const std::function<bool(std::uint64_t id)> &is_gone) {
	std::vector<std::uint64_t> dropped;
	for (const auto &[key, displayed] : displayed_) {
		if (is_gone(key.id)) {
			dropped.push_back(key.id);
		}
	}
	for (const std::uint64_t id : dropped) {
		drop(id);
	}
}

void SceneRing::children_changed() {
	if (moving_child_) {
		++child_changes_;
		return;
	}
	std::erase_if(displayed_, [this](const auto &entry) {
		const DisplayedScene &displayed = entry.second;
		if (is_own_scene(displayed)) {
			return false;
		}
		if (Node3D *node = displayed.node.get()) {
			node->set_as_top_level(displayed.top_level);
		}
		host_.hide_mesh(displayed.instance, false);
		return true;
	});
	std::erase_if(leaving_, [this](const DisplayedScene &displayed) { return !is_own_scene(displayed); });
}

Node3D *SceneRing::find(std::uint64_t id) const {
	const auto found = displayed_.lower_bound({id, 0});
	return found != displayed_.end() && found->first.id == id ? found->second.node.get() : nullptr;
}

Node3D *SceneRing::take(std::uint64_t id) {
	DisplayedScene taken;
	const auto found = displayed_.lower_bound({id, 0});
	const auto left = std::find_if(leaving_.begin(), leaving_.end(),
			[id](const DisplayedScene &displayed) { return displayed.instance.id == id; });
	if (found != displayed_.end() && found->first.id == id) {
		taken = std::move(found->second);
		displayed_.erase(found);
		host_.hide_mesh(taken.instance, false);
	} else if (left != leaving_.end()) {
		taken = std::move(*left);
		leaving_.erase(left);
	}
	Node3D *node = taken.node.get();
	if (node != nullptr) {
		node->set_as_top_level(taken.top_level);
	}
	return node;
}

void SceneRing::set_world_frame(const WorldFrame &frame) {
	frame_ = frame;
	for (const auto &[key, displayed] : displayed_) {
		move_node(displayed);
	}
	for (const DisplayedScene &displayed : leaving_) {
		move_node(displayed);
	}
}

void SceneRing::clear() {
	++epoch_;
	queue_.forget_world();
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		queue_.release_layer(layer);
	}
	std::vector<DisplayedScene> all = std::exchange(leaving_, {});
	for (auto &[key, displayed] : std::exchange(displayed_, {})) {
		host_.hide_mesh(displayed.instance, false);
		all.push_back(std::move(displayed));
	}
	pool_->clear();
	const std::weak_ptr<const void> alive = life_;
	for (const DisplayedScene &displayed : all) {
		if (!alive.expired() && is_own_scene(displayed)) {
			take_out(displayed.node.get());
			ScenePool::dispose(displayed.node);
		}
	}
}

} // namespace thicket
