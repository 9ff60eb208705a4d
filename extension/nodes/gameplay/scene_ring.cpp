// What comes and goes: how SceneRing follows the viewers and the world. What happens to the nodes is in scene_ring_nodes.cpp.

#include "nodes/gameplay/scene_ring.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

namespace {

/// An instance keeps its scene a little farther out than where it gets one, so that nobody who walks to and fro there makes it flicker.
constexpr double leave_factor = 1.1;
constexpr double leave_margin = 1.0; ///< Meters.

/// Frames after which what is near is looked for again though nothing has moved: a tile that is missed has to be missed again.
constexpr int look_frames = 32;

} // namespace

SceneLayer scenes_of(const LayerSnapshot *layer) {
	return layer == nullptr ? SceneLayer{} : SceneLayer{layer->gameplay.scene.scene, layer->gameplay.scene.distance,
													   godot::String::utf8(layer->links.name.c_str())};
}

SceneRing::SceneRing(SceneHost host) : host_(std::move(host)) {}

void SceneRing::set_layers(std::vector<SceneLayer> layers) {
	std::vector<godot::Ref<godot::PackedScene>> scenes;
	for (const SceneLayer &layer : layers) {
		scenes.push_back(layer.scene);
	}
	pool_->keep_only(scenes);
	places_.resize(std::max(places_.size(), layers.size())); // A layer that is gone has to let go of its scenes.
	layers.resize(places_.size());
	for (std::size_t at = 0; at < layers.size(); ++at) {
		Place &place = places_[at];
		if (place.layer == layers[at]) {
			continue;
		}
		place.refused = place.refused && place.layer.scene == layers[at].scene;
		place.layer = std::move(layers[at]);
		version_ = 0;
	}
}

void SceneRing::look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world) {
	const bool same = version_ == world.version() && std::ranges::equal(centers, centers_);
	if (centers.empty() || (same && ++frames_ < look_frames)) {
		return; // Without anybody to be near to, what stands stays: a camera may be gone for a frame.
	}
	world_ = &world;
	version_ = world.version();
	centers_.assign(centers.begin(), centers.end());
	frames_ = 0;
	dropped_ids_.clear();
	for (std::uint32_t at = 0; at < places_.size(); ++at) {
		look(at, centers, world);
	}
}

void SceneRing::look(std::uint32_t at, std::span<const glm::dvec3> centers, const InstanceWorld &world) {
	Place &place = places_[at];
	const bool wanted =
			at < world.layers().size() && world.layers()[at].wanted && place.layer.scene.is_valid() && !place.refused;
	NearRange range;
	if (wanted && place.layer.distance > 0.0) {
		range = {place.layer.distance, leave_factor * place.layer.distance + leave_margin};
	}
	if (range.enter == 0.0 && place.near.size() == 0) {
		place.changes = {};
		place.left = place.entered = 0;
		return;
	}
	standing_.clear();
	for (std::size_t i = 0; i < centers.size() && range.enter > 0.0; ++i) {
		world.known_near(at, {centers[i].x, centers[i].z}, range.leave, standing_);
	}
	place.near.look(centers, range, standing_, place.changes);
	place.left = place.entered = 0;
	move_changed(at);
	for (const auto &[key, shown] : shown_) {
		if (key.layer == at && !(shown.scene == place.layer.scene) && range.enter > 0.0) {
			place.changes.leave.push_back(key.id);
			version_ = 0; // What leaves for that reason may come back at once.
		}
	}
}

/// What stands otherwise than it did is moved, on the spot: it would be odd to see its mesh in between.
void SceneRing::move_changed(std::uint32_t at) {
	Place &place = places_[at];
	std::erase_if(place.changes.enter, [&](const PlacedInstance &instance) {
		if (!place.near.holds(instance.id)) {
			return false;
		}
		std::erase(place.changes.leave, instance.id);
		place.near.hold(instance);
		if (const auto found = shown_.find({instance.id, at}); found != shown_.end()) {
			move(found->second, instance);
		}
		return true;
	});
}

bool SceneRing::settled() const {
	return std::ranges::all_of(places_, [this](const Place &place) {
		const bool looked = (world_ != nullptr && version_ == world_->version()) ||
				(place.layer.scene.is_null() && place.near.size() == 0);
		return looked && place.left == place.changes.leave.size() && place.entered == place.changes.enter.size();
	});
}

bool SceneRing::step() {
	// What leaves goes first: what comes can use its scene.
	for (std::uint32_t at = 0; at < places_.size(); ++at) {
		if (leave_step(at)) {
			return true;
		}
	}
	for (std::uint32_t at = 0; at < places_.size(); ++at) {
		if (enter_step(at)) {
			return true;
		}
	}
	return false;
}

bool SceneRing::leave_step(std::uint32_t at) {
	Place &place = places_[at];
	while (place.left < place.changes.leave.size()) {
		const std::uint64_t id = place.changes.leave[place.left++];
		place.near.release(id);
		if (auto left = shown_.extract({id, at})) {
			host_.hide_mesh(left.mapped().instance, false);
			leaving_.push_back(std::move(left.mapped()));
			put_last_back();
			return true;
		}
	}
	return false;
}

bool SceneRing::enter_step(std::uint32_t at) {
	Place &place = places_[at];
	while (place.entered < place.changes.enter.size()) {
		const PlacedInstance instance = place.changes.enter[place.entered++];
		if (place.refused || place.near.holds(instance.id) || dropped_ids_.contains(instance.id)) {
			continue;
		}
		const godot::Ref<godot::PackedScene> scene = place.layer.scene;
		const std::weak_ptr<const void> alive = life_;
		const std::uint64_t epoch = epoch_;
		const std::shared_ptr<ScenePool> pool = pool_; // What runs while a scene is made may free the ring.
		godot::Node3D *node = pool->take(scene);
		const bool wanted = !alive.expired() && epoch == epoch_ && !dropped_ids_.contains(instance.id);
		if (node == nullptr && wanted) {
			refuse(places_[at]);
		} else if (node != nullptr && wanted) {
			show(instance, scene, node);
		} else if (node != nullptr) {
			ScenePool::dispose(NodeHandle(node));
		}
		return true;
	}
	return false;
}

} // namespace thicket
