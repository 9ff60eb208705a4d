// Scenes that stand in for instances near by: what a TerrainScatter3D has to do with them.

#include "nodes/scatter/terrain_scatter_3d.hpp"

#include "nodes/gameplay/instance_answers.hpp"

#include <godot_cpp/classes/engine.hpp>
#include <godot_cpp/core/class_db.hpp>

#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

SceneHost TerrainScatter3D::scene_host() {
	SceneHost host;
	host.parent = this;
	host.hide_mesh = [this](const PlacedInstance &instance, bool hidden) {
		const glm::dvec2 place{instance.position.x, instance.position.z};
		const bool in_set = !is_added(instance.id) && instance.layer < world_->layers().size();
		const Rect area = in_set ? cell_rect(world_->layers()[instance.layer].set, instance.id) : Rect{place, place};
		stream_.display().set_hidden(instance.layer, instance.id, area, hidden);
		schedule_patch();
	};
	host.data_of = [this](std::uint64_t id) {
		return get_instance_data(script_id(id));
	};
	host.tell = [this](SceneEvent event, std::uint64_t id, Node3D *scene) {
		emit_signal(event == SceneEvent::shown ? "scene_shown" : "scene_hidden", script_id(id), scene);
	};
	host.recycle_later = [this] {
		call_deferred("_recycle_scenes");
	};
	return host;
}

/// The editor shows meshes only: a scene there would be one to select, and its scripts would run.
void TerrainScatter3D::update_scenes() {
	std::vector<SceneLayer> layers;
	const bool in_editor = Engine::get_singleton()->is_editor_hint();
	for (const SharedSnapshot &layer : in_editor ? std::vector<SharedSnapshot>() : layer_list_.snapshots()) {
		layers.push_back(scenes_of(layer.get()));
	}
	scenes_.set_layers(std::move(layers));
}

/// Scenes get what the frame's budget has left, and one step where it has nothing left. False if their scripts have freed the node.
bool TerrainScatter3D::step_scenes(std::chrono::steady_clock::time_point deadline) {
	const std::weak_ptr<const void> alive = scenes_.lifeline();
	while (scenes_.step()) {
		if (alive.expired()) {
			return false;
		}
		if (std::chrono::steady_clock::now() >= deadline) {
			break;
		}
	}
	return true;
}

void TerrainScatter3D::recycle_scenes() { scenes_.recycle(); }

Node3D *TerrainScatter3D::get_scene(int64_t p_id) const { return scenes_.find(static_cast<std::uint64_t>(p_id)); }

Node3D *TerrainScatter3D::take_scene(int64_t p_id) { return scenes_.take(static_cast<std::uint64_t>(p_id)); }

void TerrainScatter3D::bind_scenes() {
	using Self = TerrainScatter3D;
	ClassDB::bind_method(D_METHOD("get_scene", "id"), &Self::get_scene);
	ClassDB::bind_method(D_METHOD("take_scene", "id"), &Self::take_scene);
	ClassDB::bind_method(D_METHOD("_recycle_scenes"), &Self::recycle_scenes);
	for (const char *name : {"scene_shown", "scene_hidden"}) {
		ADD_SIGNAL(MethodInfo(name, PropertyInfo(Variant::INT, "id"),
				PropertyInfo(Variant::OBJECT, "scene", PROPERTY_HINT_NONE, "", PROPERTY_USAGE_DEFAULT, "Node3D")));
	}
}

} // namespace thicket
