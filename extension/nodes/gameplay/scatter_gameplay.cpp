// This file contains the part of ScatterGameplay that its node drives: layers, frames, bodies and
// scenes.

#include "nodes/common/editor.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/gameplay/scatter_gameplay.hpp"

#include "core/base/instance_id.hpp"
#include "nodes/gameplay/instance_answers.hpp"

#include <utility>

using namespace godot;

namespace thicket {

ScatterGameplay::ScatterGameplay(GameplayHost &host) : host_(&host), scenes_(scene_host()) {}

ScatterGameplay::~ScatterGameplay() {
	if (state_.is_valid()) {
		state_->remove_listener(this);
	}
}

void ScatterGameplay::detach() {
	stop();
	scenes_.forget_host();
	host_ = nullptr;
	if (state_.is_valid()) {
		state_->remove_listener(this);
	}
	world_.set_state(nullptr);
	state_ = Ref<ScatterState>();
}

void ScatterGameplay::start(const RID &space, std::uint64_t node_id) {
	running_ = true;
	++run_;
	collision_.set_space(space, node_id);
}

void ScatterGameplay::stop() {
	running_ = false;
	++run_;
	clear();
}

void ScatterGameplay::clear() {
	// Signals are emitted only for instances in loaded tiles, and no tile is loaded now.
	backlog_.clear();
	abandon_requests();
	collision_.clear();
	world_.clear();
	scenes_.clear();
}

void ScatterGameplay::retire() {
	backlog_.clear();
	abandon_requests();
	collision_.set_layers({});
	world_.clear();
	layers_.clear();
	scenes_.set_layers({});
}

void ScatterGameplay::set_layers(SharedLayers new_layers, const std::vector<SharedSnapshot> &layers,
		std::span<const EditedArea> outdated, TileMaker maker) {
	// The editor shows meshes only. Otherwise scenes could be selected in the editor, and their
	// scripts would run.
	const bool with_scenes = !in_editor();
	renumber_requests(*new_layers);
	listed_layers_ = std::move(new_layers);
	layers_ = layers;
	std::vector<QueryLayer> query_layers;
	std::vector<CollisionLayer> collision_layers;
	std::vector<SceneSettings> scene_settings;
	for (const SharedSnapshot &layer : layers_) {
		query_layers.push_back(query_layer(layer.get()));
		collision_layers.push_back(collision_of(layer.get()));
		scene_settings.push_back(with_scenes ? scene_settings_of(layer.get()) : SceneSettings());
	}
	world_.set_layers(std::move(query_layers));
	for (std::uint32_t layer = 0; layer < outdated.size(); ++layer) {
		world_.invalidate(layer, outdated[layer]);
	}
	world_.set_maker(std::move(maker));
	collision_.set_layers(std::move(collision_layers));
	scenes_.set_layers(std::move(scene_settings));
	claim_layers();
}

const WorldFrame &ScatterGameplay::world_frame() {
	if (alive()) {
		host_->move_world();
	}
	return frame_;
}

void ScatterGameplay::set_world_frame(const WorldFrame &frame) {
	frame_ = frame;
	for (NearRing *ring : rings_) {
		ring->set_world_frame(frame);
	}
}

void ScatterGameplay::advance(double seconds, std::uint64_t frame) {
	const Ref<ScatterState> state = state_;
	if (state.is_valid()) {
		state->advance_in_frame(seconds, frame);
	}
}

void ScatterGameplay::find_changes(std::span<const glm::dvec3> centers) {
	for (NearRing *ring : rings_) {
		ring->find_changes(centers, world_);
	}
}

bool ScatterGameplay::follows(std::span<const glm::dvec3> centers) const {
	return centers.empty() ||
			std::ranges::all_of(rings_, [centers](const NearRing *ring) { return ring->follows(centers); });
}

void ScatterGameplay::work_until(std::chrono::steady_clock::time_point deadline) {
	while (alive() && running_ && scenes_.step()) {
		if (std::chrono::steady_clock::now() >= deadline) {
			break;
		}
	}
	emit_backlog(deadline);
}

void ScatterGameplay::recycle_scenes() { scenes_.recycle(); }

SceneHost ScatterGameplay::scene_host() {
	SceneHost host;
	host.parent = host_->node();
	host.hide_mesh = [this](const PlacedInstance &instance, bool hidden) {
		if (alive()) {
			const Rect area = area_of(instance.id, instance.position, instance.layer);
			host_->set_hidden(instance.layer, instance.id, area, hidden);
		}
	};
	host.layer_at = [this](std::uint32_t index) {
		return listed_layers_->at(index);
	};
	host.data_of = [this](std::uint64_t id) {
		return get_instance_data(script_id(id));
	};
	host.notify = [this](SceneEvent event, std::uint64_t id, Node3D *scene) {
		if (alive()) {
			host_->node()->emit_signal(
					event == SceneEvent::shown ? "scene_shown" : "scene_hidden", script_id(id), scene);
		}
	};
	host.recycle_later = [this] {
		if (alive()) {
			host_->recycle_soon();
		}
	};
	return host;
}

/// Returns the area to redraw for an instance, in world meters: the cell of its point, or its
/// position if it was placed by hand.
Rect ScatterGameplay::area_of(std::uint64_t id, glm::dvec3 position, std::uint32_t layer) const {
	if (!is_added(id) && layer < world_.layers().size()) {
		if (const std::optional<Rect> area = area_of_point(world_.layers()[layer], id)) {
			return *area;
		}
	}
	const glm::dvec2 point{position.x, position.z};
	return {point, point};
}

} // namespace thicket
