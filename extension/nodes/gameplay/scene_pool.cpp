#include "nodes/gameplay/scene_pool.hpp"

#include <algorithm>

using namespace godot;

namespace thicket {

namespace {

/// Returns true if the node can be reused. A node that a script has freed or added to a parent
/// cannot.
bool is_reusable(const Node3D *node) {
	return node != nullptr && node->get_parent() == nullptr && !node->is_queued_for_deletion();
}

} // namespace

void ScenePool::dispose(const NodeHandle &handle) {
	Node3D *node = handle.get();
	if (node != nullptr && !node->is_queued_for_deletion()) {
		node->queue_free();
	}
}

Node3D *ScenePool::take(const Ref<PackedScene> &scene) {
	const auto entry = std::find_if(
			idle_scenes_.begin(), idle_scenes_.end(), [&scene](const IdleScene &idle) { return idle.scene == scene; });
	while (entry != idle_scenes_.end() && !entry->nodes.empty()) {
		Node3D *node = entry->nodes.back().get();
		entry->nodes.pop_back();
		if (is_reusable(node)) {
			return node;
		}
	}
	Node *root = scene->can_instantiate() ? scene->instantiate() : nullptr;
	Node3D *node = Object::cast_to<Node3D>(root);
	if (root != nullptr && node == nullptr) {
		root->queue_free();
	}
	return node;
}

void ScenePool::give(const Ref<PackedScene> &scene, Node3D *node) {
	if (!is_reusable(node)) {
		return;
	}
	auto entry = std::find_if(
			idle_scenes_.begin(), idle_scenes_.end(), [&scene](const IdleScene &idle) { return idle.scene == scene; });
	if (entry == idle_scenes_.end()) {
		entry = idle_scenes_.insert(idle_scenes_.end(), IdleScene{scene, {}});
	}
	if (entry->nodes.size() < max_idle) {
		entry->nodes.emplace_back(node);
	} else {
		discard(node);
	}
}

void ScenePool::discard(Node3D *node) { discarded_.emplace_back(node); }

void ScenePool::free_some() {
	for (int freed_count = 0; freed_count < freed_per_frame && !discarded_.empty(); discarded_.pop_back()) {
		if (is_reusable(discarded_.back().get())) {
			dispose(discarded_.back());
			++freed_count;
		}
	}
}

void ScenePool::clear() {
	keep_only({});
	for (const NodeHandle &node : discarded_) {
		if (is_reusable(node.get())) {
			dispose(node);
		}
	}
	discarded_.clear();
}

void ScenePool::keep_only(std::span<const Ref<PackedScene>> scenes) {
	std::erase_if(idle_scenes_, [this, scenes](const IdleScene &idle) {
		if (std::find(scenes.begin(), scenes.end(), idle.scene) != scenes.end()) {
			return false;
		}
		discarded_.insert(discarded_.end(), idle.nodes.begin(), idle.nodes.end());
		return true;
	});
}

std::size_t ScenePool::idle_count() const {
	std::size_t count = 0;
	for (const IdleScene &idle : idle_scenes_) {
		count += idle.nodes.size();
	}
	return count;
}

} // namespace thicket
