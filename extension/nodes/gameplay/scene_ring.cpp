// This file contains the part of SceneRing that tracks the viewers and the world.
// scene_ring_nodes.cpp manages the nodes.

#include "nodes/gameplay/scene_ring.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

SceneSettings scene_settings_of(const LayerSnapshot *layer) {
	return layer == nullptr ? SceneSettings{}
							: SceneSettings{layer->gameplay.scene.scene, layer->gameplay.scene.distance,
									  godot::String::utf8(layer->links.name.c_str())};
}

SceneRing::SceneRing(SceneHost host) : host_(std::move(host)) {}

void SceneRing::set_layers(std::vector<SceneSettings> layers) {
	std::vector<godot::Ref<godot::PackedScene>> scenes;
	for (const SceneSettings &layer : layers) {
		scenes.push_back(layer.scene);
	}
	pool_->keep_only(scenes);
	// Removed layers still have to release their scenes.
	layers_.resize(std::max(layers_.size(), layers.size()));
	layers.resize(layers_.size());
	std::vector<std::uint32_t> changed_layers;
	for (std::uint32_t index = 0; index < layers.size(); ++index) {
		Layer &layer = layers_[index];
		const bool same_scene = layer.settings.scene == layers[index].scene;
		layer.is_rejected = layer.is_rejected && same_scene;
		layer.settings = std::move(layers[index]);
		if (!same_scene) {
			changed_layers.push_back(index);
		}
	}
	update_distances();
	for (const std::uint32_t index : changed_layers) {
		queue_.renew(index);
	}
}

void SceneRing::update_distances() {
	std::vector<double> distances;
	for (const Layer &layer : layers_) {
		distances.push_back(layer.distance());
	}
	queue_.set_distances(distances);
}

void SceneRing::find_changes(std::span<const glm::dvec3> centers, const InstanceWorld &world) {
	pool_->free_some();
	if (!centers.empty()) {
		queue_.find_changes(centers, world);
	}
}

bool SceneRing::step() {
	if (!leaving_scenes_.empty()) {
		return_last_to_pool();
		return true;
	}
	// Remove scenes first, because added ones can reuse them.
	if (remove_outdated_scene() || remove_scene_of_removed()) {
		return true;
	}
	PlacedInstance instance;
	if (queue_.next_changed(instance)) {
		move(instance); // The mesh stays hidden during the move.
		return true;
	}
	for (InstanceToRelease release; queue_.next_leaving(release);) {
		if (remove_scene(release)) {
			return true;
		}
	}
	const bool has_entering = queue_.next_entering(instance);
	if (has_entering) {
		add_scene(instance);
	}
	return has_entering;
}

/// Removes a scene that its layer no longer uses, so that the instance can get the layer's new
/// scene. Returns false if there is none to remove.
bool SceneRing::remove_outdated_scene() {
	for (PlacedInstance instance; queue_.next_due(instance);) {
		const Key key{instance.id, instance.layer};
		const auto entry = displayed_scenes_.find(key);
		if (entry != displayed_scenes_.end() && !(entry->second.scene == layers_[key.layer].settings.scene)) {
			queue_.release(key.layer, key.id);
			return remove_scene(key);
		}
	}
	return false;
}

/// Removes the scene of one removed instance. Returns false if there is none.
bool SceneRing::remove_scene_of_removed() {
	for (InstanceToRelease release; queue_.next_removed(release);) {
		if (remove_scene(release)) {
			return true;
		}
	}
	return false;
}

/// Removes the scene of an instance, unless the queue has since found the instance in another cell.
/// The instance then keeps its scene at the new position.
bool SceneRing::remove_scene(const InstanceToRelease &release) {
	const auto entry = displayed_scenes_.find({release.id, release.layer});
	return entry != displayed_scenes_.end() && entry->second.instance.position == release.position &&
			remove_scene(Key{release.id, release.layer});
}

/// Removes the scene of an instance. Returns false if it has none. Runs scripts.
bool SceneRing::remove_scene(const Key &key) {
	auto entry = displayed_scenes_.extract(key);
	if (!entry) {
		return false;
	}
	host_.hide_mesh(entry.mapped().instance, false);
	leaving_scenes_.push_back(std::move(entry.mapped()));
	return_last_to_pool();
	return true;
}

/// Adds the scene of an instance. Runs scripts, which may free the node, drop the instance or
/// change the layers.
void SceneRing::add_scene(const PlacedInstance &instance) {
	if (displayed_scenes_.contains({instance.id, instance.layer})) {
		move(instance);
		return;
	}
	const godot::Ref<godot::PackedScene> scene = layers_[instance.layer].settings.scene;
	const std::weak_ptr<const void> alive = life_;
	const std::uint64_t epoch = epoch_;
	const std::shared_ptr<ScenePool> pool = pool_;
	godot::Node3D *node = scene.is_valid() ? pool->take(scene) : nullptr;
	const bool is_needed = !alive.expired() && epoch == epoch_ && queue_.holds(instance.layer, instance.id);
	const bool same_scene = is_needed && layers_[instance.layer].settings.scene == scene;
	if (node == nullptr && same_scene && scene.is_valid()) {
		reject(layers_[instance.layer]);
	} else if (node != nullptr && same_scene) {
		show(instance, scene, node);
	} else if (node != nullptr) {
		ScenePool::dispose(NodeHandle(node));
	}
	if (is_needed && !same_scene) {
		// Lets the instance get the layer's new scene.
		queue_.release(instance.layer, instance.id);
	}
}

} // namespace thicket
