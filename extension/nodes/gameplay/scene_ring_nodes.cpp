// This file contains the part of SceneRing that manages the nodes. After every call that may run a
// script, it checks that the ring still exists.

#include "nodes/gameplay/scene_ring.hpp"

#include "nodes/common/convert.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

bool SceneRing::ours(const Shown &shown) const {
	const Node3D *node = shown.node.get();
	return node != nullptr && node->get_parent() == host_.parent;
}

Transform3D SceneRing::transform_of(const PlacedInstance &instance) const {
	return to_engine(instance.basis, instance.position, frame_);
}

void SceneRing::move_node(const Shown &shown) const {
	if (Node3D *node = shown.node.get(); node != nullptr && node->is_inside_tree()) {
		node->set_global_transform(transform_of(shown.instance));
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
	const Shown shown{instance, scene, NodeHandle(node), node->is_set_as_top_level()};
	shown_.insert_or_assign({instance.id, instance.layer}, shown);
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
	if (child_changes_ != 1 || !ours(shown)) {
		children_changed(); // A script has also changed children.
	}
	const auto found = shown_.find({instance.id, instance.layer});
	if (found != shown_.end() && ours(shown)) {
		// Adding the node to the tree has moved it, if the transform of its parent is not the
		// identity.
		move_node(shown);
	}
	if (ours(shown)) {
		notify(SceneEvent::shown, shown);
	}
}

void SceneRing::move(const PlacedInstance &instance) {
	const auto found = shown_.find({instance.id, instance.layer});
	if (found == shown_.end()) {
		return;
	}
	Shown &shown = found->second;
	host_.hide_mesh(shown.instance, false);
	shown.instance = instance;
	host_.hide_mesh(shown.instance, true);
	move_node(shown);
}

void SceneRing::notify(SceneEvent event, const Shown &shown) {
	const std::weak_ptr<const void> alive = life_;
	const auto listener = host_.notify; // Use a copy, because the call may free the ring.
	const auto id = static_cast<int64_t>(shown.instance.id);
	Node3D *node = shown.node.get();
	if (event == SceneEvent::hidden && node != nullptr && node->has_method("_scatter_hidden")) {
		node->call("_scatter_hidden");
	} else if (event == SceneEvent::shown && node != nullptr && node->has_method("_scatter_shown")) {
		const Variant data = host_.data_of(shown.instance.id);
		node->call("_scatter_shown", id, host_.layer_at(shown.instance.layer), data);
	}
	if (alive.expired()) {
		return;
	}
	if (node = shown.node.get(); node != nullptr) {
		listener(event, shown.instance.id, node);
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
	const Shown shown = leaving_.back();
	if (ours(shown)) {
		notify(SceneEvent::hidden, shown);
	}
	if (alive.expired()) {
		return;
	}
	const Node3D *node = shown.node.get();
	const auto found = std::find_if(leaving_.begin(), leaving_.end(),
			[node](const Shown &other) { return node != nullptr && other.node.get() == node; });
	if (found == leaving_.end()) {
		std::erase_if(leaving_, [](const Shown &other) { return other.node.get() == nullptr; });
		return;
	}
	leaving_.erase(found);
	if (!ours(shown)) {
		return;
	}
	take_out(shown.node.get());
	Node3D *left = shown.node.get();
	if (alive.expired() || left == nullptr) {
		return;
	}
	left->set_as_top_level(shown.top_level);
	const bool wanted =
			std::ranges::any_of(layers_, [&shown](const Layer &layer) { return layer.is.scene == shown.scene; });
	if (left->get_parent() == host_.parent) {
		// The tree was busy, so the node is still in it and cannot be reused.
		ScenePool::dispose(shown.node);
	} else if (wanted) {
		pool_->give(shown.scene, left);
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
	auto found = shown_.lower_bound({id, 0});
	while (found != shown_.end() && found->first.id == id) {
		host_.hide_mesh(found->second.instance, false);
		leaving_.push_back(std::move(found->second));
		found = shown_.erase(found);
		if (!std::exchange(recycle_due_, true)) {
			host_.recycle_later();
		}
	}
}

void SceneRing::drop_if(const std::function<bool(std::uint64_t id)> &gone) {
	std::vector<std::uint64_t> dropped;
	for (const auto &[key, shown] : shown_) {
		if (gone(key.id)) {
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
	std::erase_if(shown_, [this](const auto &entry) {
		const Shown &shown = entry.second;
		if (ours(shown)) {
			return false;
		}
		if (Node3D *node = shown.node.get()) {
			node->set_as_top_level(shown.top_level);
		}
		host_.hide_mesh(shown.instance, false);
		return true;
	});
	std::erase_if(leaving_, [this](const Shown &shown) { return !ours(shown); });
}

Node3D *SceneRing::find(std::uint64_t id) const {
	const auto found = shown_.lower_bound({id, 0});
	return found != shown_.end() && found->first.id == id ? found->second.node.get() : nullptr;
}

Node3D *SceneRing::take(std::uint64_t id) {
	Shown taken;
	const auto found = shown_.lower_bound({id, 0});
	const auto left = std::find_if(
			leaving_.begin(), leaving_.end(), [id](const Shown &shown) { return shown.instance.id == id; });
	if (found != shown_.end() && found->first.id == id) {
		taken = std::move(found->second);
		shown_.erase(found);
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
	for (const auto &[key, shown] : shown_) {
		move_node(shown);
	}
	for (const Shown &shown : leaving_) {
		move_node(shown);
	}
}

void SceneRing::clear() {
	++epoch_;
	queue_.forget_world();
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		queue_.release_layer(layer);
	}
	std::vector<Shown> all = std::exchange(leaving_, {});
	for (auto &[key, shown] : std::exchange(shown_, {})) {
		host_.hide_mesh(shown.instance, false);
		all.push_back(std::move(shown));
	}
	pool_->clear();
	const std::weak_ptr<const void> alive = life_;
	for (const Shown &shown : all) {
		if (!alive.expired() && ours(shown)) {
			take_out(shown.node.get());
			ScenePool::dispose(shown.node);
		}
	}
}

} // namespace thicket
